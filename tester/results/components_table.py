"""Pairs of a run's conditions dry and with a film on the same specimen, and their adhesion and hysteresis."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple, TypeAlias

from tester.analysis.components import ByFilm, PartValue, by_film, mean_of
from tester.analysis.kelvin import UNKNOWN, Slope, slope_of_pairs
from tester.base.axes import AxisValue, surface_of
from tester.results.run_results import RunResults
from tester.results.table_rows import Measured

AXIS: Final = "interface"
"""Axis of the conditions; a machine without it has no components to separate."""
DRY: Final = "dry"
_TEMPERATURE: Final = "temperature"

_Key: TypeAlias = tuple[int, int, str, tuple[AxisValue, ...]]
"""Specimen, replicate, compound, and every axis except those left out."""


class FilmPair(NamedTuple):
    """A condition measured dry and with a film."""

    dry: Measured
    film: Measured
    parts: ByFilm

    @property
    def interface(self) -> str:
        """Return the substance of the film."""
        return str(self.film.info.setpoint.value(AXIS))

    @property
    def surface(self) -> str:
        """Return the surface that the recipe's grid names; "" for the recipe's abrasive."""
        return surface_of(self.film.info.setpoint)


class SharesMean(NamedTuple):
    """The mean share of hysteresis over the conditions of a compound with one film, on one surface."""

    compound: str
    interface: str
    surface: str
    conditions: int
    share: PartValue


def has_interfaces(results: RunResults) -> bool:
    """Return whether the run's conditions have the axis ``interface`` (dry, or a film)."""
    return any(axis.name == AXIS for axis in results.axes)


def film_pairs(results: RunResults) -> Iterator[FilmPair]:
    """Yield the pairs of conditions that differ only in a film, in recipe order of the latter.

    Conditions without a value and references are left out.
    """
    valued = [
        replicate
        for row in results.rows
        for replicate in row.replicates
        if replicate.result.ok and replicate.result.mu_resultant > 0.0
    ]
    dry = {_key(candidate, AXIS): candidate for candidate in valued if candidate.info.setpoint.value(AXIS) == DRY}
    for film in valued:
        if film.info.setpoint.value(AXIS) != DRY and (unfilmed := dry.get(_key(film, AXIS))) is not None:
            yield FilmPair(unfilmed, film, by_film(unfilmed.result, film.result, _slope(film, valued)))


def means_of(pairs: Sequence[FilmPair]) -> Iterator[SharesMean]:
    """Yield the mean share of each compound with each film on each surface."""
    shares_of: dict[tuple[str, str, str], list[PartValue]] = {}
    for pair in pairs:
        shares_of.setdefault((pair.dry.info.compound, pair.interface, pair.surface), []).append(pair.parts.share)
    for (compound, interface, surface), shares in shares_of.items():
        yield SharesMean(compound, interface, surface, len(shares), mean_of(shares))


def _slope(measured: Measured, valued: Sequence[Measured]) -> Slope:
    """Return the sensitivity to temperature from conditions that differ from this one in temperature alone."""
    key = _key(measured, _TEMPERATURE)
    points = [(o.result.measured.temperature, o.result.mu_resultant) for o in valued if _key(o, _TEMPERATURE) == key]
    slope = slope_of_pairs(measured.result.measured.temperature, points)
    return slope if slope is not None else UNKNOWN


def _key(measured: Measured, without: str) -> _Key:
    return measured.info.specimen, measured.info.replicate, *measured.info.setpoint.key(without)
