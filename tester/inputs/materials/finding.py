"""What is found wrong in a file of a material, and what is doubtful in it: each at its line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from tester.base.source import InvalidSource, Problem

Place = Callable[[int], tuple[int, int]]
"""Line and column, from 1, of a row of a table, which counts from 0."""


@dataclass(slots=True)
class Findings:
    """Problems, for which a file is refused; doubts, which stay with it; notes of what was converted."""

    file: str
    problems: list[Problem] = field(default_factory=list[Problem])
    doubts: list[Problem] = field(default_factory=list[Problem])
    notes: list[str] = field(default_factory=list[str])
    lasting: list[str] = field(default_factory=list[str])
    """Doubts that nobody can see again in what is made of the file: an import writes them down."""

    def refuse(self, place: tuple[int, int], message: str) -> None:
        """Add a problem."""
        self.problems.append(Problem(self.file, *place, message))

    def doubt(self, place: tuple[int, int], message: str, *, lasting: bool = False) -> None:
        """Add a doubt."""
        self.doubts.append(Problem(self.file, *place, message))
        if lasting:
            self.lasting.append(f"line {place[0]} of what was imported: {message}")

    def end(self) -> None:
        """Raise InvalidSource where there are problems."""
        if self.problems:
            raise InvalidSource(self.problems)
