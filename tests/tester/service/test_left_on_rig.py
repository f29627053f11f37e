"""What is on the rig: what the newest run on it left, and nothing where there is nothing to go by."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.served.left_on_rig import WheelLeft
from tester.kinds.wheel_on_belt.served.served import SERVED
from tester.service.left_on_rig import left_on_rig
from tester.store.records import PieceInfo, RunInfo
from tests.tester.store.build import CONDITION, RUN, SPECIMENS, open_writer

RIG = load_rig("sim")
HERE = replace(RUN, rig_text=RIG.text)
WHEEL = PieceInfo(1, 1, 1, "1#", 60.0, 90.0, 85.0, 812.0)


def mounted_wheel(runs: Path, rig: RigConfig) -> WheelLeft | None:
    left = left_on_rig(runs, rig, SERVED)
    assert left is None or isinstance(left, WheelLeft)
    return left


def a_run(runs: Path, name: str, info: RunInfo, *wheels: PieceInfo) -> None:
    folder = runs / name
    folder.mkdir()
    writer = open_writer(folder)
    writer.begin_run(info, SPECIMENS, [CONDITION])
    for wheel in wheels:
        writer.piece_mounted(wheel)
    writer.finish("stopped", "", rig_seconds=80.0)
    writer.close()


def test_it_is_the_last_wheel_of_the_newest_run(tmp_path: Path) -> None:
    a_run(tmp_path, "2024-01-01-old", HERE, replace(WHEEL, diameter_mm=80.0))
    a_run(tmp_path, "2024-02-01-new", HERE, replace(WHEEL, diameter_mm=81.0), replace(WHEEL, piece=2, installed_s=70.0))
    found = mounted_wheel(tmp_path, RIG)
    assert found is not None and found.wheel is not None
    assert (found.run, found.wheel.piece, found.wheel.diameter_mm) == ("2024-02-01-new", 2, 85.0)


def test_a_run_without_a_wheel_and_one_that_cannot_be_read_are_passed_over(tmp_path: Path) -> None:
    a_run(tmp_path, "2024-01-01-old", HERE, WHEEL)
    a_run(tmp_path, "2024-02-01-new", HERE)
    (tmp_path / "2024-03-01-broken").mkdir()
    (tmp_path / "2024-03-01-broken" / "run.db").write_bytes(b"no database")
    found = mounted_wheel(tmp_path, RIG)
    assert found is not None and found.run == "2024-01-01-old"


@pytest.mark.parametrize(
    "info",
    [
        replace(HERE, rig_text=replace(RIG, rig="another").text),
        replace(HERE, simulated=False),
        replace(HERE, rig_text="no: [yaml"),
    ],
    ids=["another rig", "a real one", "unreadable"],
)
def test_a_wheel_of_another_rig_is_not_on_this_one(tmp_path: Path, info: RunInfo) -> None:
    a_run(tmp_path, "2024-01-01-old", HERE, WHEEL)
    a_run(tmp_path, "2024-02-01-new", info, replace(WHEEL, diameter_mm=88.0))
    found = mounted_wheel(tmp_path, RIG)
    assert found is not None and found.wheel is not None and found.wheel.diameter_mm == 85.0


def test_the_same_rig_with_another_setting_has_the_same_wheel(tmp_path: Path) -> None:
    a_run(tmp_path, "2024-01-01-old", HERE, WHEEL)
    assert mounted_wheel(tmp_path, load_rig("sim", ("sim.noise=0",))) is not None


def test_a_wheel_worn_below_its_least_is_taken_for_changed(tmp_path: Path) -> None:
    a_run(tmp_path, "2024-01-01-old", HERE, WHEEL)
    a_run(tmp_path, "2024-02-01-new", HERE, replace(WHEEL, diameter_mm=77.0))
    assert mounted_wheel(tmp_path, RIG) is None


def test_without_a_run_nothing_is_known(tmp_path: Path) -> None:
    assert mounted_wheel(tmp_path / "nowhere", RIG) is None
