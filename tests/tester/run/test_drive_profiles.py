"""A run on the twin with each drive profile. All: ``pytest -m campaign tests/tester/run/test_drive_profiles.py``."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from drivers.drives.reader import GENERIC, drive_profile, drive_profile_names
from tester.base.source import InvalidSource
from tester.kinds import load_rig
from tester.machine.run import Outcome
from tests.tester.kinds.wheel_on_belt.bench import AT_ONCE, SHORT, Simulation

PROFILES = [name for name in drive_profile_names() if not drive_profile(name).inverter]
NOT_FOR_A_PRESS = ("elmo_simpliq", "kinco_fd")
"""They have no usable digital outputs, or no limit of torque: the press keeps the generic drive."""


def overrides(profile: str) -> tuple[str, ...]:
    """Give every axis a profile, the press only a suitable one."""
    press = GENERIC if profile in NOT_FOR_A_PRESS else profile
    axes = dict.fromkeys(load_rig().drives(), profile) | {"press": press}
    return tuple(f"axes.{name}.profile={one}" for name, one in axes.items())


@pytest.mark.parametrize("profile", ["kinco_fd", "maxon_epos4"])     # the two that are farthest from the generic one
def test_a_short_recipe_runs_to_its_end_without_a_trip(profile: str) -> None:
    simulation = Simulation(AT_ONCE, overrides(profile), seed=1).to_the_end(4000.0)
    run = simulation.run
    assert run.engine.control.state.trip is None and run.outcome is Outcome.DONE, run.reason
    press = simulation.world.axes["press"]
    assert press.torque_limit_nm == pytest.approx(0.46, abs=0.001)


@pytest.mark.parametrize("profile", NOT_FOR_A_PRESS)
def test_a_press_without_its_protection_is_refused_by_name(profile: str) -> None:
    with pytest.raises(InvalidSource) as error:
        load_rig(overrides=(f"axes.press.profile={profile}",))
    told = [problem.message for problem in error.value.problems]
    assert any(one.startswith("0x60FE:01") for one in told)
    assert any("0x6072:00" in one and "caps the force" in one for one in told) is (profile == "kinco_fd")


def test_refusals_of_all_drives_are_reported_at_once() -> None:
    simulation = Simulation(SHORT)
    for name in ("wheel", "belt"):
        values = simulation.world.axes[name].store.values
        values[0x6076, 0] = 1000
    connector = simulation.to_the_end(60.0).run.connector
    assert connector.failure.count("0x6076:00") == 2
    assert [part.partition(": ")[0] for part in connector.failure.split("; ") if "(node " in part] == [
        "wheel drive (node 1)", "belt drive (node 2)",
    ]
    assert connector.failure.count("wheel") == connector.failure.count("belt") == 1


@pytest.mark.campaign
@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("profile", PROFILES)
def test_the_quickstart_runs_with_every_profile(profile: str, seed: int, tmp_path: Path) -> None:
    arguments = [part for one in overrides(profile) for part in ("--set", one)]
    program = [sys.executable, "-c", "from tester.cli.main import main; main()"]
    command = [*program, "run", "quickstart", "--seed", str(seed)]
    done = subprocess.run([*command, "--yes", "--out", str(tmp_path), *arguments], capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()
