"""A rig file names a device's profile: packaged, a file, or one that an installed package carries."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path

import pytest

from drivers.profiles import ProfileError, load_profile
from tester.base.plugins import ALLOW_VARIABLE, plugins
from tester.base.source import InvalidSource
from tester.inputs.rig.profiles import profile_of
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.run.provenance import run_info
from tester.run.simulated import spec_of
from tests.tester.base.test_plugins import install
from tests.tester.inputs.recipe.texts import SMALL, load_recipe
from tests.tester.kinds.wheel_on_belt.bench import plan_of

OVERRIDE = "devices.load_cell.profile=acme_cell"


@pytest.fixture(autouse=True)
def acme(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A laboratory's package that carries a load cell's profile under a name of its own."""
    text = (files("drivers") / "profiles" / "four_axis_transmitter.toml").read_text("utf-8")
    declared = "[friction_tester.profiles]\nacme_cell = acme_cells\nomron_e5cc = acme_cells\n"
    install(tmp_path, "acme_cells", declared, **{"acme_cell.toml": text.replace("title = \"", "title = \"Acme ")})
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delenv(ALLOW_VARIABLE, raising=False)
    plugins.cache_clear()
    yield
    plugins.cache_clear()


def test_a_rig_file_names_the_profile_of_an_installed_package() -> None:
    rig = load_rig(overrides=[OVERRIDE])
    profile = spec_of(rig).devices["load_cell"].profile
    assert profile.name == "acme_cell" and profile.title.startswith("Acme ")


def test_a_packaged_profile_cannot_be_replaced() -> None:
    assert profile_of("omron_e5cc") == load_profile("omron_e5cc") and plugins().loaded == ()


def test_an_unknown_profile_names_those_there_are() -> None:
    with pytest.raises(ProfileError, match=r"no device profile 'nonsense' .*simulated_jacket.*declared: acme_cell"):
        profile_of("nonsense")


def test_a_profile_that_is_not_allowed_is_a_problem_of_the_rig_file(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(ALLOW_VARIABLE, "")
    with pytest.raises(InvalidSource, match=r"acme_cell.* is not allowed here .*--allow acme_cell"):
        load_rig(overrides=[OVERRIDE])


def test_a_path_to_code_is_refused() -> None:
    with pytest.raises(InvalidSource, match="is a path"):
        load_rig(overrides=["devices.load_cell.profile=acme_cells/acme_cell.py"])


def test_a_run_records_its_loaded_profiles() -> None:
    rig = load_rig(overrides=[OVERRIDE])
    info = run_info("x", plan_of(SMALL), load_recipe(SMALL, PART, "small.yaml"), rig)
    assert info.extensions["profiles/acme_cell"].startswith("acme_cells 1.2, acme_cells, sha256 ")
