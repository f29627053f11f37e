"""What a step of the plan is to the scan: something that is stepped until it is done, and may be held meanwhile."""

from __future__ import annotations

from typing import Any, Protocol, TypeVar, runtime_checkable

from tester.machine.context import AnyContext

ContextT_contra = TypeVar("ContextT_contra", bound=AnyContext, contravariant=True)


class Activity(Protocol[ContextT_contra]):
    """Something that takes scans; it works in the context of its kind."""

    def step(self, ctx: ContextT_contra) -> bool:
        """Advance by one scan; return True when done."""
        ...


@runtime_checkable
class Resumable(Protocol):
    """An activity that has to begin something anew after a hold. One that has not goes on where it was."""

    def resume(self, ctx: Any) -> None:
        """Go on: the contact is open, and the drives run or stand as the hold has kept them."""
        ...


class MoveFailedError(Exception):
    """A move has not ended in its time: the run stops in a controlled way, with this as its reason."""
