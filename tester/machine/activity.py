"""Activities: a step of the plan as an object that is stepped once a scan until it is done, and may be held."""

from __future__ import annotations

from typing import Any, Protocol, TypeVar, runtime_checkable

from tester.machine.context import AnyContext

ContextT_contra = TypeVar("ContextT_contra", bound=AnyContext, contravariant=True)


class Activity(Protocol[ContextT_contra]):
    """Stepped once a scan, in the context of its kind."""

    def step(self, ctx: ContextT_contra) -> bool:
        """Advance by one scan; return True when done."""
        ...


@runtime_checkable
class Resumable(Protocol):
    """An activity that must restart something after a hold. Any other simply continues."""

    def resume(self, ctx: Any) -> None:
        """Resume: the contact is open, and the drives run or rest as the hold left them."""
        ...


class MoveFailedError(Exception):
    """A move has exceeded its time: the run stops in a controlled way, with this as its reason."""
