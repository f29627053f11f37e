"""Faults of the computer, and what an operator does."""

from __future__ import annotations

from sim.faults.scene import Effect, Scene


class Stall(Effect):
    """The controlling process gets no processor for a while."""

    __slots__ = ("seconds",)

    def __init__(self, seconds: float) -> None:
        """For this long."""
        self.seconds = seconds

    def begin(self, scene: Scene, now: float) -> None:
        """Stall it."""
        scene.computer.stall(self.seconds)


class Killed(Effect):
    """The controlling process is killed: no scan ever again."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Kill it."""
        scene.computer.kill()


class ClockJump(Effect):
    """The computer's clock jumps ahead, as after a suspend."""

    __slots__ = ("seconds",)

    def __init__(self, seconds: float) -> None:
        """By this much."""
        self.seconds = seconds

    def begin(self, scene: Scene, now: float) -> None:
        """Let it jump."""
        scene.computer.jump(self.seconds)


class Operator(Effect):
    """The operator asks for something."""

    __slots__ = ("action",)

    def __init__(self, action: str) -> None:
        """One of OPERATOR_ACTIONS."""
        self.action = action

    def begin(self, scene: Scene, now: float) -> None:
        """Ask."""
        scene.computer.operate(self.action)
