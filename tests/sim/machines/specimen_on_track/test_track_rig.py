"""The rig of a specimen on a track: drives, devices and plant together, and its wires byte by byte."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace

import pytest

from drivers.crc16 import crc16, with_crc
from sim import machines
from sim.machines.specimen_on_track.rig import TrackRig
from sim.nodes.motion import PositionAxis, VelocityAxis
from sim.nodes.sensor_slave import UnknownQuantityError
from tests.sim.machines.specimen_on_track.variants import parameters, wiring


def made(variant: str = "grosch", **changes: object) -> TrackRig:
    rig = machines.find("specimen_on_track").world(
        wiring(variant), parameters(variant, noise=0.0, scatter=0.0, **changes), 1
    )
    assert isinstance(rig, TrackRig)
    rig.install(0, "SBR")
    rig.put_on(20.0)
    rig.advance(0.5)
    return rig


def run(rig: TrackRig, seconds: float, dt: float = 0.01) -> TrackRig:
    start = rig.now_s
    for i in range(1, round(seconds / dt) + 1):
        rig.advance(start + i * dt)
    return rig


def lower(rig: TrackRig) -> TrackRig:
    arm = rig.axes["lift"].axis
    assert isinstance(arm, PositionAxis)
    arm.move(0.0, 10.0)
    return run(rig, 2.0)


def drive(rig: TrackRig, speed: float) -> TrackRig:
    track = rig.axes["track"].axis
    assert isinstance(track, VelocityAxis)
    track.aim(speed)
    return rig


def asked(rig: TrackRig, line: str, request: str) -> bytes:
    """Send a request (hex, without CRC) and return the reply without its CRC."""
    wire = rig.lines[line]
    wire.write(with_crc(bytes.fromhex(request)), rig.now_s)
    reply = b""
    for _ in range(20):
        run(rig, 0.01)
        reply += b"".join(data for _, data in wire.read(rig.now_s))
    assert crc16(reply) == 0
    return reply[:-2]


def test_both_kinds_of_machine_are_found_and_no_other() -> None:
    assert machines.names()[:2] == ("specimen_on_track", "wheel_on_belt")
    with pytest.raises(machines.UnknownMachineError, match="no simulated machine 'sledge'; known: specimen_on_track"):
        machines.find("sledge")


@pytest.mark.parametrize(
    ("variant", "axes", "devices"),
    [
        ("grosch", ["track", "lift"], ["load cell", "chamber"]),
        ("pin-on-disc", ["track"], ["load cell", "pyrometer", "thermometer", "height sensor"]),
    ],
)
def test_a_variant_has_its_drives_and_devices(variant: str, axes: list[str], devices: list[str]) -> None:
    rig = made(variant)
    assert list(rig.axes) == axes and list(rig.devices) == devices


def test_every_drive_boots_by_itself_and_nothing_moves() -> None:
    rig = made()
    assert {can_id for _, can_id, data in rig.can.receive(rig.now_s) if data == b"\x00"} >= {0x701, 0x702}
    run(rig, 5.0)
    assert rig.track_m_s == 0.0 and rig.lift_mm == 10.0 and rig.plant.load_n == 0.0


def test_a_micrometre_a_second_is_a_micrometre_a_second() -> None:
    rig = drive(lower(made()), 1e-3)
    at = rig.axes["track"].axis.position
    run(rig, 100.0, 0.1)
    assert rig.axes["track"].axis.position - at == pytest.approx(0.1, rel=1e-4)
    assert rig.track_m_s == pytest.approx(1e-6)


def test_a_drive_without_power_shows_no_torque() -> None:
    rig = run(drive(lower(made()), 1.0), 2.0)
    assert rig.plant.force_n > 20.0 and rig.axes["track"].torque_nm == 0.0


def test_the_cell_sends_the_force_in_thousandths_of_a_newton() -> None:
    rig = run(drive(lower(made()), 1.0), 3.0)
    reply = asked(rig, "load_cell", "010300000003")
    counts = int.from_bytes(reply[3:7], "big", signed=True)
    assert reply[:3] == bytes.fromhex("010306") and reply[7:] == b"\x00\x00"
    assert counts * 1e-3 == pytest.approx(rig.plant.force_n, abs=0.01)


def test_the_chamber_takes_setpoint_lease_and_run_and_heats_the_air() -> None:
    rig = made()
    assert asked(rig, "heat", "03060010fe0c") == bytes.fromhex("03060010fe0c")  # -50.0 degC
    assert asked(rig, "heat", "030600120001") == bytes.fromhex("030600120001")
    run(rig, 600.0, 0.1)
    assert rig.chamber is not None and rig.chamber.output == -100.0
    heat = rig.plant.parameters.heat
    assert rig.plant.air_c < 23.0 - 0.25 * heat.chamber_rate * heat.chamber_time
    shown = asked(rig, "heat", "030300000004")
    assert int.from_bytes(shown[3:5], "big", signed=True) * 0.1 == pytest.approx(rig.plant.air_c, abs=0.5)


def test_the_chamber_refuses_a_setpoint_beyond_its_range() -> None:
    rig = made()
    assert asked(rig, "heat", "0306001003e9") == bytes.fromhex("038603")  # 100.1 degC
    assert asked(rig, "heat", "030600000001") == bytes.fromhex("038602")  # a reading


def test_pyrometer_and_thermometer_show_contact_and_room() -> None:
    rig = made("pin-on-disc")
    rig.lower_arm()
    run(drive(rig, 1.0), 60.0, 0.1)
    contact = int.from_bytes(asked(rig, "heat", "0103000e0004")[3:5], "big", signed=True)
    room = int.from_bytes(asked(rig, "heat", "0203000e0004")[3:5], "big", signed=True)
    assert contact * 0.1 == pytest.approx(rig.plant.exit_c, abs=0.6) and room == 230


def test_an_end_switch_opens_the_chain_and_takes_the_torque_before_the_stop() -> None:
    rig = made()
    rig.axes["track"].axis.position = 294.9
    run(drive(rig, 10.0), 0.2)
    io = rig.axes["track"].io
    assert rig.beyond_switch and io is not None and not io.inputs & 0x10000
    assert rig.axes["track"].torque_off and not rig.hit_stop
    rig.axes["track"].axis.position = 150.0
    run(rig, 0.02)
    for axis in rig.axes.values():
        axis.set_torque_off(False)
    assert not rig.beyond_switch and io.inputs & 0x10000 and not rig.axes["track"].torque_off


def test_a_disc_has_no_end() -> None:
    rig = run(drive(made("pin-on-disc"), 2.0), 600.0, 0.1)
    assert not rig.beyond_switch and rig.axes["track"].axis.position > 1000.0


def test_an_arm_without_a_drive_is_moved_by_hand() -> None:
    rig = made("pin-on-disc")
    rig.lower_arm()
    assert run(rig, 0.2).plant.load_n == 20.0
    rig.raise_arm()
    assert run(rig, 0.2).plant.load_n == 0.0


def test_a_copied_rig_continues_as_its_original() -> None:
    rig = drive(lower(made()), 1.0)
    other = deepcopy(rig)
    assert run(rig, 1.0).plant.force_n == run(other, 1.0).plant.force_n


def test_the_log_has_a_value_for_each_column() -> None:
    machine = machines.find("specimen_on_track")
    assert len(machine.log_row(made())) == len(machine.log_columns) == len(machine.log_decimals)


def test_a_further_sensor_of_a_quantity_that_the_plant_lacks_is_refused() -> None:
    spec = wiring("grosch")
    cell = spec.devices["load_cell"]
    devices = {**spec.devices, "second": replace(cell, unit_id=9, shows={"fx": "no_such_quantity"})}
    with pytest.raises(UnknownQuantityError, match="no_such_quantity"):
        TrackRig(type(spec)(spec.bitrate, spec.axes, spec.lines, devices), parameters("grosch"), 1)


def test_a_rig_that_has_lived_on_keeps_the_specimen_of_an_interrupted_run() -> None:
    rig = drive(lower(made()), 5.0)
    slid_m = run(rig, 2.0).plant.slid_m
    rig.keep(0, "SBR")
    assert rig.plant.slid_m == slid_m > 0.0
    rig.keep(1, "NR")
    assert rig.plant.slid_m == 0.0 and rig.mounted == (1, "NR")
