"""What a kind says about fitting: its laws, its packaged conditions, how a run's conditions are read."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from tester.analysis.fit.check import Errors
from tester.analysis.fit.law import Law, Sourced
from tester.base.axes import Setpoint


@dataclass(frozen=True, slots=True)
class TableLine:
    """A line of the table of a publication: a way to predict, its errors on fitted and on other conditions.

    ``asked``: what it has to come to, in words, "" where nothing is asked; ``met``: whether it does.
    """

    way: str
    fitted: Errors
    validation: Errors
    asked: str = ""
    met: bool = True


@dataclass(frozen=True, slots=True)
class Claim:
    """What a publication says of its own errors, and what its data say, in words."""

    said: str
    found: str


@dataclass(frozen=True, slots=True)
class PublishedTable:
    """A publication's claims held against its own data.

    ``compared``: lines with rows that are no evidence taken in, by what was done with them; nothing is asked of these.
    """

    title: str
    lines: tuple[TableLine, ...]
    compared: Mapping[str, tuple[TableLine, ...]]
    claims: tuple[Claim, ...]
    remarks: tuple[str, ...]

    @property
    def missed(self) -> list[str]:
        """Return the ways whose figures are not those that are asked."""
        return [line.way for line in self.lines if not line.met]


class FitPart(Protocol):
    """What a kind says about fitting."""

    @property
    def laws(self) -> Mapping[str, Law]:
        """Return the laws that can be fitted, by name, the one that is fitted unless told first."""
        ...

    @property
    def cells(self) -> tuple[int, ...]:
        """Return the places of the variables that make a cell: one is left out at a time."""
        ...

    @property
    def packaged(self) -> Sequence[str]:
        """Return the names of conditions that ship with the program."""
        ...

    def packaged_points(self, name: str) -> Sourced:
        """Return packaged conditions; raises KeyError."""
        ...

    def run_points(self, folder: Path) -> Sourced:
        """Return the conditions of a run; raises StoreError where it cannot be read."""
        ...

    def bound(self, law: Law, group: str, surface: str, figures: Mapping[str, float]) -> Law:
        """Return a law as it is for a group; raises FitError.

        A law that stands on moduli becomes that of the group's compound on ``surface`` ("": as the run says), with
        ``figures`` that are not fitted, by name. Others are returned as they are, and take no figures.
        """
        ...

    def published_values(self) -> Sequence[tuple[Setpoint, float]]:
        """Return published coefficients, each with what it was held at, to be shown beside measured ones."""
        ...

    @property
    def published_laws(self) -> Sequence[str]:
        """Return the names of laws with published parameters, those that ``law_at`` knows."""
        ...

    def law_caveats(self, setpoint: Setpoint) -> Sequence[str]:
        """Return why the value of a law with published parameters at a setpoint is to be taken with care."""
        ...

    def law_at(self, name: str) -> Callable[[Setpoint], float]:
        """Return a law with published parameters over setpoints; raises KeyError for no such law."""
        ...

    def checked(self, sources: Sequence[str], validation: Sequence[str]) -> bool:
        """Tell whether it is known what has to come out of a fit to these sources, seen on others."""
        ...

    def published_table(self) -> PublishedTable:
        """Return the publication's table, fitted anew; raises MissingExtraError without what fits need."""
        ...
