"""What a fault acts on: the simulated rig, the controlling computer, and the person in front of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeVar

from sim.rig import SimRig

Machine = TypeVar("Machine", bound=SimRig)


class Computer(Protocol):
    """The controlling process as a fault script sees it: what can happen to it, and what an operator can tell it."""

    def stall(self, seconds: float) -> None:
        """Do no scan for this long."""
        ...

    def kill(self) -> None:
        """Do no scan ever again."""
        ...

    def jump(self, seconds: float) -> None:
        """Let the computer's clock be ahead by this much more."""
        ...

    def operate(self, action: str) -> None:
        """Let the operator ask for something; see ``OPERATOR_ACTIONS``."""
        ...


OPERATOR_ACTIONS = ("hold", "release", "abort", "stop", "fast stop")


@dataclass(slots=True)
class Scene:
    """The rig and its computer."""

    rig: SimRig
    computer: Computer

    def machine(self, kind: type[Machine]) -> Machine:
        """Return the rig as that of a kind of machine. Raises TypeError where it is another one."""
        if not isinstance(self.rig, kind):
            raise TypeError(f"a fault of a {kind.__name__} cannot act on a {type(self.rig).__name__}")
        return self.rig


class Effect:
    """One thing that is wrong, from ``begin`` to ``end``. Plain data: copied with the rig in the middle of it."""

    __slots__ = ()

    every_step = False
    """The effect has to be renewed before each step of the rig (``renew``)."""

    def begin(self, scene: Scene, now: float) -> None:
        """Let it happen at ``now`` s."""

    def end(self, scene: Scene, now: float) -> None:
        """Let it be over; what it has done to the rig stays done."""

    def renew(self, scene: Scene, now: float) -> None:
        """Do what has to be done before the rig is advanced from ``now`` s."""

