"""Data sheets of drives: read, and checked against the needs of an axis."""

from __future__ import annotations

from pathlib import Path

import pytest

from drivers.canopen.data_sheet import DataSheet, DataSheetError, SheetEntry, read_data_sheet
from drivers.canopen.eds import EDS_PATH
from drivers.sheet_check import check_sheet
from tests.drivers.can_bench import wheel, yaw

SHEETS = Path(__file__).parent / "eds"


def changed(sheet: DataSheet, key: tuple[int, int], **values: object) -> DataSheet:
    """Return a sheet with another entry, or without it where no values are given."""
    objects = dict(sheet.objects)
    entry = objects.pop(key)
    if values:
        fields = {name: getattr(entry, name) for name in SheetEntry.__slots__} | values
        objects[key] = SheetEntry(**fields)
    return DataSheet(sheet.title, sheet.vendor_id, sheet.product_code, objects)


@pytest.fixture(scope="module")
def own() -> DataSheet:
    return read_data_sheet(EDS_PATH, 5)


def test_a_sheet_states_type_access_default_and_mapping(own: DataSheet) -> None:
    entry = own.objects[0x1800, 1]
    assert (entry.type, entry.access, entry.default) == (7, "rw", 0x40000185)
    assert (entry.writable, entry.mappable) == (True, False)


def test_negative_limits_may_be_written_as_their_bits(tmp_path: Path) -> None:
    path = tmp_path / "one.eds"
    path.write_text("[60FF]\nDataType=0x0004\nAccessType=rww\nLowLimit=0x80000000\nHighLimit=0x7FFFFFFF\n")
    entry = read_data_sheet(path).objects[0x60FF, 0]
    assert (entry.low, entry.high, entry.writable) == (-(2**31), 2**31 - 1, True)


def test_compact_sub_objects_are_unfolded(tmp_path: Path) -> None:
    path = tmp_path / "one.eds"
    path.write_text("[1003]\nObjectType=0x8\nDataType=0x0007\nAccessType=ro\nCompactSubObj=3\n")
    assert sorted(read_data_sheet(path).objects) == [(0x1003, 0), (0x1003, 1), (0x1003, 2), (0x1003, 3)]


@pytest.mark.parametrize(("text", "message"), [
    ("no ini", "no data sheet"), ("[FileInfo]\nFileName=x\n", "it has no object"),
    ("[6072]\nDataType=0x0006\nDefaultValue=many\n", "[6072]: 'many' is no number"),
])
def test_a_file_that_is_no_sheet_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "bad.eds"
    path.write_text(text)
    with pytest.raises(DataSheetError) as error:
        read_data_sheet(path)
    assert message in str(error.value)


def test_our_own_sheet_is_fit_for_every_axis(own: DataSheet) -> None:
    for config in (wheel(rpdo_deadline_s=0.2), wheel(digital_io=True), yaw(position_window=0.1)):
        verdict = check_sheet(config, own)
        assert (verdict.refused, verdict.without, verdict.noted) == ((), (), ())


@pytest.mark.parametrize(("key", "values", "message"), [
    ((0x6085, 0), {}, "0x6085:00 (quick stop deceleration): the drive does not have it"),
    ((0x6085, 0), {"access": "ro"}, "0x6085:00 (quick stop deceleration): it cannot be written (access ro)"),
    ((0x6085, 0), {"type": 6}, "0x6085:00 (quick stop deceleration): it has 16 bits, 32 are written"),
    ((0x6083, 0), {"high": 500}, "0x6083:00 (profile acceleration): 20000 is not within"),
    ((0x606C, 0), {"mappable": False}, "0x606C:00 (velocity actual value): it cannot be mapped into a PDO"),
    ((0x1A00, 0), {"high": 2}, "0x1A00:00 (TPDO1 mapping: number of objects): at most 2 objects, 3 are needed"),
    ((0x6502, 0), {"default": 1}, "0x6502:00 (supported drive modes (pp, pv, hm)): 0x00000001, without PROFILE_VELO"),
    ((0x1016, 1), {"access": "ro"}, "0x1016:01 (consumer heartbeat (node << 16 | ms)): it cannot be written"),
])
def test_a_mismatch_is_named(own: DataSheet, key: tuple[int, int], values: dict[str, object], message: str) -> None:
    refused = check_sheet(wheel(), changed(own, key, **values)).refused
    assert len(refused) == 1 and refused[0].startswith(message)


def test_all_mismatches_are_named_at_once(own: DataSheet) -> None:
    sheet = changed(changed(changed(own, (0x6085, 0)), (0x605D, 0)), (0x6072, 0))
    assert [one[:9] for one in check_sheet(wheel(), sheet).refused] == ["0x605D:00", "0x6085:00", "0x6072:00"]


def test_an_epos4_suits_a_press_and_its_missing_objects_are_named() -> None:
    sheet = read_data_sheet(SHEETS / "maxon_epos4.eds")
    verdict = check_sheet(wheel(digital_io=True, profile="maxon_epos4", vendor_id=0xFB, product_code=0), sheet)
    assert verdict.refused == ()
    assert [one.split(" ")[1] for one in verdict.without] == ["0x605D:00", "0x60FE:02", "0x1801:05"]


def test_a_current_above_the_limit_of_an_epos4_is_refused() -> None:
    sheet = read_data_sheet(SHEETS / "maxon_epos4.eds")
    config = wheel(profile="maxon_epos4", vendor_id=0, product_code=0, max_torque_per_mille=4000)
    assert check_sheet(config, sheet).refused == (
        "0x3001:02: 32000 is not within 0..30000 (in place of 0x6072:00 (max torque (per mille of rated)))",)


def test_another_makers_sheet_is_refused() -> None:
    sheet = read_data_sheet(SHEETS / "elmo_gold.eds")
    assert "the data sheet has the vendor id 0x0000009A" in check_sheet(wheel(profile="elmo_gold"), sheet).refused[0]


def test_an_object_that_the_profile_could_use_is_noted(own: DataSheet) -> None:
    verdict = check_sheet(wheel(profile="elmo_gold"), own)
    (noted,) = verdict.noted
    assert noted == "0x1400:05 (RPDO1 event timer (ms)): the drive has it, the profile elmo_gold does without"
