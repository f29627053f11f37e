"""A laboratory's drive, a profile in its own package or beside its rig file: read, refused, simulated, recorded."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import closing
from importlib.resources import files
from pathlib import Path

import pytest

from drivers.drives.reader import drive_profile
from drivers.profiles import ProfileError
from tester.base.plugins import ALLOW_VARIABLE, plugins
from tester.base.source import InvalidSource
from tester.cli.main import invoke
from tester.kinds import load_rig, packaged_text
from tester.store.run_reader import RunReader
from tests.extension.installing import EXAMPLES, installed
from tests.tester.kinds.wheel_on_belt.bench import SHORT

PROFILE = EXAMPLES / "drive" / "lab_servo" / "lab_drive.toml"
AXIS = "  belt:\n"


def rig_text(profile: str) -> str:
    """Return the packaged rig file whose belt has a profile."""
    text = packaged_text()
    assert text.count(AXIS) == 1
    return text.replace(AXIS, f"{AXIS}    profile: {profile}\n")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A laboratory's folder: its package is installed."""
    (tmp_path / "my-rig.yaml").write_text(rig_text("lab_drive"), encoding="utf-8")
    (tmp_path / "short.yaml").write_text(SHORT, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv(ALLOW_VARIABLE, raising=False)
    with installed("drive", tmp_path / "site", monkeypatch):
        yield tmp_path


def test_a_rig_file_names_the_profile_of_an_installed_package() -> None:
    belt = load_rig("my-rig.yaml").drives()["belt"].drive
    assert (belt.name, belt.title, belt.units.acceleration) == ("lab_drive", "A laboratory's drive", 10.0)
    assert belt.substitutes[0x6072, 0].key == (0x2101, 1)


def test_a_run_goes_through_with_it_and_keeps_it_on_record(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", "short.yaml", "--rig", "my-rig.yaml", "--yes", "--set", "sim.noise=0"]) == 0
    (run,) = (path for path in (folder / "runs").iterdir() if (path / "run.db").exists())
    with closing(RunReader(run)) as reader:
        rows = {(one.device, one.parameter): one for one in reader.parameters()}
    assert rows["belt", "profile"].value == "lab_drive"
    assert ("belt", "0x2101:01") in rows
    capfd.readouterr()
    assert invoke(["show", str(run)]) == 0
    assert "drives/lab_drive: lab-servo 1.0, lab_servo, sha256 " in capfd.readouterr().out


def test_a_packaged_name_cannot_be_taken() -> None:
    assert drive_profile("kinco_fd").name == "kinco_fd"
    assert plugins().loaded == ()


def test_an_unknown_name_names_those_there_are() -> None:
    with pytest.raises(ProfileError, match=r"no drive profile 'nonsense' \(there are cia402, .*declared: lab_drive"):
        drive_profile("nonsense")


def test_a_package_that_is_not_allowed_is_a_problem_of_the_rig_file(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(ALLOW_VARIABLE, "")
    plugins.cache_clear()
    with pytest.raises(InvalidSource, match=r"lab_drive.* is not allowed here .*--allow lab_drive"):
        load_rig("my-rig.yaml")


def test_a_file_beside_the_rig_file_is_found_from_anywhere(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = folder / "rigs"
    place.mkdir()
    (place / "rig.yaml").write_text(rig_text("own.toml"), encoding="utf-8")
    shutil.copy(PROFILE, place / "own.toml")
    belt = load_rig(place / "rig.yaml").drives()["belt"]
    assert (belt.drive.name, belt.drive.vendor_id) == ("own", 0x1A2)
    assert belt.profile == str(place / "own.toml")
    assert load_rig("rigs/rig.yaml").drives()["belt"].profile == str(Path("rigs/own.toml").resolve())
    monkeypatch.chdir(place)
    assert load_rig("rig.yaml").drives()["belt"].profile == str(place / "own.toml")


def test_a_sensors_file_beside_the_rig_file_is_also_found(folder: Path) -> None:
    place = folder / "rigs"
    place.mkdir()
    text = packaged_text().replace("profile: simulated_jacket", "profile: jacket.toml")
    (place / "rig.yaml").write_text(text, encoding="utf-8")
    own = (files("drivers") / "profiles" / "simulated_jacket.toml").read_text("utf-8")
    (place / "jacket.toml").write_text(own, encoding="utf-8")
    rig = load_rig(place / "rig.yaml")
    assert rig.devices["jacket"].profile == str(place / "jacket.toml")


def test_a_file_that_is_not_there_is_named(folder: Path) -> None:
    (folder / "rig.yaml").write_text(rig_text("gone.toml"), encoding="utf-8")
    with pytest.raises(InvalidSource, match=r"no drive profile 'gone\.toml'"):
        load_rig("rig.yaml")


def test_a_rig_is_the_same_by_whatever_path_its_file_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "rig.yaml").write_text(rig_text("own.toml"), encoding="utf-8")
    shutil.copy(PROFILE, tmp_path / "own.toml")
    monkeypatch.chdir(tmp_path)
    assert load_rig("rig.yaml").text == load_rig(tmp_path / "rig.yaml").text  # otherwise a run is not resumed
