"""A drive with faulty service data, byte by byte, and our reaction to each fault."""

from __future__ import annotations

import pytest

from drivers.canopen import objects as o
from sim.faults import Injection
from sim.faults.drives import SdoFault, SpoiledSdoServer
from sim.faults.language import FaultTime
from sim.machines.wheel_on_belt.faults import CATALOGUE
from tests.campaigns.faults.recipes import RECIPES
from tests.campaigns.faults.stage import Stage
from tests.sim.drive_bench import DriveBench

READ_TYPE = bytes.fromhex("4000100000000000")
DEVICE_TYPE = "92010200"
"""0x00020192, little endian."""


def bench(kind: SdoFault) -> DriveBench:
    made = DriveBench().boot()
    made.drive.serve_with(SpoiledSdoServer(made.drive.store, kind))
    return made


def test_an_abort_names_the_object_and_the_state() -> None:
    assert bench("abort").sdo(READ_TYPE).hex() == "8000100022000008"


def test_a_reply_about_another_object_is_good_otherwise() -> None:
    assert bench("other object").sdo(READ_TYPE).hex() == "43002000" + DEVICE_TYPE


def test_a_toggle_error_comes_in_the_first_segment() -> None:
    drive = bench("toggle")
    assert drive.sdo(READ_TYPE).hex() == "4100100004000000"
    assert drive.sdo(bytes.fromhex("6000000000000000")).hex() == "17" + DEVICE_TYPE + "000000"


def test_a_server_that_forgets_to_toggle_still_takes_writes() -> None:
    drive = bench("toggle")
    drive.write(0x6083, 0, 777, 4)
    assert drive.drive.store.values[(o.PROFILE_ACCELERATION, 0)] == 777


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ("belt drive SDO abort", "abort 0x08000022 (refused in the present device state)"),
        ("belt drive SDO toggle error", "toggle bit not alternated"),
        ("belt drive SDO of another object", "no reply within 0.3 s, 1 reply of another object ignored"),
        ("belt drive mode refused", "0x6060"),
    ],
)
def test_a_drive_without_sdo_access_is_not_used_and_the_reason_is_given(fault: str, reason: str) -> None:
    stage = Stage(RECIPES["short"])
    stage.inject(Injection(FaultTime(at_s=0.0), CATALOGUE[fault]))
    while not stage.run.finished:
        stage.tick()
    assert stage.next_s < 10.0
    assert stage.run.reason.startswith("belt drive (node 2): 0x") and reason in stage.run.reason
    assert not stage.observer.found


def test_a_drive_talks_again_when_the_fault_is_over() -> None:
    stage = Stage(RECIPES["short"])
    stage.inject(Injection(FaultTime(at_s=0.0), CATALOGUE["belt drive SDO abort"], lasts_s=0.5))
    stage.inject(Injection(FaultTime(at_s=0.0), CATALOGUE["wheel drive mode refused"], lasts_s=0.5))
    while not (stage.running or stage.run.finished):
        stage.tick()
    assert stage.running
