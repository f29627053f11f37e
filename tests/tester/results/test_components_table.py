"""The pairs of conditions of a run that are compared, dry and with a film."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import hypot
from pathlib import Path

import pytest

from tester.analysis.components import RUBBER_K, SENSITIVITY
from tester.analysis.kelvin import slope_of_pairs
from tester.results.components_table import FilmPair, film_pairs, means_of
from tester.results.run_results import RunResults, results_of
from tester.results.table_rows import Measured, TableRow
from tester.store.records import ConditionInfo
from tester.store.run_reader import RunReader
from tests.tester.kinds.specimen_on_track.fit.made import made_track_run

SPEEDS = (1e-4, 1e-3, 1e-2)


@pytest.fixture
def results(tmp_path: Path) -> RunResults:
    folder = made_track_run(tmp_path / "one", (0.0, 20.0), SPEEDS, interfaces=("dry", "wet"), repeats=3,
                            compounds=("SBR", "NBR"), scatter=0.03)  # fmt: skip
    with RunReader(folder) as reader:
        return results_of(reader)


def with_film(results: RunResults, change: Callable[[ConditionInfo], ConditionInfo]) -> RunResults:
    """Return results whose conditions with a film are changed."""

    def changed(one: Measured) -> Measured:
        if one.info.setpoint.value("interface") == "dry":
            return one
        return replace(one, condition=replace(one.condition, info=change(one.info)))

    rows = tuple(TableRow(tuple(map(changed, row.replicates)), row.result) for row in results.rows)
    return replace(results, rows=rows)


def test_a_condition_with_a_film_is_held_against_the_same_one_dry(results: RunResults) -> None:
    found = list(film_pairs(results))
    assert len(found) == 12
    for one in found:
        dry, film = one.dry.info.setpoint, one.film.info.setpoint
        assert (dry.value("interface"), film.value("interface")) == ("dry", "wet")
        assert dry == film.but(interface="dry")


def test_another_specimen_or_replicate_is_no_partner(results: RunResults) -> None:
    assert not list(film_pairs(with_film(results, lambda info: replace(info, specimen=info.specimen + 2))))
    assert not list(film_pairs(with_film(results, lambda info: replace(info, replicate=2))))


def points(results: RunResults, pair: FilmPair) -> list[tuple[float, float]]:
    """Return temperature and coefficient of conditions that differ from one with a film in temperature alone."""
    at = pair.film.info.setpoint
    measured = [one for row in results.rows for one in row.replicates]
    alike = [one for one in measured if one.info.setpoint.but(temperature=0.0) == at.but(temperature=0.0)]
    return [(one.result.measured.temperature, one.result.mu_resultant) for one in alike]


def test_the_film_s_sensitivity_is_that_of_its_own_temperatures(results: RunResults) -> None:
    for pair in film_pairs(results):
        slope = slope_of_pairs(pair.film.result.measured.temperature, points(results, pair))
        assert slope is not None
        unknown, _ = pair.parts.hysteresis.common[SENSITIVITY]
        apart_k = pair.parts.warmer_k
        expected = pair.film.result.mu_resultant * hypot(apart_k, RUBBER_K) * slope.u_per_kelvin
        assert unknown == pytest.approx(expected, rel=1e-3)


def test_a_mean_is_of_one_compound_and_one_film(results: RunResults) -> None:
    found = {(one.compound, one.interface): one.conditions for one in means_of(list(film_pairs(results)))}
    assert found == {("SBR", "wet"): 6, ("NBR", "wet"): 6}
