"""A laboratory's kind of rig in its own package: a sledge that is pulled through a spring, from rig file to table."""

from __future__ import annotations

import csv
import shutil
from collections.abc import Iterator
from contextlib import closing
from math import isnan, nan
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from sim import machines
from sim.faults.kinds import Expected
from tester.base.plugins import plugins
from tester.cli.main import invoke
from tester.kinds import PACKAGED, find, load_rig
from tester.run.kind_lookup import run_parts, served_kind
from tester.run.simulated import spec_of
from tester.store.run_reader import RunReader
from tester.tui.playback import load
from tests.extension.installing import EXAMPLES, installed
from tests.tester.run.rehearsed import Rehearsal

RIG = ["--rig", "rig.yaml", "--yes"]
QUICK = """
recipe: quick
specimens: [{compound: "1#"}]
measure: {repeats: 1, min_valid: 1, window: 10 rev}
grids: [{name: speed, speed: 20 mm/s}]
"""
TRIPS = (
    "CAN adapter gone", "CAN bus off", "guard opened", "load cell CRC errors", "load cell replies cut short",
    "load cell silent", "load cell without supply", "pull drive data lost", "pull drive fault",
    "pull drive heartbeat lost", "pull drive in local mode", "pull drive jammed", "pull drive off the bus",
    "pull drive reboots", "pull drive torque off", "pull drive without supply", "safety chain opened", "scan stalled",
    "sledge jams",
)  # fmt: skip


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A laboratory's folder: its package is installed, its rig file and its recipe are there."""
    for name in ("rig.yaml", "recipe.yaml"):
        shutil.copy(EXAMPLES / "kind" / "lab_sledge" / name, tmp_path / name)
    (tmp_path / "quick.yaml").write_text(QUICK, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    with installed("kind", tmp_path / "site", monkeypatch):
        yield tmp_path


def runs_of(folder: Path) -> list[Path]:
    return sorted(path for path in (folder / "runs").iterdir() if (path / "run.db").exists())


def run_of(folder: Path) -> Path:
    (found,) = runs_of(folder)
    return found


def table(run: Path) -> list[dict[str, str]]:
    with (run / "conditions.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def with_fault(text: str) -> list[str]:
    return ["--set", f'sim.faults=["step slide + 1 s: {text}"]']


def test_its_recipe_runs_to_a_table_with_a_row_for_every_condition(folder: Path) -> None:
    from sim.physics.laws import make

    quiet = ["--set", "sim.scatter=0"]
    assert invoke(["run", "recipe.yaml", *RIG, *quiet]) == 0
    rows = table(run_of(folder))
    assert [(row["compound"], float(row["speed_mm_s"])) for row in rows] == [
        (compound, speed) for compound in ("1#", "3#") for speed in (5.0, 20.0, 50.0)
    ]
    for row in rows:
        law = make("paper", row["compound"]).mu(23.0, 20.0, 1e-3 * float(row["speed_mm_s"]))
        assert float(row["mu"]) == pytest.approx(law, rel=0.01)
        assert float(row["measured_load_n"]) == 20.0
    assert invoke(["verify", str(run_of(folder))]) == 0


def test_the_same_seed_gives_the_same_table_with_one_job_and_with_two(folder: Path) -> None:
    assert invoke(["run", "recipe.yaml", *RIG, "--seed", "7"]) == 0
    assert invoke(["run", "recipe.yaml", *RIG, "--seed", "7", "--jobs", "2"]) == 0
    first, second = ((run / "repeats.csv").read_bytes() for run in runs_of(folder))
    assert first == second


def test_its_fault_trips_its_interlock_and_the_trip_is_on_record(folder: Path) -> None:
    assert invoke(["run", "quick.yaml", *RIG, *with_fault("sledge jams")]) == 5
    with closing(RunReader(run_of(folder))) as reader:
        first = next(iter(reader.trips()))
    assert (first.interlock, first.unit) == ("spring overdrawn", "N")
    assert first.value > first.limit_value == 40.0


def test_a_pull_that_is_not_known_is_taken_for_too_much() -> None:
    from lab_sledge.rig import OVERDRAWN, SPRING_N

    def held(force_n: float) -> bool:
        seen = SimpleNamespace(readings=SimpleNamespace(force_n=force_n), parameters={SPRING_N: 40.0})
        return OVERDRAWN.holds(seen)

    assert [held(force_n) for force_n in (0.0, 40.0, -40.0)] == [False] * 3
    assert [held(force_n) for force_n in (40.1, -40.1, nan)] == [True] * 3


def test_every_fault_of_the_twin_that_has_to_trip_is_tried_here() -> None:
    rig = load_rig("rig.yaml")
    catalogue = machines.find(run_parts(rig).plant).language(spec_of(rig)).catalogue
    assert sorted(name for name, one in catalogue.items() if one.reaction is Expected.TRIP) == sorted(TRIPS)


@pytest.mark.parametrize("fault", TRIPS)
def test_a_fault_trips_and_leaves_the_drive_standing(folder: Path, fault: str) -> None:
    assert invoke(["run", "quick.yaml", *RIG, *with_fault(fault)]) == 5
    with closing(RunReader(run_of(folder))) as reader:
        assert next(iter(reader.trips())).interlock
        speeds = np.concatenate([block.columns["speed_mm_s"] for block in reader.sample_blocks()])
    heard = not any(word in fault for word in ("CAN", "bus", "lost", "reboots", "drive without supply"))
    assert not heard or abs(speeds[-1]) < 0.6


@pytest.mark.parametrize("action", ["stop", "fast stop"])
def test_stop_stops(folder: Path, action: str) -> None:
    assert invoke(["run", "quick.yaml", *RIG, *with_fault(f"operator {action}")]) == 5
    with closing(RunReader(run_of(folder))) as reader:
        assert reader.run().status == "stopped"
        times = np.concatenate([block.columns["time_s"] for block in reader.sample_blocks()])
        speeds = np.concatenate([block.columns["speed_mm_s"] for block in reader.sample_blocks()])
        asked_s = next(one.t_s for one in reader.events() if one.kind == "injected")
    assert np.all(abs(speeds[times > asked_s + 0.5]) < 0.6)


def test_a_hold_voids_the_repeat_and_it_is_done_again(folder: Path) -> None:
    held = '["step slide + 1 s: operator hold", "t=20 s: operator release"]'
    assert invoke(["run", "quick.yaml", *RIG, "--set", f"sim.faults={held}"]) == 0
    with closing(RunReader(run_of(folder))) as reader:
        found = [(one.attempt, one.result.status.value) for one in reader.repeats(attempts=True)]
    assert found == [(1, "void"), (2, "valid")]


def test_a_run_that_was_stopped_is_resumed_to_the_same_conditions(folder: Path) -> None:
    assert invoke(["run", "recipe.yaml", *RIG]) == 0
    whole = [row["condition"] for row in table(run_of(folder))]
    shutil.rmtree(folder / "runs")
    stopped = ["--set", 'sim.faults=["t=60 s: operator stop"]']
    assert invoke(["run", "recipe.yaml", *RIG, *stopped]) == 5
    for _ in range(4):  # the script of the stored rig stops each stretch after a minute
        if invoke(["resume", "latest", "--yes"]) == 0:
            break
    rows = table(run_of(folder))
    assert [row["condition"] for row in rows] == whole and all(row["mu"] for row in rows)


def test_a_recipe_beyond_the_rig_is_refused_with_the_place_of_the_limit(capfd: pytest.CaptureFixture[str]) -> None:
    Path("fast.yaml").write_text(QUICK.replace("20 mm/s", "[20 mm/s, 60 mm/s]"), encoding="utf-8")
    assert invoke(["check", "fast.yaml", "--rig", "rig.yaml"]) == 3
    said = capfd.readouterr().err
    assert 'speed: 60 mm/s is more than the rig allows (limit 50 mm/s: sledge.speed of rig "simulated sledge")' in said


def test_a_rig_file_for_the_real_sledge_is_written_and_read_back(capfd: pytest.CaptureFixture[str]) -> None:
    assert invoke(["rig", "init", "real.yaml", "--kind", "sledge"]) == 0
    rig = load_rig("real.yaml")
    assert not rig.simulated and rig.kind == "sledge" and "stale_sensor: 200 ms" in Path("real.yaml").read_text("utf-8")
    assert invoke(["rig", "upgrade", "rig.yaml"]) == 0
    assert "interlocks.stale_sensor" in capfd.readouterr().out
    assert load_rig("rig.yaml") == load_rig(EXAMPLES / "kind" / "lab_sledge" / "rig.yaml")


def test_screens_draw_it_and_a_run_is_replayed(folder: Path) -> None:
    assert invoke(["run", "quick.yaml", *RIG]) == 0
    assert [spec.label for spec in load(run_of(folder)).specs] == ["Friction mu", "Pull", "Speed"]
    machine = served_kind(load_rig("rig.yaml")).machine
    assert [axis.name for axis in machine.axes] == ["speed"] and [one.name for one in machine.hand] == ["pull"]


def test_it_is_known_by_package_version_and_hash_and_by_its_name_alone() -> None:
    assert find("sledge").title == "sledge on a plate, pulled through a spring" and "sledge" not in PACKAGED
    (loaded,) = plugins().loaded
    assert (loaded.distribution, loaded.version, loaded.target) == ("lab-sledge", "1.0", "lab_sledge:KIND")


def test_its_zero_is_taken_when_the_sledge_is_put_down(folder: Path) -> None:
    assert invoke(["run", "quick.yaml", *RIG, "--set", "sim.cell_zero=3 N", "--set", "sim.scatter=0"]) == 0
    (row,) = table(run_of(folder))
    assert not isnan(float(row["mu"]))
    assert float(row["mu"]) == pytest.approx(0.434, abs=0.005)


def test_it_is_rehearsed_through_its_console_with_the_verbs_of_a_plain_twin() -> None:
    rig = load_rig("rig.yaml")
    here, there = (Rehearsal(rig, QUICK, remote=remote).to_the_end() for remote in (False, True))
    assert there.kept.hands == ["specimen 1 '1#'", "repeat 1 1 1"]
    (ours,), (theirs,) = here.kept.repeats, there.kept.repeats
    assert theirs.valid and theirs.mu_resultant == pytest.approx(ours.mu_resultant, rel=2e-3)
