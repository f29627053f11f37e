"""What a run's status is: one word, derived in one place from its record, its lock and its results."""

from __future__ import annotations

from enum import StrEnum


class RunStatus(StrEnum):
    """How a run stands. The words are those of every command, screen, catalogue and of JSON."""

    RUNNING = "running"
    """A process works on it: it holds the lock of the run's folder."""
    INTERRUPTED = "interrupted"
    """It has no end on record and nobody works on it: the process died, the power failed, the program broke off."""
    DONE = "done"
    """It went through its plan, and every condition has a value to be trusted."""
    INCOMPLETE = "incomplete"
    """It went through its plan, and a condition at least has no value to be trusted."""
    STOPPED = "stopped"
    TRIPPED = "tripped"
    FAILED = "failed"
    UNREACHABLE = "rig unreachable"
    UNREADABLE = "unreadable"
    """Its record cannot be read."""

    @property
    def over(self) -> bool:
        """Return whether its plan was gone through to the end: nothing is left to resume."""
        return self in (RunStatus.DONE, RunStatus.INCOMPLETE)

    @property
    def can_resume(self) -> bool:
        """Return whether `tester resume` may go on with it."""
        return not self.over and self not in (RunStatus.RUNNING, RunStatus.UNREADABLE)


WENT_THROUGH = "done"
"""What a record says of a run that went through its whole plan."""
_RECORDED = {
    "stopped": RunStatus.STOPPED,
    "tripped": RunStatus.TRIPPED,
    "rig unreachable": RunStatus.UNREACHABLE,
    "running": RunStatus.INTERRUPTED,
    "interrupted": RunStatus.INTERRUPTED,
}
"""What a record says, and what that means where nobody works on the run. ``running`` is written at the beginning."""


def run_status(recorded: str, *, held: bool, missing: bool) -> RunStatus:
    """Return the status of a run.

    ``recorded``: the status in its record; ``held``: a process holds the lock of its folder; ``missing``: a condition
    has no value to be trusted. A record whose word is none of ours has failed: nothing says that it went through.
    """
    if recorded == WENT_THROUGH:
        # Also while held: tables are being made, or a repeat is left out by hand.
        return RunStatus.INCOMPLETE if missing else RunStatus.DONE
    return RunStatus.RUNNING if held else _RECORDED.get(recorded, RunStatus.FAILED)
