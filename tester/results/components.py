"""Which conditions of a run were measured dry and with a film on the same specimen, and what that says of each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple, TypeAlias

from tester.analysis.components import ByFilm, PartValue, by_film, mean_of
from tester.analysis.kelvin import UNKNOWN, Slope, slope_of_pairs
from tester.base.axes import AxisValue, Setpoint
from tester.results.run_results import Measured, RunResults

AXIS: Final = "interface"
"""Of the conditions; a machine that has it not has nothing to be told apart."""
DRY: Final = "dry"
_TEMPERATURE: Final = "temperature"

_Key: TypeAlias = tuple[int, int, str, tuple[AxisValue, ...]]
"""Specimen, replicate, compound, and every axis but some."""


class FilmPair(NamedTuple):
    """A condition that was measured dry and with a film."""

    dry: Measured
    film: Measured
    parts: ByFilm

    @property
    def interface(self) -> str:
        """Return what the film is of."""
        return str(self.film.info.setpoint.value(AXIS))


class SharesMean(NamedTuple):
    """The mean share of hysteresis over the conditions of a compound with one film."""

    compound: str
    interface: str
    conditions: int
    share: PartValue


def has_interfaces(results: RunResults) -> bool:
    """Tell whether the run's conditions say what is in the contact."""
    return any(axis.name == AXIS for axis in results.axes)


def film_pairs(results: RunResults) -> Iterator[FilmPair]:
    """Yield the pairs of conditions that differ in nothing but a film, in recipe order of the latter.

    Left out are conditions without a value, and references.
    """
    valued = [one for row in results.rows for one in row.replicates if one.result.ok and one.result.mu_resultant > 0.0]
    dry = {_key(one, AXIS): one for one in valued if one.info.setpoint.value(AXIS) == DRY}
    for film in valued:
        if film.info.setpoint.value(AXIS) != DRY and (own := dry.get(_key(film, AXIS))) is not None:
            yield FilmPair(own, film, by_film(own.result, film.result, _slope(film, valued)))


def means_of(pairs: Sequence[FilmPair]) -> Iterator[SharesMean]:
    """Yield the mean share of each compound with each film."""
    found: dict[tuple[str, str], list[PartValue]] = {}
    for one in pairs:
        found.setdefault((one.dry.info.compound, one.interface), []).append(one.parts.share)
    for (compound, interface), shares in found.items():
        yield SharesMean(compound, interface, len(shares), mean_of(shares))


def _slope(one: Measured, valued: Sequence[Measured]) -> Slope:
    """Return the sensitivity to temperature that conditions tell which differ from this one in temperature alone."""
    key = _key(one, _TEMPERATURE)
    points = [(o.result.measured.temperature, o.result.mu_resultant) for o in valued if _key(o, _TEMPERATURE) == key]
    found = slope_of_pairs(one.result.measured.temperature, points)
    return found if found is not None else UNKNOWN


def _key(one: Measured, without: str) -> _Key:
    held: Setpoint = one.info.setpoint
    values = tuple(axis.of(held) for axis in held.axes if axis.name != without)
    return one.info.specimen, one.info.replicate, held.compound, values
