"""How parts end, the end of the run that results, and its exit code."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntFlag

from tester.base.processes import (
    EXIT_DONE,
    EXIT_FAILED,
    EXIT_INCOMPLETE,
    EXIT_INTERRUPTED,
    EXIT_TRIPPED,
    EXIT_UNREACHABLE,
)
from tester.machine.run import Outcome, Run

EXIT_CODES: dict[Outcome, int] = {
    Outcome.DONE: EXIT_DONE,
    Outcome.FAILED: EXIT_FAILED,
    Outcome.UNREACHABLE: EXIT_UNREACHABLE,
    Outcome.TRIPPED: EXIT_TRIPPED,
    Outcome.STOPPED: EXIT_TRIPPED,
}

_BY_SEVERITY = (Outcome.DONE, Outcome.STOPPED, Outcome.UNREACHABLE, Outcome.FAILED, Outcome.TRIPPED)


class CannotStartError(Exception):
    """The run cannot begin; the message gives the reason, ``code`` is the exit code."""

    def __init__(self, message: str, code: int = 1) -> None:
        """``code``: the exit code."""
        super().__init__(message)
        self.code = code


class StopLevel(IntFlag):
    """Who wants a run to stop. Requests add up; none cancels another."""

    NONE = 0
    OTHER_PART = 1
    UNSEEN = 2
    """The run can no longer be shown: the screen, pipe or file has gone."""
    HUNG_UP = 4
    """The terminal has gone (HUP)."""
    TERMINATED = 8
    INTERRUPTED = 16
    FAST = 32

    @property
    def text(self) -> str:
        """The reason to record: that of the highest level."""
        return next((text for stop, text in _STOP_TEXTS.items() if stop in self), "")

    def tell(self, run: Run) -> None:
        """Stop a run. After TERM or a closed terminal the run ends at standstill, without the cool-down."""
        run.request_stop(self.text, fast=StopLevel.FAST in self, cool=not self & _NOT_COOLED)


_NOT_COOLED = StopLevel.TERMINATED | StopLevel.HUNG_UP
_STOP_TEXTS = {
    StopLevel.FAST: "interrupted by the operator",
    StopLevel.INTERRUPTED: "interrupted by the operator",
    StopLevel.TERMINATED: "terminated",
    StopLevel.HUNG_UP: "the terminal is gone",
    StopLevel.UNSEEN: "the run can no longer be shown",
    StopLevel.OTHER_PART: "another part has ended early",
}


@dataclass(frozen=True, slots=True)
class PartEnd:
    """How one part ended. ``failed``: why its recording is incomplete, None if it is complete."""

    part: int
    outcome: Outcome
    reason: str = ""
    failed: str | None = None


@dataclass(frozen=True, slots=True)
class RunEnding:
    """How the whole run ended: as the worst of its parts."""

    outcome: Outcome
    reason: str
    failed: str | None

    def exit_code(self, *, interrupted_once: bool, missing: bool) -> int:
        """Return the exit code; ``missing``: whether a condition has no trustworthy value."""
        if self.outcome is Outcome.STOPPED and interrupted_once:
            return EXIT_INTERRUPTED
        if self.failed:
            return EXIT_CODES[Outcome.FAILED]
        if self.outcome is Outcome.DONE and missing:
            return EXIT_INCOMPLETE
        return EXIT_CODES[self.outcome]


def ending_of(ends: Sequence[PartEnd], parts: int, stop: StopLevel = StopLevel.NONE) -> RunEnding:
    """Return the ending of a run of ``parts`` parts from the ends of those that began; ``stop``: who wanted a stop.

    The first of the worst ends gives the reason. If a part never began, the run counts as stopped, unless an end is
    worse.
    """
    failed = next((end.failed for end in ends if end.failed), None)
    worst = max(ends, key=lambda end: (_BY_SEVERITY.index(end.outcome), -end.part), default=None)
    if worst is None or (worst.outcome is Outcome.DONE and len(ends) < parts):
        return RunEnding(Outcome.STOPPED, stop.text, failed)
    reason = f"part {worst.part}: {worst.reason}" if parts > 1 and worst.reason else worst.reason
    return RunEnding(worst.outcome, reason, failed)
