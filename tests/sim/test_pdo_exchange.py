"""Process data of the simulated drive: mapping rules, transmission types, deadlines, lengths (CiA 301, 7.5.2.35-38)."""

from __future__ import annotations

import math
import struct
from itertools import pairwise

import pytest

from tests.sim.drive_bench import ENABLED, NODE, PRESS, READY, DriveBench

TPDO1, TPDO2, RPDO1, RPDO2 = 0x180 + NODE, 0x280 + NODE, 0x200 + NODE, 0x300 + NODE
INVALID = 0x80000000
REFUSED_ACCESS = 0x06010000


@pytest.fixture
def bench() -> DriveBench:
    return DriveBench().boot()


# mapping rules


def test_a_pdo_is_mapped_in_the_prescribed_order(bench: DriveBench) -> None:
    bench.map(0x1800, 0x1A00, 0x40000000 | TPDO1, 1, (0x60410010, 0x60640020))
    bench.nmt(1)
    bench.sync()
    bench.run(0.01)
    assert len(bench.frames(TPDO1)[-1]) == 6


def test_the_mapping_of_a_valid_pdo_is_not_changed(bench: DriveBench) -> None:
    assert bench.refusal(0x1A00, 0, 0, 1) == REFUSED_ACCESS
    assert bench.refusal(0x1A00, 1, 0x60410010, 4) == REFUSED_ACCESS


def test_entries_are_not_changed_before_their_number_is_zero(bench: DriveBench) -> None:
    bench.write(0x1800, 1, INVALID | TPDO1, 4)
    assert bench.refusal(0x1A00, 1, 0x60410010, 4) == REFUSED_ACCESS


def test_the_identifier_of_a_valid_pdo_is_not_changed(bench: DriveBench) -> None:
    assert bench.refusal(0x1800, 1, 0x40000190, 4) == 0x06090030
    bench.write(0x1800, 1, INVALID | TPDO1, 4)
    bench.write(0x1800, 1, 0x40000190, 4)


@pytest.mark.parametrize("cob_id", [0x20000185, 0x00000000, 0x080, 0x585, 0x605, 0x705, 0x800])
def test_reserved_and_extended_identifiers_are_refused(bench: DriveBench, cob_id: int) -> None:
    bench.write(0x1800, 1, INVALID | TPDO1, 4)
    if cob_id == 0x080:
        cob_id = 0x07F
    assert bench.refusal(0x1800, 1, cob_id, 4) == 0x06090030


@pytest.mark.parametrize(
    ("entry", "code"),
    [
        (0x12340020, 0x06020000),
        (0x60830020, 0x06040041),  # exists, cannot be mapped
        (0x60410020, 0x06040041),  # wrong width
        (0x10180120, 0x06040041),
    ],
)
def test_an_object_that_cannot_be_mapped_is_refused(bench: DriveBench, entry: int, code: int) -> None:
    bench.write(0x1800, 1, INVALID | TPDO1, 4)
    bench.write(0x1A00, 0, 0, 1)
    assert bench.refusal(0x1A00, 1, entry, 4) == code


def test_a_read_only_object_is_not_received(bench: DriveBench) -> None:
    bench.write(0x1400, 1, INVALID | RPDO1, 4)
    bench.write(0x1600, 0, 0, 1)
    assert bench.refusal(0x1600, 1, 0x60410010, 4) == 0x06040041


def test_more_than_eight_bytes_are_refused_with_the_number_of_entries(bench: DriveBench) -> None:
    bench.write(0x1800, 1, INVALID | TPDO1, 4)
    bench.write(0x1A00, 0, 0, 1)
    for sub, entry in enumerate((0x60640020, 0x606C0020, 0x60410010), start=1):
        bench.write(0x1A00, sub, entry, 4)
    assert bench.refusal(0x1A00, 0, 3, 1) == 0x06040042
    bench.write(0x1A00, 0, 2, 1)


def test_more_entries_than_the_device_has_are_refused(bench: DriveBench) -> None:
    bench.write(0x1800, 1, INVALID | TPDO1, 4)
    assert bench.refusal(0x1A00, 0, 5, 1) == 0x06040042


@pytest.mark.parametrize("kind", [241, 252, 253])
def test_reserved_transmission_types_are_refused(bench: DriveBench, kind: int) -> None:
    assert bench.refusal(0x1800, 2, kind, 1) == 0x06090030


def test_a_disabled_pdo_is_neither_sent_nor_received() -> None:
    bench = DriveBench().configured()
    bench.write(0x1400, 1, INVALID | RPDO1, 4)
    bench.write(0x1800, 1, INVALID | 0x40000000 | TPDO1, 4)
    bench.cycle(0x06)
    assert bench.frames(TPDO1) == []
    assert bench.state == 0x40


def test_a_pdo_may_have_another_identifier() -> None:
    bench = DriveBench().configured()
    bench.write(0x1400, 1, INVALID | RPDO1, 4)
    bench.write(0x1400, 1, 0x0000_0333, 4)
    bench.cycle(0x06)
    assert bench.state == 0x40
    bench.send(0x333, struct.pack("<Hi", 0x06, 0))
    bench.sync()
    bench.run(0.01)
    assert bench.state == READY


# transmission types


def test_a_synchronous_rpdo_acts_with_the_sync() -> None:
    bench = DriveBench().configured()
    bench.send(RPDO1, struct.pack("<Hi", 0x06, 0))
    bench.run(0.05)
    assert bench.state == 0x40
    bench.sync()
    assert bench.state == READY


def test_an_event_driven_rpdo_acts_at_once() -> None:
    bench = DriveBench().configured()
    bench.write(0x1400, 2, 255, 1)
    bench.send(RPDO1, struct.pack("<Hi", 0x06, 0))
    assert bench.state == READY


def test_a_synchronous_rpdo_that_was_repeated_counts_once_more_after_an_sdo_write() -> None:
    bench = DriveBench().configured()
    bench.cycle(0x06)
    bench.write(0x6040, 0, 0x00, 2)
    assert bench.state == 0x40
    bench.cycle(0x06)
    assert bench.state == READY


def test_the_tpdo_follows_the_sync_by_its_wire_time() -> None:
    bench = DriveBench().configured()
    bench.heard.clear()
    start = bench.now
    bench.sync()
    bench.run(0.01)
    assert bench.times(TPDO1) == [pytest.approx(start + (55 + 135) / 500_000)]


@pytest.mark.parametrize(("kind", "expected"), [(1, 12), (3, 4), (240, 0)])
def test_a_cyclic_tpdo_goes_with_every_nth_sync(kind: int, expected: int) -> None:
    bench = DriveBench().configured()
    bench.write(0x1800, 2, kind, 1)
    for _ in range(12):
        bench.sync()
        bench.run(0.01)
    assert len(bench.frames(TPDO1)) == expected


def test_an_acyclic_tpdo_goes_with_the_sync_after_a_change() -> None:
    bench = DriveBench().configured()
    bench.write(0x1800, 2, 0, 1)
    counts: list[int] = []
    for controlword in (0x00, 0x00, 0x06, 0x06):
        bench.cycle(controlword)
        counts.append(len(bench.frames(TPDO1)))
    assert counts == [1, 1, 2, 2]


def test_an_event_driven_tpdo_goes_when_the_statusword_changes() -> None:
    bench = DriveBench().configured()
    bench.write(0x1800, 2, 255, 1)
    bench.heard.clear()
    bench.write(0x6040, 0, 0x06, 2)
    assert len(bench.frames(TPDO1)) == 1
    assert bench.sample()[0] & 0x6F == READY


def test_an_event_timer_repeats_an_event_driven_tpdo() -> None:
    bench = DriveBench().configured()
    bench.write(0x1800, 2, 255, 1)
    bench.write(0x1800, 5, 100, 2)
    bench.nmt(128)
    bench.nmt(1)
    bench.heard.clear()
    bench.run(1.05)
    assert len(bench.frames(TPDO1)) == 11  # one at the start, one every 100 ms


def test_the_inhibit_time_spaces_event_driven_tpdos() -> None:
    bench = DriveBench().configured()
    bench.write(0x1800, 1, INVALID | TPDO1, 4)
    bench.write(0x1800, 2, 255, 1)
    bench.write(0x1800, 3, 1000, 2)  # 100 ms
    bench.write(0x1800, 1, TPDO1, 4)
    bench.nmt(128)
    bench.nmt(1)
    bench.heard.clear()
    for number in range(8):
        bench.write(0x6040, 0, (0x06, 0x07)[number % 2], 2)
    bench.run(0.3)
    times = bench.times(TPDO1)
    assert len(times) >= 2
    assert all(later - earlier >= 0.0999 for earlier, later in pairwise(times))


def test_a_tpdo_with_a_new_state_is_urgent() -> None:
    bench = DriveBench().configured()
    bench.send(RPDO1, struct.pack("<Hi", 0x06, 0))
    bench.sync()
    assert bench.wire.urgent_s < bench.now + 0.002


def test_a_tpdo_without_news_is_not_urgent() -> None:
    bench = DriveBench().configured()
    bench.cycle(0x06)
    bench.sync()
    assert bench.wire.urgent_s > bench.now + 1.0


def test_any_mapping_is_packed_in_its_order() -> None:
    bench = DriveBench(PRESS).configured()
    bench.map(0x1800, 0x1A00, 0x40000000 | TPDO1, 1, (0x60610008, 0x10010008, 0x60FD0020, 0x60410010))
    bench.sync()
    bench.run(0.01)
    mode, register, inputs, status = struct.unpack("<bBIH", bench.tpdo)
    assert (mode, register, inputs) == (3, 0, 0x00030000)
    assert status == bench.statusword


# lengths and deadlines


def test_a_short_rpdo_is_reported_and_not_processed() -> None:
    bench = DriveBench().configured()
    bench.send(RPDO1, b"\x06\x00")
    bench.sync()
    bench.run(0.01)
    assert [code for code, _ in bench.emergencies] == [0x8210]
    assert bench.state == 0x40


def test_a_long_rpdo_is_reported_and_processed() -> None:
    bench = DriveBench().configured()
    bench.send(RPDO1, struct.pack("<Hih", 0x06, 0, 0))
    bench.sync()
    bench.run(0.01)
    assert [code for code, _ in bench.emergencies] == [0x8220]
    assert bench.state == READY


def test_an_rpdo_of_the_right_length_resets_the_error() -> None:
    bench = DriveBench().configured()
    bench.send(RPDO1, b"\x06\x00")
    bench.cycle(0x06)
    assert [code for code, _ in bench.emergencies] == [0x8210, 0x0000]


def deadline(milliseconds: int = 100) -> DriveBench:
    bench = DriveBench().enabled()
    bench.write(0x6007, 0, 3, 2)
    bench.write(0x1400, 5, milliseconds, 2)
    return bench


def test_the_deadline_starts_with_the_first_rpdo() -> None:
    bench = deadline()
    bench.run(1.0)
    assert bench.emergencies == []


def test_unchanged_rpdos_keep_the_deadline() -> None:
    bench = deadline()
    for _ in range(20):
        bench.cycle(0x0F, 1000, 0.08)
    assert bench.emergencies == []
    assert bench.state == ENABLED


def test_rpdos_of_a_repeated_cycle_keep_the_deadline_and_their_end_misses_it() -> None:
    bench = deadline()
    can_ids, payloads = (RPDO1, 0x080), (struct.pack("<Hi", 0x0F, 1000), b"")
    for _ in range(20):
        bench.wire.send_cycle(can_ids, payloads, bench.now)
        bench.run(0.08)
    assert bench.emergencies == []
    last = bench.now - 0.08
    bench.wire.forget_cycle()
    bench.run(0.5)
    assert [code for code, _ in bench.emergencies] == [0x8250]
    assert bench.times(0x080 + NODE)[0] == pytest.approx(last + 0.1, abs=0.002)


def test_a_repeated_cycle_without_the_rpdo_misses_the_deadline() -> None:
    bench = deadline()
    data = struct.pack("<Hi", 0x0F, 1000)
    for can_ids, payloads in (((RPDO1, 0x080), (data, b"")),) * 5 + (((0x080,), (b"",)),) * 5:
        bench.wire.send_cycle(can_ids, payloads, bench.now)
        bench.run(0.08)
    assert [code for code, _ in bench.emergencies] == [0x8250]


def test_a_missed_deadline_is_an_emergency_and_a_quick_stop() -> None:
    bench = deadline()
    bench.cycle(0x0F, 1000)
    last = bench.now - 0.01
    bench.run(0.5)
    assert [code for code, _ in bench.emergencies] == [0x8250]
    assert bench.times(0x080 + NODE)[0] == pytest.approx(last + 0.1, abs=0.001)
    assert bench.state == 0x40
    assert bench.drive.axis.value == 0.0


def test_the_next_rpdo_ends_a_missed_deadline() -> None:
    bench = deadline()
    bench.cycle(0x0F, 1000)
    bench.run(0.5)
    bench.cycle(0x00)
    assert [code for code, _ in bench.emergencies] == [0x8250, 0x0000]


# digital inputs and outputs


def io_bench() -> DriveBench:
    bench = DriveBench(PRESS).configured()
    bench.map(0x1401, 0x1601, RPDO2, 255, (0x60FE0120,))
    bench.map(0x1801, 0x1A01, 0x40000000 | TPDO2, 255, (0x60FD0020,))
    bench.write(0x60FE, 2, 0xFFFF0000, 4)
    return bench


def test_inputs_are_sent_at_start_and_on_change() -> None:
    bench = io_bench()
    bench.nmt(128)
    bench.nmt(1)
    bench.run(0.1)
    bench.drive.set_guard(False)
    bench.run(0.1)
    words = [int.from_bytes(data, "little") for data in bench.frames(TPDO2)]
    assert words[-2:] == [0x00030000, 0x00010000]


def test_inputs_are_sent_again_by_their_timer() -> None:
    bench = io_bench()
    bench.write(0x1801, 5, 100, 2)
    bench.nmt(128)
    bench.nmt(1)
    before = len(bench.frames(TPDO2))
    bench.run(1.05)
    assert len(bench.frames(TPDO2)) - before in (10, 11)


def test_inputs_repeated_by_their_timer_are_not_urgent() -> None:
    bench = io_bench()
    bench.write(0x1801, 5, 100, 2)
    bench.nmt(128)
    bench.nmt(1)
    bench.run(0.05)
    bench.drive.advance(bench.now, bench.now + 0.1)
    assert bench.wire.urgent_s == math.inf


def test_an_input_change_is_urgent() -> None:
    bench = io_bench()
    bench.drive.set_safety_chain(False)
    assert bench.wire.urgent_s < bench.now + 0.001


def test_the_contactor_follows_the_request_and_reports() -> None:
    bench = io_bench()
    bench.send(RPDO2, (1 << 16).to_bytes(4, "little"))
    bench.run(0.02)
    assert bench.read(0x60FD) == 0x00030000
    bench.run(0.02)
    assert bench.read(0x60FD) == 0x00070000
    assert bench.drive.io is not None
    assert bench.drive.io.contactor_closed


def test_a_masked_output_does_nothing() -> None:
    bench = io_bench()
    bench.write(0x60FE, 2, 0, 4)
    bench.send(RPDO2, (1 << 16).to_bytes(4, "little"))
    bench.run(0.2)
    assert bench.read(0x60FD) == 0x00030000


def test_the_contactor_drops_out_when_process_data_end() -> None:
    bench = io_bench()
    bench.send(RPDO2, (1 << 16).to_bytes(4, "little"))
    bench.run(0.1)
    bench.nmt(128)
    bench.run(0.1)
    assert bench.read(0x60FD) == 0x00030000


def test_the_contactor_drops_out_when_the_drive_loses_its_power() -> None:
    bench = io_bench()
    bench.send(RPDO2, (1 << 16).to_bytes(4, "little"))
    bench.run(0.1)
    bench.drive.power(False)
    bench.run(0.1)
    assert bench.drive.io is not None
    assert not bench.drive.io.contactor_closed


def test_the_contactor_drops_out_with_a_lost_heartbeat() -> None:
    bench = io_bench()
    bench.write(0x1029, 1, 1, 1)
    bench.write(0x1016, 1, 127 << 16 | 200, 4)
    bench.heartbeat()
    bench.send(RPDO2, (1 << 16).to_bytes(4, "little"))
    bench.run(0.1)
    assert bench.read(0x60FD) == 0x00070000
    bench.run(0.3)
    assert bench.read(0x60FD) == 0x00030000
