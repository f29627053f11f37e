"""The makers' dictionaries, from their data sheets and not from our profiles: connected in one attempt."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from drivers.axis import AxisConfig
from drivers.canopen.data_sheet import read_data_sheet
from drivers.canopen.dictionary import DICTIONARY, Access, Entry
from drivers.canopen.objects import DataType
from drivers.cia402 import State
from drivers.servo import ServoDrive
from sim.nodes.cia402_slave import Cia402Slave
from tests.sim.drive_bench import PRESS, WHEEL, YAW
from tests.sim.test_master_meets_drives import Bus

SHEETS = Path(__file__).parent.parent / "drivers" / "eds"
ACCESS: dict[str, Access] = {"rww": "rw", "rwr": "rw", "rw": "rw", "ro": "ro", "const": "const", "wo": "wo"}
MAKERS = ["maxon_epos4", "elmo_gold", "elmo_simpliq", "kinco_fd5p"]


def as_the_sheet_says(node: Cia402Slave, maker: str) -> None:
    """Let a simulated drive have the objects of a data sheet: no others, and with its types and access."""
    sheet = read_data_sheet(SHEETS / f"{maker}.eds", node.node_id)
    entries: dict[tuple[int, int], Entry] = {}
    for (index, sub), one in sheet.objects.items():
        known = DICTIONARY.get((index, sub))
        default, name = (known.default, known.name) if known is not None else (one.default or 0, one.name)
        kind = DataType(one.type)
        entries[index, sub] = Entry(index, sub, kind, ACCESS[one.access], default, name, one.mappable)
    node.store.entries = entries


def connected(maker: str, config: AxisConfig) -> ServoDrive:
    profile = maker.removesuffix("5p")
    bus = Bus((replace(config, node_id=3, profile=profile, rpdo_deadline_s=0.2),))
    as_the_sheet_says(bus.nodes[0], maker)
    drive = bus.connect().drives[0]
    if drive.refused is None:
        bus.enable()
        assert drive.state is State.OPERATION_ENABLED
    return drive


@pytest.mark.parametrize("maker", MAKERS)
@pytest.mark.parametrize("config", [replace(WHEEL, speed_zero=0.05), YAW], ids=["speed", "position"])
def test_a_drive_of_the_makers_dictionary_connects_in_one_attempt(maker: str, config: AxisConfig) -> None:
    drive = connected(maker, config)
    assert drive.refused is None
    assert any("0x1400:05" in one for one in drive.plan.without)


@pytest.mark.parametrize("maker", ["maxon_epos4", "elmo_gold"])
def test_it_also_connects_with_digital_inputs_and_outputs(maker: str) -> None:
    drive = connected(maker, PRESS)
    assert drive.refused is None
    assert drive.inputs_stamp_s > 0.0


def test_the_objects_reported_missing_on_an_epos4_are_those_its_sheet_lacks() -> None:
    told = [one.split(" ")[1] for one in connected("maxon_epos4", PRESS).plan.without]
    assert told == ["0x605D:00", "0x60FE:02", "0x1801:05", "0x1400:05"]


def test_the_generic_profile_names_every_object_that_an_epos4_lacks() -> None:
    bus = Bus((replace(PRESS, node_id=3, rpdo_deadline_s=0.2),))
    as_the_sheet_says(bus.nodes[0], "maxon_epos4")
    said = bus.connect().drives[0].refused or ""
    for missing in ("0x605D:00", "0x6072:00", "0x60FE:02", "0x1801:05", "0x1400:05"):
        assert missing in said


def test_the_read_only_identifiers_of_a_simpliq_are_compared() -> None:
    bus = Bus((replace(WHEEL, node_id=3, profile="elmo_simpliq"),))
    bus.nodes[0].store._overrides[0x1400, 1] = 0x204      # the value it has after every reset
    said = bus.connect().drives[0].refused or ""
    assert "0x1400:01 (RPDO1 COB-ID): read 0x204, 0x203 is needed and cannot be set" in said
