"""Impossible values in a table of moduli are refused by name; doubtful ones are named."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import exp

import pytest

from tester.inputs.materials.files import Findings
from tester.inputs.materials.measured_moduli import (
    FEW_ROWS,
    LEAST_ROWS,
    ModuliRow,
    ModuliTable,
    judge,
    shift_doubts,
    strain_doubts,
)


def sweep(count: int = 20) -> list[ModuliRow]:
    """Return a sweep of temperature at 1 Hz."""
    return [ModuliRow(-60.0 + 5.0 * i, 1.0, 2e9 / (i + 1), 2e8 / (i + 1)) for i in range(count)]


def found_in(rows: Sequence[ModuliRow]) -> tuple[list[str], list[str]]:
    """Return problems and doubts, with the line that counts rows from 1."""
    found = Findings("t")
    judge(rows, lambda number: (number + 1, 1), found)
    return [f"{p.line}: {p.message}" for p in found.problems], [f"{d.line}: {d.message}" for d in found.doubts]


def test_a_sound_sweep_has_neither() -> None:
    assert found_in(sweep()) == ([], [])


def test_negative_moduli_and_a_missing_frequency_are_each_reported() -> None:
    rows = sweep()
    rows[1] = ModuliRow(-55.0, 1.0, -1.0, 1.0)
    rows[2] = ModuliRow(-50.0, 1.0, 1e9, -5.0)
    rows[3] = ModuliRow(-45.0, 0.0, 1e9, 1e8)
    problems, _ = found_in(rows)
    assert problems == [
        "2: E': -1 Pa is not above 0",
        "3: E'': -5 Pa is not above 0",
        "4: frequency: 0 Hz is not above 0",
    ]


def test_swapped_moduli_are_named() -> None:
    problems, _ = found_in([ModuliRow(r.temperature_c, r.frequency_hz, r.loss_pa, r.storage_pa) for r in sweep()])
    assert problems == ["1: E'' is above E' at every point: are the columns E' and E'' swapped?"]


def test_a_loss_above_the_storage_somewhere_is_a_doubt() -> None:
    rows = sweep()
    rows[4] = ModuliRow(rows[4].temperature_c, 1.0, 1e8, 1.24e8)
    problems, doubts = found_in(rows)
    assert problems == [] and doubts == ["5: E'' is above E' at 1 of 20 points, first tan delta 1.24"]


def test_swapped_temperature_and_frequency_are_named_where_a_frequency_is_not_above_0() -> None:
    problems, _ = found_in([ModuliRow(f, t, 1e8, 1e7) for t in (-20.0, 0.0, 20.0) for f in (1.0, 10.0, 100.0)])
    assert problems[0] == "1: frequency: -20 Hz is not above 0: are temperature and frequency swapped?"


def test_swapped_temperature_and_frequency_are_doubted_where_temperatures_go_in_decades() -> None:
    rows = [ModuliRow(f, t, 1e8, 1e7) for t in (20.0, 30.0, 40.0, 50.0) for f in (0.1, 1.0, 10.0, 100.0)]
    problems, doubts = found_in(rows)
    assert problems == [] and any("are temperature and frequency swapped?" in one for one in doubts)


def test_a_duplicate_point_is_refused_with_both_lines() -> None:
    problems, _ = found_in([*sweep(), sweep()[3]])
    assert problems == ["21: -45 degC and 1 Hz are already in line 4"]


def test_a_sweep_up_and_down_is_doubted() -> None:
    back = [ModuliRow(-57.5 + 5.0 * i, 1.0, 1e9, 1e8) for i in range(10, -1, -1)]
    _, doubts = found_in([*sweep(), *back])
    assert doubts == [
        "21: the grid is not monotone: at 1 Hz temperatures turn at -7.5 degC: are two sweeps in one table?"
    ]


def test_too_few_points_are_refused_and_few_are_doubted() -> None:
    assert (LEAST_ROWS, FEW_ROWS) == (4, 12)
    assert found_in(sweep(3))[0] == ["1: 3 points are too few (expected 4 or more)"]
    assert found_in(sweep(5)) == ([], ["1: 5 points only (expected 12 or more): much lies between them"])
    assert found_in([])[0] == ["1: no points (expected 4 or more)"]


def test_frequencies_beyond_instruments_are_doubted() -> None:
    rows = [*sweep(), ModuliRow(60.0, 1e8, 1e6, 1e5)]
    _, doubts = found_in(rows)
    (doubt,) = doubts
    assert doubt.startswith("21: frequency: 1e+08 Hz is beyond 0.0001 to 10000 Hz of instruments: was it shifted")


def test_moduli_of_no_rubber_are_doubted() -> None:
    rows = [ModuliRow(r.temperature_c, r.frequency_hz, r.storage_pa / 1e6, r.loss_pa / 1e6) for r in sweep()]
    _, doubts = found_in(rows)
    assert doubts == ["1: E': 2000 Pa is not that of a rubber (10000 to 2e+10 Pa): is the unit right?"]


def test_temperatures_that_no_chamber_reaches_are_refused() -> None:
    problems, _ = found_in([*sweep(), ModuliRow(500.0, 1.0, 1e6, 1e5)])
    assert problems == ["21: temperature: 500 degC is out of range (expected -150 to 400 degC)"]


def doubts_of(rows: Sequence[ModuliRow], glass_c: float | None, decade_k: float | None) -> list[str]:
    return [*shift_doubts(ModuliTable(tuple(rows)), glass_c, decade_k)]


def test_one_frequency_without_a_decade_is_doubted() -> None:
    assert doubts_of(sweep(), None, 8.0) == []
    (doubt,) = doubts_of(sweep(), None, None)
    assert doubt == "measured at 1 Hz alone, and decade_k is missing: 8 K a decade (paper G) counts"


def test_a_narrow_sweep_at_one_frequency_is_doubted() -> None:
    assert doubts_of(sweep(4), None, 8.0) == ["15 K at one frequency are equivalent to less than two decades"]


def test_several_frequencies_need_a_glass_transition_that_fits() -> None:
    rows = [ModuliRow(t, f, 1e8, 1e7) for t in (-40.0, 0.0, 40.0) for f in (1.0, 10.0)]
    assert doubts_of(rows, -53.0, None) == []
    assert doubts_of(rows, None, None)[0].startswith("Tg is missing")
    assert doubts_of(rows, -30.0, None) == [
        "measured from -40 to 40 degC; the WLF shift holds from Tg to Tg + 100 K, -30 to 70 degC"
    ]
    assert doubts_of(rows, 20.0, None) == [
        "-40 degC is not above -31.5 degC, where the WLF shift of Tg + 50 K ends: no law can use it"
    ]


def test_frequencies_that_differ_by_noise_alone_are_doubted() -> None:
    rows = [ModuliRow(-40.0 + i, 1.0 + 1e-3 * i, 1e8, 1e7) for i in range(20)]
    (doubt,) = doubts_of(rows, -53.0, None)
    assert doubt.startswith("frequencies of 1 to 1.019 Hz are taken for several")


def test_noise_of_a_chamber_is_no_second_sweep() -> None:
    temperatures = [-60.0 + 2.0 * i - 2.9 * (i % 2) for i in range(20)]
    rows = [ModuliRow(t, 1.0, 2e9 / (i + 1), 2e8 / (i + 1)) for i, t in enumerate(temperatures)]
    assert found_in(rows) == ([], [])


def transition(
    rubber_pa: float = 7e6, glass_pa: float = 2e9, tan: float = 0.8, peak_c: float = -15.0
) -> list[ModuliRow]:
    """Return a sweep through a glass transition, 40 points."""
    rows: list[ModuliRow] = []
    for i in range(40):
        celsius = -100.0 + 5.0 * i
        share = 1.0 / (1.0 + exp((celsius - peak_c + 10.0) / 6.0))
        storage = rubber_pa * (glass_pa / rubber_pa) ** share
        rows.append(ModuliRow(celsius, 1.0, storage, storage * (0.05 + tan * exp(-(((celsius - peak_c) / 18.0) ** 2)))))
    return rows


@pytest.mark.parametrize("rubber_pa", [1e6, 7e6, 5e7])
@pytest.mark.parametrize("glass_pa", [1e9, 2e9, 4e9])
def test_moduli_in_a_unit_off_by_1000_are_doubted_and_right_ones_are_not(rubber_pa: float, glass_pa: float) -> None:
    right = transition(rubber_pa, glass_pa)
    assert found_in(right) == ([], [])
    for factor in (1e-3, 1e3):
        rows = [replace(row, storage_pa=factor * row.storage_pa, loss_pa=factor * row.loss_pa) for row in right]
        problems, doubts = found_in(rows)
        assert problems == [] and any("is the unit right?" in doubt for doubt in doubts), (factor, doubts)


def test_a_loss_modulus_in_another_unit_is_doubted_or_refused() -> None:
    low = [replace(row, loss_pa=1e-3 * row.loss_pa) for row in transition()]
    (doubt,) = found_in(low)[1]
    assert "tan delta is 0.00085 at most: is E'' in the unit of E'?" in doubt
    high = [replace(row, loss_pa=1e3 * row.loss_pa) for row in transition()]
    assert "swapped?" in found_in(high)[0][0]


def test_swapped_moduli_of_a_transition_are_refused_or_doubted() -> None:
    rows = [replace(row, storage_pa=row.loss_pa, loss_pa=row.storage_pa) for row in transition(tan=1.5)]
    problems, doubts = found_in(rows)
    assert problems == [] and any("E'' is above E' at 3" in doubt for doubt in doubts)


def test_kelvins_that_are_taken_for_degrees_celsius_are_doubted() -> None:
    rows = [replace(row, temperature_c=row.temperature_c + 273.15) for row in transition()]
    doubts = found_in(rows)[1]
    assert any("tan delta is greatest at 258.15 degC: are the temperatures in K?" in doubt for doubt in doubts)


def test_a_table_without_its_strain_is_doubted_and_several_strains_are() -> None:
    table = ModuliTable(tuple(sweep()))
    (doubt,) = strain_doubts(table)
    assert doubt.startswith("the strain is not stated: moduli of filled rubber fall with strain")
    assert table.describe().endswith("strain not stated")
    assert [*strain_doubts(table.at_strain(0.1))] == []
    assert table.at_strain(0.1).describe().endswith("strain 0.1 %")
    rows = [replace(row, strain_percent=(0.1, 3.0, None)[i % 3]) for i, row in enumerate(sweep())]
    assert [*strain_doubts(ModuliTable(tuple(rows)))] == [
        "the strain is not stated at 6 of 20 points",
        "measured at strains of 0.1 to 3 %: moduli of filled rubber fall with strain, and laws assume one strain",
    ]
