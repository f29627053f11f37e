"""A kind's contribution to fitting: its laws, its packaged conditions, its reader of a run's conditions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from tester.analysis.fit.check import Errors
from tester.analysis.fit.fit_law import Law, Sourced
from tester.base.axes import Setpoint


@dataclass(frozen=True, slots=True)
class TableLine:
    """A line of a publication's table: a method of prediction, its errors on fitted and on other conditions.

    ``asked``: the required result, in words, "" where nothing is required; ``met``: whether it is reached.
    """

    way: str
    fitted: Errors
    validation: Errors
    asked: str = ""
    met: bool = True


@dataclass(frozen=True, slots=True)
class Claim:
    """A publication's statement about its own errors, and the result from its data, in words."""

    said: str
    found: str


@dataclass(frozen=True, slots=True)
class PublishedTable:
    """A publication's claims compared with its own data.

    ``compared``: lines that include rows which are no evidence, by the treatment of these rows; nothing is required of
    them.
    """

    title: str
    lines: tuple[TableLine, ...]
    compared: Mapping[str, tuple[TableLine, ...]]
    claims: tuple[Claim, ...]
    remarks: tuple[str, ...]

    @property
    def missed(self) -> list[str]:
        """Return the methods whose errors miss the required result."""
        return [line.way for line in self.lines if not line.met]


class FitPart(Protocol):
    """A kind's contribution to fitting."""

    @property
    def laws(self) -> Mapping[str, Law]:
        """Return the laws that can be fitted, by name, the default first."""
        ...

    @property
    def cells(self) -> tuple[int, ...]:
        """Return the places of the variables that make a cell: each cell is left out in turn."""
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
        """Return a law as it applies to a group; raises FitError.

        A law based on moduli becomes that of the group's compound on ``surface`` ("": that of the run), with
        ``figures`` that are not fitted, by name. Others are returned unchanged, and take no figures.
        """
        ...

    def published_values(self) -> Sequence[tuple[Setpoint, float]]:
        """Return published coefficients, each with its setpoint, for display beside measured ones."""
        ...

    @property
    def published_laws(self) -> Sequence[str]:
        """Return the names of laws with published parameters: those that ``law_at`` accepts."""
        ...

    def law_caveats(self, setpoint: Setpoint) -> Sequence[str]:
        """Return caveats on the value of a law with published parameters at a setpoint."""
        ...

    def law_at(self, name: str) -> Callable[[Setpoint], float]:
        """Return a law with published parameters over setpoints; raises KeyError for no such law."""
        ...

    def checked(self, sources: Sequence[str], validation: Sequence[str]) -> bool:
        """Return whether the result of a fit to these sources, validated on others, is known in advance."""
        ...

    def published_table(self) -> PublishedTable:
        """Return the publication's table, fitted anew; raises MissingExtraError without what fits need."""
        ...
