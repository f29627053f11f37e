"""A probe's finding: severity, place, text, and remedy."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum


class Severity(IntEnum):
    """The severity of a finding. With a fault, a run does not start, or fails later."""

    OK = 0
    NOTE = 1
    """Nothing is wrong; for information."""
    WARNING = 2
    """The finding may impair a run."""
    FAULT = 3

    @property
    def word(self) -> str:
        """The severity as printed."""
        return self.name.lower()


@dataclass(frozen=True, slots=True)
class Finding:
    """A finding; ``str`` returns its line without the remedy."""

    severity: Severity
    subject: str
    """The name of an axis or a device, a bus, or the computer."""
    found: str
    todo: str = ""
    """What a person can do about the finding; "" if nothing is needed."""

    def __str__(self) -> str:
        """Return the finding as the line to print."""
        return f"{self.severity.word:7} {self.subject}: {self.found}"


def ok(subject: str, found: str) -> Finding:
    """Return a finding that reports no problem."""
    return Finding(Severity.OK, subject, found)


def note(subject: str, found: str, todo: str = "") -> Finding:
    """Return a finding that is only for information."""
    return Finding(Severity.NOTE, subject, found, todo)


def warning(subject: str, found: str, todo: str) -> Finding:
    """Return a finding that may impair a run."""
    return Finding(Severity.WARNING, subject, found, todo)


def fault(subject: str, found: str, todo: str) -> Finding:
    """Return a finding with which a run does not start, or fails later."""
    return Finding(Severity.FAULT, subject, found, todo)
