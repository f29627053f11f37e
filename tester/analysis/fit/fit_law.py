"""Inputs of a fit: measured conditions, and laws with their parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import NamedTuple

from tester.base.arrays import Array
from tester.base.trouble import TroubleError

NAN = float("nan")


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable of a law: ``name``, as people read it, and its ``unit``.

    ``scale`` turns the law's own unit into that one. ``ratio``: it has a true zero, so an exponent of it is meaningful.
    """

    name: str
    unit: str
    scale: float = 1.0
    ratio: bool = True

    def words(self, value: float) -> str:
        """Return a value (in the law's unit) with its unit."""
        return f"{round(self.scale * value, 6) + 0.0:g} {self.unit}"


class Band(NamedTuple):
    """Values that a parameter can have for a rubber on a surface, in its unit, and the source of both ends."""

    low: float = -inf
    high: float = inf
    source: str = ""

    def holds(self, value: float) -> bool:
        """Return whether a value is strictly between both ends."""
        return self.low < value < self.high


ANY = Band()


@dataclass(frozen=True, slots=True)
class LawParameter:
    """A parameter of a law: ``start`` and ``step`` of the search, ``positive`` (the search is in its logarithm).

    ``step`` is in units of the searched quantity. ``levels``: name of the variable whose effect the parameter
    describes, and the least number of its values that a fit needs. ``band``: outside it the parameter has no meaning
    for a rubber.
    """

    name: str
    unit: str
    start: float
    step: float
    positive: bool = False
    levels: tuple[str, int] | None = None
    band: Band = ANY


@dataclass(frozen=True, slots=True)
class Law:
    """A friction law with parameters to be fitted.

    ``value`` takes parameters, shape (..., p), and conditions, shape (..., n, k), k variables in the law's own units;
    it returns coefficients, shape (..., n). ``table`` returns the parameters in the form in which a publication prints
    them, with ``caution`` beside it; None where there is no such form. ``published``: parameters by group.
    """

    name: str
    title: str
    formula: str
    variables: tuple[Variable, ...]
    parameters: tuple[LawParameter, ...]
    value: Callable[[Array, Array], Array]
    published: Mapping[str, tuple[float, ...]]
    table: Callable[[Sequence[float]], Mapping[str, float]] | None = None
    table_title: str = ""
    caution: str = ""
    beyond: Callable[[Sequence[float], Sequence[tuple[float, ...]]], Iterator[str]] | None = None
    """Yields, from parameters and the measured values of conditions, why the law does not hold at some of them."""
    constants: Mapping[str, float] = field(default_factory=dict[str, float])
    """Further figures of the formula, which no fit changes, by name in the law's units."""
    improper: Callable[[Sequence[float]], str] | None = None
    """Returns why parameters are not the law's, "" where they are: a search may end at a bell upside down."""
    starts: tuple[Mapping[str, float], ...] = ()
    """Further starts of the search: changes of the parameters' own."""
    leaves_out: Callable[[tuple[float, ...]], str] | None = None
    """Returns why the law has no value at the nominal values of a condition, "" where it has one."""

    def begins(self) -> Iterator[tuple[float, ...]]:
        """Yield the sets of parameters at which a search begins."""
        yield from self.published.values()
        own = {parameter.name: parameter.start for parameter in self.parameters}
        yield tuple(own.values())
        for changes in self.starts:
            yield tuple({**own, **changes}.values())

    @property
    def names(self) -> tuple[str, ...]:
        """Return the names of the parameters."""
        return tuple(parameter.name for parameter in self.parameters)


@dataclass(frozen=True, slots=True)
class Common:
    """An error that conditions of a source share: its name and standard uncertainty.

    ``variable``: place of the variable that it shifts (in the law's unit); None: it multiplies the coefficient, and
    ``standard`` is relative. ``piece``: the mounting whose conditions share it, 0: all conditions of the source.
    """

    name: str
    standard: float
    variable: int | None = None
    piece: int = 0


@dataclass(frozen=True, slots=True)
class Source:
    """Origin of conditions: a table, or a run with the errors that its conditions share.

    ``repeats`` and ``between``: the basis for the scatter of repeats and of conditions, in words; "" where unknown.
    """

    name: str
    common: tuple[Common, ...] = ()
    repeats: str = ""
    between: str = ""


@dataclass(frozen=True, slots=True)
class FitPoint:
    """One measured condition, in the law's own units.

    ``nominal`` values of the variables sort conditions into cells, ``measured`` ones are fitted. ``value``: the
    coefficient, above 0. ``type_a``: its standard uncertainty from repeats as a share of it, from an estimate with
    ``df`` degrees of freedom (infinite: declared); NaN where the scatter of repeats is unknown. ``own``: standard
    uncertainty, as a share, of further terms that differ between conditions. ``between``: standard deviation by which a
    condition misses any smooth law, as a share; 0 where none is declared. ``piece``: number of the mounted piece.
    ``own_heat_k``: estimated warming of the contact by friction above the measured temperature, by the rig file.
    """

    label: str
    group: str
    nominal: tuple[float, ...]
    measured: tuple[float, ...]
    value: float
    source: Source
    type_a: float = NAN
    df: float = 0.0
    own: float = 0.0
    between: float = 0.0
    piece: int = 0
    own_heat_k: float = 0.0


@dataclass(frozen=True, slots=True)
class Sourced:
    """The conditions of a source, and those left out of it, each with the reason."""

    points: tuple[FitPoint, ...]
    left_out: tuple[tuple[str, str], ...] = field(default=())


class FitError(TroubleError, ValueError):
    """A fit is impossible; the message gives the quantity, the reason and a remedy."""


def by_group(points: Iterable[FitPoint]) -> dict[str, list[FitPoint]]:
    """Return the points of each group: groups in order of their names, points in their given order."""
    groups: dict[str, list[FitPoint]] = {}
    for point in sorted(points, key=lambda point: point.group):
        groups.setdefault(point.group, []).append(point)
    return groups
