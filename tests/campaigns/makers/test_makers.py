"""The campaign of the makers' tables finds a wrong line in a profile, and none in the packaged ones."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

import drivers.profiles
from drivers.profiles import load_profile, read_profile
from tests.campaigns.makers.__main__ import CONTROLLERS, SENSORS
from tests.campaigns.makers.cases import Cases
from tests.campaigns.makers.controllers import ControllerCases
from tests.campaigns.makers.inverter_cases import PROFILE, InverterCases
from tests.campaigns.makers.seat import Tally, placed

PROFILES = Path(drivers.profiles.__file__).parent
TABLES = {table.profile: table for table in (*SENSORS, *CONTROLLERS)}
MUTANTS = [
    ("raytek_mi3", "address = 1200", "address = 1190", "emissivity"),
    ("raytek_mi3", "invalid = [0, 1, 2, 3, 5]", "invalid = [0, 2, 3, 5]", "object out of range"),
    ("raytek_mi3", "value = 0x49", "value = 0x45", "emissivity source"),
    ("flintec_dad141", "0x3500", "0x3502", "tared"),
    ("flintec_dad141", "invalid = [0, 1]", "invalid = [0]", "over range"),
    ("seneca_z_sg", "greatest = 600.0", "greatest = 1e8", "beyond the end scale"),
    ("moxa_e1240", 'least = 0, greatest = 0, guards = "input_3"', 'guards = "input_3"', "channel 3"),
    ("moxa_e1214", "address = 5", "address = 6", "exception 2"),
    ("jumo_diratron", "lasts = true", "lasts = false", "begun anew"),
    ("calex_pyrominibus", "invalid = [0, 1, 2, 3, 4]", "invalid = [0, 1, 2, 3]", "object too hot"),
    ("calex_pyrousb", "least = 0.1, greatest = 1.0", "least = 0.2, greatest = 1.0", "is refused"),
    ("hygrometer_sht20", "greatest = 100.0", "greatest = 200.0", "of humidity"),
    ("laumas_tlb", "sign_bit = 7", "sign_bit = 8", "force is"),
    ("omron_e5cc", "first = true", "first = false", "not ready"),
    ("jumo_diratron", "low_first", "high_first", "pv is"),
    ("jumo_diratron", "standby_c = 0.0", "standby_c = 20.0", "standby"),
]


def wrong(name: str, text: str | None = None) -> list[str]:
    """Return the faults of a profile, or of another text in its place."""
    profile = load_profile(name) if text is None else read_profile(name, text)
    tally = Tally()
    made = ControllerCases if TABLES[name] in CONTROLLERS else Cases
    with placed(TABLES[name]) as place:
        made(place, profile, random.Random(3), tally).conduct(rounds=2)
    return tally.wrong


@pytest.mark.parametrize("name", TABLES)
def test_a_profile_fits_its_makers_table(name: str) -> None:
    assert not wrong(name)


@pytest.mark.parametrize(("name", "right", "mutant", "found"), MUTANTS)
def test_a_wrong_line_of_a_profile_is_found(name: str, right: str, mutant: str, found: str) -> None:
    text = (PROFILES / f"{name}.toml").read_text(encoding="utf-8")
    assert right in text
    assert any(found in line for line in wrong(name, text.replace(right, mutant)))


def wrong_inverter(profile: str) -> str:
    tally = Tally()
    InverterCases(random.Random(3), tally, profile).conduct(rounds=11)
    return "\n".join(tally.wrong)


def test_the_profile_of_inverters_fits_the_makers_pages() -> None:
    assert not wrong_inverter(PROFILE)


@pytest.mark.parametrize(("lost", "found"), [
    ("6077", "per mille"), ("1016:01", "is refused: 0x1016:01"), ("604A", "is refused: 0x604A:01"),
])
def test_an_object_that_a_profile_of_an_inverter_leaves_out_is_found(tmp_path: Path, lost: str, found: str) -> None:
    text = (PROFILES / "drives" / f"{PROFILE}.toml").read_text(encoding="utf-8")
    path = tmp_path / "lost.toml"
    path.write_text(text.replace("[objects]\n", f'[objects]\nmissing = ["{lost}"]\n'), encoding="utf-8")
    assert found in wrong_inverter(str(path))
