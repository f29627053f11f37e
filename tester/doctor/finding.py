"""What a probe has found: how bad it is, where, what, and what to do about it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum


class Severity(IntEnum):
    """How bad a finding is. A run will not start, or not last, on a rig with a fault."""

    OK = 0
    NOTE = 1
    """Nothing is wrong; good to know."""
    WARNING = 2
    """A run may suffer from it."""
    FAULT = 3

    @property
    def word(self) -> str:
        """The word that is printed."""
        return self.name.lower()


@dataclass(frozen=True, slots=True)
class Finding:
    """A finding; ``str`` gives its line without what to do."""

    severity: Severity
    subject: str
    """What it is about: an axis or a device by its name, a bus, the computer."""
    found: str
    todo: str = ""
    """What a person can do about it; "" where nothing is to be done."""

    def __str__(self) -> str:
        """Return the line that is printed."""
        return f"{self.severity.word:7} {self.subject}: {self.found}"

    @property
    def as_data(self) -> dict[str, str]:
        """The finding for programs."""
        return {"severity": self.severity.word, "subject": self.subject, "found": self.found, "todo": self.todo}


def ok(subject: str, found: str) -> Finding:
    """Return a finding that is as it should be."""
    return Finding(Severity.OK, subject, found)


def note(subject: str, found: str, todo: str = "") -> Finding:
    """Return something that is good to know."""
    return Finding(Severity.NOTE, subject, found, todo)


def warning(subject: str, found: str, todo: str) -> Finding:
    """Return something that a run may suffer from."""
    return Finding(Severity.WARNING, subject, found, todo)


def fault(subject: str, found: str, todo: str) -> Finding:
    """Return something with which a run will not start, or not last."""
    return Finding(Severity.FAULT, subject, found, todo)


def worst(findings: Iterable[Finding]) -> Severity:
    """Return the highest severity, OK of none."""
    return max((finding.severity for finding in findings), default=Severity.OK)
