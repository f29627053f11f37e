"""A kind's contribution to fitting: its laws, its packaged conditions, its reader of a run's conditions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from tester.analysis.fit.check import Errors
from tester.analysis.fit.fit_law import FitError, Law, Sourced
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

    statement: str
    found: str


@dataclass(frozen=True, slots=True)
class PublishedTable:
    """A publication's claims compared with its own data.

    ``compared``: lines that include rows without value as evidence, by the treatment of these rows. They have no
    required result.
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


class Subject(NamedTuple):
    """What is fitted together: a compound, its interface and surface ("" for none)."""

    compound: str
    interface: str = ""
    surface: str = ""


class LawPlace(NamedTuple):
    """What a law depends on, and of what: temperature in degC, load in N, sliding speed in m/s."""

    subject: Subject
    temperature_c: float
    load_n: float
    speed_m_s: float


class MadeOf(NamedTuple):
    """What a fitted law of materials is made of: the surface's name, the area in mm2, further figures that were given,
    and the hashes of the files of compound and surface."""

    surface: str
    area_mm2: float
    figures: Mapping[str, float]
    hashes: Mapping[str, str]


class FitPart:
    """A kind's contribution to fitting. Defaults: no conditions ship with the program, and nothing is published."""

    laws: Mapping[str, Law]
    """Laws that can be fitted, by name, the default first."""
    cells: tuple[int, ...]
    """Places of the variables that make a cell: each cell is left out in turn."""
    packaged: Sequence[str] = ()
    """Names of conditions that ship with the program."""
    published_laws: Sequence[str] = ()
    """Names of laws with published parameters: those that ``law_at`` accepts."""

    def packaged_points(self, name: str) -> Sourced:
        """Return packaged conditions; raises KeyError."""
        raise KeyError(name)

    def run_points(self, folder: Path) -> Sourced:
        """Return the conditions of a run; raises StoreError where it cannot be read."""
        raise NotImplementedError

    def of_runs(self, folders: Sequence[Path]) -> FitPart:
        """Return the part that looks for materials in the folders of these runs first; raises FitError where two runs
        used different files of one name.
        """
        return self

    def bound(self, law: Law, group: str, surface: str, figures: Mapping[str, float]) -> Law:
        """Return a law as it applies to a group; raises FitError.

        A law based on moduli becomes the law of the group's compound on ``surface`` ("": that of the run). ``figures``:
        values that are not fitted, by name. Other laws are returned unchanged and accept neither.
        """
        if surface or figures:
            raise FitError(f"the law {law.name} takes no surface and no figures")
        return law

    def made_of(self, law: Law, group: str, surface: str, figures: Mapping[str, float]) -> MadeOf | None:
        """Return what a law of materials is made of for a group, None for a law of figures alone; raises FitError."""
        return None

    def subject(self, group: str) -> Subject:
        """Return what a group of conditions is of."""
        return Subject(group)

    def place(self, setpoint: Setpoint) -> LawPlace | None:
        """Return the variables of a law at a setpoint, None where no law has its axes."""
        return None

    def published_values(self) -> Sequence[tuple[Setpoint, float]]:
        """Return published coefficients, each with its setpoint, for display beside measured ones."""
        return ()

    def law_caveats(self, setpoint: Setpoint) -> Sequence[str]:
        """Return caveats on the value of a law with published parameters at a setpoint."""
        return ()

    def law_at(self, name: str) -> Callable[[Setpoint], float]:
        """Return a law with published parameters as a function of setpoints; raises KeyError for an unknown law."""
        raise KeyError(name)

    def checked(self, sources: Sequence[str], validation: Sequence[str]) -> bool:
        """Return whether the result of a fit to these sources, validated on others, is known in advance."""
        return False

    def published_table(self) -> PublishedTable:
        """Return the publication's table, fitted anew; raises FitError where there is none, MissingExtraError."""
        raise FitError("nothing is published of this kind of rig")
