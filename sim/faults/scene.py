"""The target of a fault (the simulated rig, its computer, the person in front of it), and the fault itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Concatenate, ParamSpec, Protocol, TypeVar

from sim.rig import SimRig

Machine = TypeVar("Machine", bound=SimRig)
Arguments = ParamSpec("Arguments")


class ControlComputer(Protocol):
    """The controlling process for a fault script: events that can happen to it, and commands of its operator."""

    def stall(self, seconds: float) -> None:
        """Do no scan for this long."""
        ...

    def kill(self) -> None:
        """Do no scan ever again."""
        ...

    def jump(self, seconds: float) -> None:
        """Put the computer's clock ahead by this time."""
        ...

    def operate(self, action: str) -> None:
        """Request "hold", "release", "abort", "stop" or "fast stop" as the operator."""
        ...


@dataclass(slots=True)
class Scene:
    """The rig and its computer."""

    rig: SimRig
    computer: ControlComputer

    def machine(self, kind: type[Machine]) -> Machine:
        """Return the rig as a machine of this kind. Raises TypeError for a rig of another kind."""
        if not isinstance(self.rig, kind):
            raise TypeError(f"a fault of a {kind.__name__} cannot act on a {type(self.rig).__name__}")
        return self.rig


class Effect:
    """One fault in action, from ``begin`` to ``end``. Plain data: it can be copied with the rig while it lasts."""

    every_step = False
    """Whether the effect has to be renewed before each step of the rig (``renew``)."""

    def begin(self, scene: Scene, now: float) -> None:
        """Begin at ``now`` s."""

    def end(self, scene: Scene, now: float) -> None:
        """End; damage already done to the rig stays."""

    def renew(self, scene: Scene, now: float) -> None:
        """Renew the effect before the rig is advanced from ``now`` s."""


class Switched(Effect):
    """An effect without a state of its own: one function begins it (True) and ends it (False)."""

    def __init__(self, switch: Callable[[Scene, bool, float], None]) -> None:
        self._switch = switch

    def begin(self, scene: Scene, now: float) -> None:
        """Switch it on."""
        self._switch(scene, True, now)

    def end(self, scene: Scene, now: float) -> None:
        """Switch it off."""
        self._switch(scene, False, now)


def switched(
    switch: Callable[Concatenate[Scene, bool, float, Arguments], None]
) -> Callable[Arguments, Effect]:
    """Make a function ``switch(scene, on, now, ...)`` return its effect for the arguments after ``now`` (s)."""

    def make(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Effect:
        return Switched(lambda scene, on, now: switch(scene, on, now, *args, **kwargs))

    return make
