"""A trip on a hardware rig stays latched, for every client, until it is acknowledged."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tester.base.lock import RUN_LOCK, ExclusiveUse
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.results.run_files import write_all
from tester.results.verify import verify
from tester.run.latch import MANUAL_RUNS, acknowledge, open_trips
from tester.service.commands import Acknowledge, RunRecipe
from tester.store.run_reader import RunReader
from tests.tester.service.stage import Script, Stage, play
from tests.tester.store.build import CONDITION, RUN, SPECIMENS, open_writer


@pytest.fixture
def rig() -> RigConfig:
    """A rig that is not simulated in this process."""
    return replace(load_rig("sim"), simulated=False)


def tripped(folder: Path, rig: RigConfig, *, tables: bool = True) -> Path:
    folder.mkdir(parents=True)
    writer = open_writer(folder)
    writer.begin_run(replace(RUN, name=folder.name, rig_text=rig.text, simulated=rig.simulated), SPECIMENS, [CONDITION])
    writer.trip(20.0, "overload", "too firm", 460.0, 450.0, "N")
    writer.finish("tripped", "overload", rig_seconds=30.0)
    writer.close()
    (folder / "rig.yaml").write_text(rig.text, encoding="utf-8")
    (folder / "recipe.yaml").write_text(RUN.recipe_text, encoding="utf-8")
    if tables:
        write_all(folder)
    return folder


def test_a_trip_stays_open_until_it_is_acknowledged_and_then_names_the_person(tmp_path: Path, rig: RigConfig) -> None:
    folder = tripped(tmp_path / "one", rig)
    found = open_trips(tmp_path, rig)
    assert [str(one)[:33] for one in found] == ["overload (460 N, limit 450 N) in "[:33]]
    acknowledge(found, "ada (user id 1000)")
    assert open_trips(tmp_path, rig) == []
    with RunReader(folder) as reader:
        (trip,) = reader.trips()
    assert (trip.acknowledged_by, trip.acknowledged_utc > "2024") == ("ada (user id 1000)", True)
    assert verify(folder).problems == ()


def test_a_killed_run_and_a_stay_in_manual_mode_also_count(tmp_path: Path, rig: RigConfig) -> None:
    tripped(tmp_path / "cut off", rig, tables=False)
    tripped(tmp_path / MANUAL_RUNS / "by hand", rig, tables=False)
    found = open_trips(tmp_path, rig)
    assert sorted(one.folder.name for one in found) == ["by hand", "cut off"]
    acknowledge(found, "ada")
    assert open_trips(tmp_path, rig) == []


def test_another_rig_and_a_simulated_one_are_not_latched_by_it(tmp_path: Path, rig: RigConfig) -> None:
    tripped(tmp_path / "one", rig)
    simulated = load_rig("sim")
    tripped(tmp_path / "two", simulated)
    assert open_trips(tmp_path, simulated) == []
    assert open_trips(tmp_path, replace(rig, rig="another")) == []


def test_a_run_under_way_has_its_own_acknowledgement(tmp_path: Path, rig: RigConfig) -> None:
    folder = tripped(tmp_path / "one", rig)
    with ExclusiveUse() as use:
        use.lock_file("one", folder / RUN_LOCK, "one", lasting=False)
        assert open_trips(tmp_path, rig) == []
        assert len(open_trips(tmp_path, rig, folder)) == 1


def test_a_folder_that_was_changed_keeps_its_manifest(tmp_path: Path, rig: RigConfig) -> None:
    folder = tripped(tmp_path / "one", rig)
    before = (folder / "manifest.json").read_bytes()
    (folder / "appendix.csv").write_text("forged", encoding="utf-8")
    acknowledge(open_trips(tmp_path, rig), "ada")
    assert open_trips(tmp_path, rig) == [] and (folder / "manifest.json").read_bytes() == before


def test_the_latch_of_a_hardware_rig_survives_a_restart_of_the_service(
    tmp_path: Path, rig: RigConfig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tester.service.service.load_rig", lambda *_: rig)
    monkeypatch.setattr("tester.service.state_publisher.SNAPSHOT_S", 0.0)
    tripped(tmp_path / "runs" / "one", rig)

    def script(stage: Stage) -> Script:
        yield from stage.until(lambda view: view.mode == "LATCHED")
        assert [alarm.name for alarm in stage.views[-1].alarms] == ["overload"]
        yield stage.order(RunRecipe("quickstart"))
        yield replace(stage.order(Acknowledge()), peer="user id 1000")
        yield from stage.until(lambda view: view.mode == "OFFLINE" and not view.alarms)

    stage = play(tmp_path, script)
    assert stage.refused["run"].startswith("the rig is latched (overload (460 N, limit 450 N) in one")
    with RunReader(tmp_path / "runs" / "one") as reader:
        assert [trip.acknowledged_by for trip in reader.trips()] == ["client 1 (user id 1000)"]
