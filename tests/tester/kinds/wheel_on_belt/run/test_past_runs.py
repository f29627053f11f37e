"""Heatings of earlier runs as evidence: of the same rig with the same parameters, from valid runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from tester.base.lock import RUN_LOCK, ExclusiveUse
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.interlocks.heat_balance import NO_HISTORY
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.run.past_runs import KIND, beliefs_of, heating_data, known_heat, ratios_of
from tests.tester.store.build import RUN, SPECIMENS, open_writer


@pytest.fixture(scope="module")
def rig() -> RigConfig:
    return load_rig("sim")


def store(runs: Path, name: str, data: Sequence[str], trip: str = "") -> Path:
    """Store a run with the data of heatings, that a row tripped or none."""
    folder = runs / name
    folder.mkdir(parents=True)
    writer = open_writer(folder)
    writer.begin_run(replace(RUN, name=name), SPECIMENS, [])
    for one in data:
        writer.event(1.0, KIND, "heat balance: told in words", data=one)
    writer.event(2.0, KIND, "40 degC not reached in time", "warning")
    if trip:
        writer.trip(3.0, trip, "a cause")
    writer.finish("done", "", 4.0)
    writer.close()
    return folder


def data(rig: RigConfig, ratio: float) -> str:
    return heating_data(rig, 20e3 * ratio, 20e3, 35.0)


def test_heatings_of_runs_make_a_ratio_known(tmp_path: Path, rig: RigConfig) -> None:
    store(tmp_path, "1", [data(rig, 1.0), data(rig, 1.04)])
    store(tmp_path, "2", [data(rig, 1.02)])
    known = known_heat(tmp_path, rig)
    assert (known.heatings, known.ratio) == (3, pytest.approx(1.02))


def test_where_there_is_no_folder_there_is_no_history(tmp_path: Path, rig: RigConfig) -> None:
    assert known_heat(tmp_path / "runs", rig) == NO_HISTORY


@pytest.mark.parametrize("trip", ["heat not shown", "surface off model", "jacket hot"])
def test_a_run_that_tripped_in_heat_is_no_evidence(tmp_path: Path, rig: RigConfig, trip: str) -> None:
    store(tmp_path, "1", [data(rig, 1.0)] * 3, trip=trip)
    assert known_heat(tmp_path, rig) == NO_HISTORY


def test_a_run_that_tripped_otherwise_is_evidence(tmp_path: Path, rig: RigConfig) -> None:
    store(tmp_path, "1", [data(rig, 1.0)] * 3, trip="overload")
    assert known_heat(tmp_path, rig).heatings == 3


@pytest.mark.parametrize(
    "other",
    ["observer.thermal.hub_capacity=430 J/K", "observer.thermal.hub_to_shaft=0.2 W/K",
     "observer.thermal.jacket_power=210 W", "sim.thermal.hub_capacity=430 J/K"],
)  # fmt: skip
def test_a_rig_with_other_beliefs_or_another_twin_starts_anew(tmp_path: Path, rig: RigConfig, other: str) -> None:
    store(tmp_path, "1", [data(rig, 1.0)] * 3)
    assert known_heat(tmp_path, load_rig("sim", [other])) == NO_HISTORY


def test_keys_unrelated_to_heat_keep_the_history(rig: RigConfig) -> None:
    assert beliefs_of(load_rig("sim", ["limits.load=430 N"])) == beliefs_of(rig)


def test_a_run_under_way_is_no_evidence(tmp_path: Path, rig: RigConfig) -> None:
    folder = store(tmp_path, "1", [data(rig, 1.0)] * 3)
    with ExclusiveUse() as use:
        use.lock_file("the run 1", folder / RUN_LOCK, "1", lasting=False)
        assert known_heat(tmp_path, rig) == NO_HISTORY


def test_a_record_that_cannot_be_read_is_no_evidence(tmp_path: Path, rig: RigConfig) -> None:
    store(tmp_path, "1", [data(rig, 1.0)] * 3)
    (tmp_path / "2").mkdir()
    (tmp_path / "2" / "run.db").write_text("no database", encoding="utf-8")
    assert known_heat(tmp_path, rig).heatings == 3


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", "null", "heat", '{"put_j": "x", "shown_j": 1, "rise_k": 1}']
)  # fmt: skip
def test_data_that_is_not_a_heating_is_no_evidence(rig: RigConfig, text: str) -> None:
    assert ratios_of([text, data(rig, 1.0)], rig) == [1.0]


@pytest.mark.parametrize(("shown_j", "rise_k"), [(9e3, 35.0), (20e3, 19.0)])
def test_a_small_heating_is_no_evidence(rig: RigConfig, shown_j: float, rise_k: float) -> None:
    assert ratios_of([heating_data(rig, shown_j, shown_j, rise_k)], rig) == []
