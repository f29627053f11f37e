"""The sensor driver with a load cell's profile, against bytes of the register map, and on the simulated line."""

from __future__ import annotations

from math import inf, isnan

import pytest

from drivers.crc16 import with_crc
from drivers.profiles import ProfileError, load_profile
from drivers.sensor import Sensor
from sim.nodes.sensor_slave import CellSlave
from sim.wires.modbus_wire import Impairment
from tests.drivers.modbus_bench import Bench, reply
from tests.drivers.modbus_rig import Quantities, Rig

PROFILE = load_profile("four_axis_transmitter")
CHANNELS = ("fx", "fy", "fz", "mz")


def connected() -> tuple[Bench, Sensor]:
    """Return a cell that has given its type; its first read is under way."""
    bench = Bench()
    cell = Sensor(PROFILE, 1, bench.link)
    bench.serve(0.0)
    bench.serve(0.01, (0.005, reply(0x4658)))
    return bench, cell


def give(bench: Bench, registers: str) -> None:
    """Answer the read that was sent at 0.01 s."""
    data = bytes.fromhex(registers.replace(" ", ""))
    words = [int.from_bytes(data[at : at + 2], "big") for at in range(0, len(data), 2)]
    bench.serve(0.02, (0.0155, reply(*words)))


def rig(**changes: object) -> tuple[Rig, Sensor, CellSlave, Quantities]:
    source = Quantities()
    slave = CellSlave(PROFILE, 1, source)
    made = Rig(115200, slave, **changes)  # type: ignore[arg-type]
    return made, Sensor(PROFILE, 1, made.link), slave, source


def test_nothing_is_known_before_the_first_reading() -> None:
    cell = Sensor(PROFILE, 1, Bench().link)
    assert (cell.stamp_s, cell.valid, cell.refused) == (-inf, False, None)
    assert all(isnan(value) for value in (*cell.raw, *cell.values))


def test_the_type_is_asked_for_first_then_the_block_of_nine() -> None:
    bench, _ = connected()
    assert bench.frames[0][:6].hex() == "010300640001"
    assert bench.frames[1][:6].hex() == "010300000009"


def test_another_device_at_the_address_is_refused() -> None:
    bench = Bench()
    cell = Sensor(PROFILE, 1, bench.link)
    bench.serve(0.0)
    bench.serve(0.01, (0.005, reply(17)))
    bench.serve(5.0)
    assert cell.refused == "device type: register holds 17, expected 18008"
    assert len(bench.frames) == 1


def test_four_channels_are_scaled_from_their_registers() -> None:
    bench, cell = connected()
    give(bench, "000007D0 FFFFFE70 00000FA0 000001F4 0000")
    assert cell.counts == [2000, -400, 4000, 500]
    assert cell.values == pytest.approx([100.0, -20.0, 200.0, 0.5])
    assert (cell.valid, cell.stamp_s) == (True, 0.0155)


def test_tare_is_taken_off_at_once_and_from_then_on() -> None:
    bench, cell = connected()
    give(bench, "000007D0 FFFFFE70 00000FA0 000001F4 0000")
    cell.set_tare((1.0, -2.0, 3.0, 0.25))
    assert cell.values == pytest.approx([99.0, -18.0, 197.0, 0.25])
    bench.serve(0.03, (0.0255, reply(0, 2020, 0, 0, 0, 4000, 0, 0, 0)))
    assert cell.values[0] == pytest.approx(100.0)
    assert cell.raw == pytest.approx([101.0, 0.0, 200.0, 0.0])


@pytest.mark.parametrize("bit", [0, 1, 2])
def test_an_error_bit_makes_the_reading_invalid(bit: int) -> None:
    bench, cell = connected()
    give(bench, f"00000000 00000000 00000000 00000000 {1 << bit:04X}")
    assert not cell.valid
    assert cell.status == 1 << bit


def test_other_status_bits_are_information() -> None:
    bench, cell = connected()
    give(bench, "00000000 00000000 00000000 00000000 8000")
    assert cell.valid


@pytest.mark.parametrize("fz", [11760, -11760])
def test_98_percent_of_the_range_is_saturated(fz: int) -> None:
    bench, cell = connected()
    give(bench, f"00000000 00000000 {fz & 0xFFFFFFFF:08X} 00000000 0000")
    assert not cell.valid


def test_just_below_it_is_not() -> None:
    bench, cell = connected()
    give(bench, f"00000000 00000000 {11759:08X} 00000000 0000")
    assert cell.valid


def test_every_scan_at_100_hz_has_a_reading_of_the_scan_before() -> None:
    made, cell, _, source = rig()
    made.run(1.0)
    assert len(source.asked) == pytest.approx(99, abs=1)
    assert 0.0 < made.now - cell.stamp_s < 0.015


def test_scans_at_20_hz_give_20_reads_a_second_and_no_more() -> None:
    made, _, _, source = rig(period_s=0.05)
    made.run(10.0)
    assert len(source.asked) == pytest.approx(199, abs=1)


def test_a_lost_reply_is_made_good_within_a_scan_of_50_ms() -> None:
    made, cell, _, _ = rig(period_s=0.05)
    made.run(1.0)
    made.wire.impair = Impairment("silence", count=1)
    made.run(0.05)
    assert cell.station.counters.timeouts == 1
    assert made.now - cell.stamp_s < 0.05


def test_a_slower_period_can_be_set() -> None:
    made, cell, _, source = rig()
    cell.period_s = 0.1
    made.run(10.0)
    assert len(source.asked) == pytest.approx(100, abs=3)


def test_a_lost_cell_is_invalid_and_is_identified_anew_when_it_is_back() -> None:
    made, cell, slave, _ = rig()
    made.run(0.5)
    slave.powered = False
    made.run(1.0)
    assert (cell.valid, cell.is_lost, cell.ready) == (False, True, False)
    slave.powered = True
    made.run(1.5)
    assert (cell.valid, cell.is_lost, cell.ready) == (True, False, True)
    assert len([1 for _, data in made.log.requests("010300640001") if data]) > 1


def test_a_transmitter_with_one_channel_gives_its_force_with_the_sign_of_the_status() -> None:
    bench = Bench()
    cell = Sensor(load_profile("laumas_tlb"), 1, bench.link)
    bench.serve(0.0)
    # Laumas: the magnitude, its sign in bit 7 of the status; 1000 counts of 0.01 kg.
    bench.serve(0.01, (0.005, reply(0x0880, 0, 1000)))
    assert cell.values == [pytest.approx(-98.0665)]
    assert cell.valid


def test_a_dat_400_gives_a_signed_force_behind_its_status() -> None:
    bench = Bench()
    cell = Sensor(load_profile("dat_400"), 4, bench.link)
    bench.serve(0.0)
    assert bench.frames == [with_crc(bytes.fromhex("040300000003"))]  # 40001 to 40003
    bench.serve(0.01, (0.005, reply(0x0002, 0xFFFF, 0xFC18, unit_id=4)))
    assert cell.values == [pytest.approx(-98.0665)]
    assert cell.valid
    bench.serve(0.02)
    bench.serve(0.03, (0.025, reply(1 << 5, 0, 1000, unit_id=4)))
    assert not cell.valid  # overload


def test_a_channel_that_the_sensor_does_not_have_is_unknown() -> None:
    bench = Bench()
    cell = Sensor(load_profile("one_axis_transmitter"), 1, bench.link, CHANNELS)
    bench.serve(0.0)
    bench.serve(0.01, (0.005, reply(0, 2500, 0)))
    assert cell.values[0] == pytest.approx(2.5)
    assert isnan(cell.values[2])


def test_a_profile_without_forces_is_refused() -> None:
    with pytest.raises(ProfileError, match="describes a jacket"):
        Sensor(load_profile("simulated_jacket"), 1, Bench().link)


@pytest.mark.parametrize("delay_s", [0.011, 0.014, 0.017])
def test_a_late_reply_inside_the_quarantine_never_becomes_a_reading(delay_s: float) -> None:
    made, cell, slave, source = rig()
    made.run(0.5)
    slave.frozen = True
    source.forces = (0.0, 0.0, 300.0, 0.0)
    made.wire.impair = Impairment("late", delay_s=delay_s)
    made.run(0.01)
    slave.frozen = False
    made.run(0.2)
    assert cell.values[2] == pytest.approx(300.0, abs=0.051)
    assert cell.station.counters.late == 1
    assert made.wire.collisions == 0


@pytest.mark.parametrize("kind", ["corrupt", "truncate", "noise", "wrong_id", "split", "lost", "silence", "exception"])
def test_one_bad_transaction_of_any_kind_leaves_no_reading_older_than_50_ms(kind: str) -> None:
    made, cell, _, _ = rig()
    made.run(0.5)
    made.wire.impair = Impairment(kind, delay_s=0.004, code=6)  # type: ignore[arg-type]
    for _ in range(20):
        made.run(0.01)
        assert made.now - cell.stamp_s < 0.05
    assert cell.valid
    assert cell.values[2] == pytest.approx(200.0, abs=0.051)


def test_a_reading_that_differs_from_the_one_before_is_a_change() -> None:
    bench, cell = connected()
    give(bench, "000007D0 FFFFFE70 00000FA0 000001F4 0000")
    bench.serve(0.03, (0.0255, reply(0, 2000, 0xFFFF, 0xFE70, 0, 4000, 0, 500, 0)))
    assert (cell.changed_s, cell.stamp_s) == (0.0155, 0.0255)
    bench.serve(0.04, (0.0355, reply(0, 2000, 0xFFFF, 0xFE70, 0, 4001, 0, 500, 0)))
    assert cell.changed_s == 0.0355


def test_a_tare_has_a_value_for_every_channel() -> None:
    _, cell = connected()
    with pytest.raises(ValueError, match="no tare of 1 values"):
        cell.set_tare((1.0,))
