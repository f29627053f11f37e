"""The budget as a table, from a record."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from math import hypot
from pathlib import Path

import pytest

from tester.analysis.kelvin import KnownSlope
from tester.analysis.wear_rate import WearCheck
from tester.base.quantities import Means
from tester.kinds.wheel_on_belt.budget import TERMS
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.results.run_results import RunResults, results_of
from tester.store.records import PieceInfo, Travel
from tester.store.run_reader import RunReader
from tests.tester.analysis.test_wear_rate import FIRST
from tests.tester.results.made import made
from tests.tester.results.test_tables import table
from tests.tester.store.build import CONDITION, PIECE, RUN, SPECIMENS, open_writer, record, result, small_run


def written(folder: Path, *, temperatures: tuple[float, ...] = (25.0,), piece: PieceInfo = PIECE,
            known: tuple[KnownSlope, ...] = (), terms: int = len(TERMS),
            shown: tuple[float, ...] | None = None) -> Path:  # fmt: skip
    folder.mkdir(parents=True, exist_ok=True)
    writer = open_writer(folder)
    conditions = [
        replace(CONDITION, condition=i, row=i, setpoint=CONDITION.setpoint.but(temperature=t))
        for i, t in enumerate(temperatures, 1)
    ]
    writer.begin_run(replace(RUN, known=known, terms=TERMS[:terms]), SPECIMENS, conditions)
    writer.piece_mounted(piece)
    for one in conditions:
        if shown is None:
            record(writer, one.condition, [0.70, 0.71, 0.72])
            continue
        means = Means(QUANTITIES, {**result().means, "surface_c": shown[one.condition - 1]}.values())
        for repeat in (1, 2, 3):
            key = writer.begin_repeat(one.condition, repeat, 1, 9.0, piece=1)
            writer.commit_repeat(key, replace(result(0.7), means=means))
    writer.close()
    return folder


def results(folder: Path) -> RunResults:
    with RunReader(folder) as reader:
        return results_of(reader)


def rows(folder: Path) -> dict[str, list[dict[str, str]]]:
    with RunReader(folder) as reader:
        found: dict[str, list[dict[str, str]]] = defaultdict(list)
        for row in table(made("budget", reader)):
            found[row["condition"]].append(row)
    return found


def test_every_term_of_every_condition_has_a_row_and_the_shares_sum_up(tmp_path: Path) -> None:
    found = rows(small_run(tmp_path))
    assert found.keys() == {"1", "2"}
    for terms in found.values():
        names = [row["term"] for row in terms]
        assert {one.name for one in TERMS} | {"repeatability", "drift", "temperature sensitivity"} <= set(names)
        assert len(set(names)) == len(names)
        for measurand in ("share_this_wheel", "share_compound"):
            assert sum(float(row[measurand]) for row in terms) == pytest.approx(1.0, abs=1e-5)


def test_the_rows_give_the_uncertainty_of_the_conditions_table(tmp_path: Path) -> None:
    folder = small_run(tmp_path)
    with RunReader(folder) as reader:
        lines = table(made("conditions", reader))
    for line in lines:
        terms = [row for row in rows(folder)[line["condition"]] if float(row["share_this_wheel"]) > 0.0]
        together = sum(float(row["u_mu"]) ** 2 for row in terms) ** 0.5
        assert together == pytest.approx(float(line["u_standard"]), rel=1e-5)


def test_the_product_of_input_and_sensitivity_is_the_contribution(tmp_path: Path) -> None:
    for row in rows(small_run(tmp_path))["1"]:
        product = float(row["standard_uncertainty"]) * abs(float(row["sensitivity"]))
        assert product == pytest.approx(float(row["u_mu"]), rel=1e-5, abs=1e-12)


def source_of_sensitivity(folder: Path, condition: str = "1") -> str:
    return next(row["source"] for row in rows(folder)[condition] if row["term"] == "temperature sensitivity")


def test_the_sensitivity_comes_from_the_run_s_own_pairs_first(tmp_path: Path) -> None:
    known = (KnownSlope("1#", 25.0, 1.5, 0.3, "a file"),)
    assert source_of_sensitivity(written(tmp_path / "one", known=known)) == "a file"
    assert "unknown" in source_of_sensitivity(written(tmp_path / "none"))
    pair = written(tmp_path / "two", temperatures=(25.0, 40.0), known=known, shown=(25.0, 40.0))
    assert source_of_sensitivity(pair) == "the run's own conditions at 25, 40 degC"


def test_conditions_that_were_measured_at_one_temperature_are_no_pair(tmp_path: Path) -> None:
    assert "unknown" in source_of_sensitivity(written(tmp_path, temperatures=(25.0, 40.0)))


def test_conditions_that_differ_in_more_than_temperature_are_no_pair(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    conditions = [CONDITION, replace(CONDITION, condition=2, row=2, setpoint=CONDITION.setpoint.but(load=200.0))]
    writer.begin_run(RUN, SPECIMENS, conditions)
    for number, at_c in ((1, 25.0), (2, 40.0)):
        means = Means(QUANTITIES, {**result().means, "surface_c": at_c}.values())
        for repeat in (1, 2, 3):
            key = writer.begin_repeat(number, repeat, 1, 9.0, piece=1)
            writer.commit_repeat(key, replace(result(0.7), means=means))
    writer.close()
    assert all(one.result.ok for one in results(tmp_path).rows)
    assert "unknown" in source_of_sensitivity(tmp_path)


def test_the_sensitivity_of_another_compound_is_not_used(tmp_path: Path) -> None:
    assert "unknown" in source_of_sensitivity(written(tmp_path, known=(KnownSlope("2#", 25.0, 1.5, 0.3, "a file"),)))


def test_the_sensitivity_at_another_temperature_is_not_used(tmp_path: Path) -> None:
    assert "unknown" in source_of_sensitivity(written(tmp_path, known=(KnownSlope("1#", 40.0, 1.5, 0.3, "a file"),)))


def test_a_known_sensitivity_corrects_the_coefficient(tmp_path: Path) -> None:
    (row,) = results(written(tmp_path, known=(KnownSlope("1#", 25.0, 2.0, 0.3, "a file"),))).rows
    # 25.1 degC, and 2 K of 7 s in one burst and 1.5 K of 3.5 s in the other, behind a lag of 0.15 s
    excess = 25.1 + 0.15 * (2.0 + 1.5) / (7.0 + 3.5) - 25.0
    assert row.result.mu == pytest.approx(0.71 * (1.0 - 0.02 * excess), rel=1e-5)


def test_the_believed_wear_of_the_piece_is_in_the_budget(tmp_path: Path) -> None:
    def u(folder: Path, mm: float) -> float:
        found = rows(written(folder, piece=replace(PIECE, diameter_mm=mm)))["1"]
        return next(float(row["standard_uncertainty"]) for row in found if row["term"] == "diameter worn off")

    assert (u(tmp_path / "new", 90.0), u(tmp_path / "worn", 89.4)) == pytest.approx((0.0, 0.6))


def worn_between(folder: Path, checks: tuple[WearCheck, ...] = ()) -> list[tuple[float, str]]:
    """Return the uncertainty of the loss, mm, and its source, of two conditions that wore a wheel by 2 mm in 200 m."""
    writer = open_writer(folder)
    conditions = [
        replace(CONDITION, condition=i, row=i, setpoint=CONDITION.setpoint.but(load=100.0 * i)) for i in (1, 2)
    ]
    writer.begin_run(replace(RUN, terms=TERMS), SPECIMENS, conditions)
    writer.piece_mounted(replace(PIECE, installed_diameter_mm=90.0, diameter_mm=88.0, sliding_m=200.0))
    for check in checks:
        writer.wear_check(check)
    for condition, repeat in ((1, 1), (1, 2), (2, 1), (2, 2)):
        key = writer.begin_repeat(condition, repeat, 1, 9.0, piece=1)
        writer.travelled(1, Travel(0.0, 100.0 * (condition - 1) + 50.0 * (repeat - 1)), key)
        writer.commit_repeat(key, result(0.7))
    writer.close()
    terms = [row for found in rows(folder).values() for row in found if row["term"] == "diameter worn off"]
    return [(float(row["standard_uncertainty"]), row["source"]) for row in terms]


def test_a_condition_has_the_loss_of_its_own_time(tmp_path: Path) -> None:
    (first, _), (second, _) = worn_between(tmp_path)
    assert (first, second) == pytest.approx((0.5, 1.375))  # in the middle of its sliding


def test_checks_around_a_condition_are_its_own(tmp_path: Path) -> None:
    check = replace(FIRST, t_s=5.0, reference_s=5.0, sliding_m=0.0, exposure_n_m=0.0, u_mm=0.01)
    later = replace(check, t_s=50.0, diameter_mm=89.0, expected_mm=89.1, sliding_m=100.0, exposure_n_m=1e4)
    (first, source), _ = worn_between(tmp_path, (check, later))
    assert source == "checks of the diameter before and after it"
    assert first == pytest.approx(hypot(0.5 * 0.01, 0.5 * 0.01, 0.5 * 0.1), rel=1e-3)


def test_terms_come_back_as_they_were_recorded(tmp_path: Path) -> None:
    known = (KnownSlope("1#", 25.0, 2.0, 0.3, "a file"),)
    with RunReader(written(tmp_path, known=known, terms=4)) as reader:
        info = reader.run().info
    assert (info.terms, info.known) == (TERMS[:4], known)


def test_repeatability_is_pooled_over_the_run(tmp_path: Path) -> None:
    first = results(small_run(tmp_path)).rows[0].result
    (own,) = [one for one in first.budget.contributions if one.name == "repeatability"]
    assert own.df == 4.0
