"""Drive profiles as files, and the bits of digital inputs and outputs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from drivers.digital_io import CONTACTOR, GUARD, REQUEST, SAFETY_CHAIN, DigitalWiring
from drivers.drives.reader import drive_profile, drive_profile_names, read_drive_profile
from drivers.profiles.model import ProfileError

HEAD = 'title = "x"\nchecked = "y"\n'


def test_the_profiles_that_come_with_the_program() -> None:
    assert drive_profile_names() == [
        "cia402", "cia402_inverter", "elmo_gold", "elmo_simpliq", "kinco_fd", "maxon_epos4", "nanotec",
    ]


def test_a_missing_index_takes_its_sub_indices_along() -> None:
    profile = read_drive_profile("x", HEAD + '[objects]\nmissing = ["60FE", "1400:05"]\n')
    assert [profile.lacks(key) for key in ((0x60FE, 1), (0x1400, 5), (0x1400, 1))] == [True, True, False]


@pytest.mark.parametrize(("text", "message"), [
    ("title = 1\n", "title: must be a text, not 1"),
    ('title = "x"\n', "checked: is missing"),
    (HEAD + "speed = 1\n", "speed: is not a key of such a profile"),
    (HEAD + '[objects]\nmissing = ["halt"]\n', "halt: is no object"),
    (HEAD + "[units]\nacceleration = 0\n", "acceleration: must be above 0"),
    (HEAD + "[pdo]\nentries = 0\n", "x.toml: pdo: entries: must be a whole number 1.."),
    (HEAD + 'vendor_id = "unknown"\n', "vendor_id: is not known to us"),
    (HEAD + "[slow]\n[fast]\n", "slow, fast: are not keys"),
    (HEAD + '[units]\ntorque = "Nm"\n', "torque: must be a number"),
    (HEAD + '[pdo]\ncob_ids = "free"\n', "pdo: cob_ids: must be one of set, fixed"),
    (HEAD + '[objects.instead.6072]\nobject = "3001:02"\ntype = "u32"\n', "6072:00 is not among objects.missing"),
    (HEAD + '[writes.gear]\nobject = "6091:01"\ntype = "float"\n', "type: must be one of"),
    (HEAD + "[statusword]\nremote = 0\n", "remote: must be true or false"),
    (HEAD + "[objects.options]\n6007 = 0\n", "6007 = 0 (a profile may choose 1, 3)"),
    (HEAD + "[objects.options]\n605A = 0\n", "605A = 0 (a profile may choose 2)"),
    (HEAD + "[objects.options]\n6072 = 9999\n", "6072 = 9999 (a profile may choose no value)"),
    ("title = ", "x.toml:"),
])
def test_a_wrong_profile_names_file_and_key(text: str, message: str) -> None:
    with pytest.raises(ProfileError) as error:
        read_drive_profile("x", text)
    assert str(error.value).startswith("x.toml") and message in str(error.value)


def test_an_unknown_profile_names_those_there_are() -> None:
    with pytest.raises(ProfileError, match=r"no drive profile 'epos' \(there are cia402, cia402_inverter"):
        drive_profile("epos")


def test_the_profile_of_the_page_is_one() -> None:
    page = Path(__file__).parents[2] / "docs" / "how-to" / "choose-a-drive.md"
    (text,) = re.findall(r"<!-- file my_drive.toml -->\n```toml\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    profile = read_drive_profile("my_drive", text)
    assert (profile.vendor_id, profile.substitutes[0x6072, 0].factor) == (0x1A2, 0.1)


def test_the_page_names_every_profile() -> None:
    page = (Path(__file__).parents[2] / "docs" / "how-to" / "choose-a-drive.md").read_text(encoding="utf-8")
    assert [name for name in drive_profile_names() if f"| `{name}` |" not in page] == []


def test_the_usual_bits_are_left_as_they_are() -> None:
    usual = DigitalWiring()
    assert (usual.from_drive(0x1234_5678), usual.to_drive(REQUEST), usual.mask) == (0x1234_5678, REQUEST, 0xFFFF_0000)


@pytest.mark.parametrize("word", range(8))
def test_other_bits_are_translated_both_ways(word: int) -> None:
    wiring = DigitalWiring(safety_chain=3, guard=1, contactor=0, request=2, contactor_inverted=True)
    inputs = (word & 1) * SAFETY_CHAIN | (word >> 1 & 1) * GUARD | (word >> 2) * CONTACTOR
    assert wiring.from_drive(wiring.inputs_shown(inputs)) == inputs
    assert (wiring.to_drive(REQUEST), wiring.outputs_meant(1 << 2), wiring.to_drive(0)) == (1 << 2, REQUEST, 0)


def test_a_broken_wire_reads_as_an_open_chain_and_guard_whatever_the_bits() -> None:
    wiring = DigitalWiring(safety_chain=3, guard=1, contactor=0, contactor_inverted=True)
    assert wiring.from_drive(0) & (SAFETY_CHAIN | GUARD) == 0


@pytest.mark.parametrize(("bits", "message"), [
    ({"safety_chain": 17}, "need a bit each"), ({"request": 32}, "request: bit 32"),
])
def test_wrong_bits_are_refused(bits: dict[str, int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        DigitalWiring(**bits)
