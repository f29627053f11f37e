"""Activities: the work of a plan's step as an object. Its ``step`` is called once a scan until the work is done; a hold
may interrupt it.
"""

from __future__ import annotations

from typing import Any, Protocol, TypeVar, runtime_checkable

from tester.machine.context import AnyContext

ContextT_contra = TypeVar("ContextT_contra", bound=AnyContext, contravariant=True)


class Activity(Protocol[ContextT_contra]):
    """An activity that is stepped once a scan, with the context of its kind."""

    def step(self, ctx: ContextT_contra) -> bool:
        """Advance by one scan; return True when done."""
        ...


@runtime_checkable
class Resumable(Protocol):
    """An activity that must restart something after a hold. Any other activity simply continues."""

    def resume(self, ctx: Any) -> None:
        """Resume after a hold: the contact is open, and the drives run or rest as the hold left them."""
        ...


@runtime_checkable
class Waits(Protocol):
    """An activity that may do nothing but wait. Any other activity is stepped in every scan."""

    def waits_s(self, ctx: Any) -> float:
        """Return the rig time for which it surely waits, s: noise of readings allowed for; 0 if it may act."""
        ...


class MoveFailedError(Exception):
    """A move has exceeded its time limit. The run stops in a controlled way and reports this error as the reason."""
