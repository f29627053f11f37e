"""What a step of the plan is to the scan: something that is stepped until it is done, and may be held meanwhile."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from tester.engine.context import Context


class Activity(Protocol):
    """Something that takes scans."""

    def step(self, ctx: Context) -> bool:
        """Advance by one scan; return True when done."""
        ...


@runtime_checkable
class Resumable(Protocol):
    """An activity that has to begin something anew after a hold. One that has not goes on where it was."""

    def resume(self, ctx: Context) -> None:
        """Go on: the wheel is lifted, both drives run at the wheel's speed or stand."""
        ...


class MoveFailedError(Exception):
    """A move has not ended in its time: the run stops in a controlled way, with this as its reason."""
