"""NMT, heartbeat, EMCY and data type codecs, and the object dictionary."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.canopen import heartbeat
from drivers.canopen.dictionary import DICTIONARY, describe
from drivers.canopen.heartbeat import HeartbeatMonitor
from drivers.canopen.messages import (
    decode_emergency,
    encode_emergency,
    encode_nmt,
    register_text,
    state_name,
)
from drivers.canopen.objects import DataType, NmtCommand, decode, emergency_text, encode


def test_an_nmt_frame_is_command_and_node() -> None:
    assert encode_nmt(NmtCommand.RESET_COMMUNICATION, 5) == b"\x82\x05"


@pytest.mark.parametrize(("state", "name"), [(0, "BOOT-UP"), (5, "OPERATIONAL"), (127, "PRE-OPERATIONAL"),
                                             (9, "unknown state 9")])
def test_a_heartbeat_state_has_a_name(state: int, name: str) -> None:
    assert state_name(state) == name


def test_the_consumer_heartbeat_of_the_rig_is_node_127_and_200_ms() -> None:
    assert heartbeat.consumer_entry(127, 0.2) == 0x007F00C8


def test_the_node_guarding_toggle_bit_of_a_heartbeat_is_masked() -> None:
    assert heartbeat.state_of(b"\x85") == 5


@pytest.mark.parametrize("data", [b"", b"\x05\x00"])
def test_a_heartbeat_of_another_length_has_no_state(data: bytes) -> None:
    assert heartbeat.state_of(data) is None


def test_a_monitor_is_due_three_periods_after_the_last_heartbeat() -> None:
    monitor = HeartbeatMonitor(period_s=0.05)
    monitor.arrived(1.0)
    monitor.arm()
    assert monitor.due == pytest.approx(1.15)
    assert not monitor.expired(1.149)
    assert monitor.expired(1.1501)


def test_a_monitor_reports_a_loss_once_and_keeps_it() -> None:
    monitor = HeartbeatMonitor(period_s=0.05)
    monitor.arrived(1.0)
    monitor.arm()
    monitor.expired(2.0)
    monitor.arrived(2.1)
    assert monitor.lost
    assert not monitor.expired(3.0)


def test_a_monitor_that_is_not_armed_never_expires() -> None:
    monitor = HeartbeatMonitor(period_s=0.05)
    monitor.arrived(1.0)
    assert monitor.due == math.inf


def test_an_emergency_frame_decodes() -> None:
    emergency = decode_emergency(bytes.fromhex("3081 11 0102030405"), t=3.5)
    assert (emergency.code, emergency.register, emergency.vendor, emergency.t) == (
        0x8130, 0x11, bytes.fromhex("0102030405"), 3.5)
    assert emergency.text == "0x8130 heartbeat of the master lost"
    assert not emergency.is_reset


def test_code_zero_reports_that_the_error_has_gone() -> None:
    assert decode_emergency(bytes(8), t=0.0).is_reset


@pytest.mark.parametrize("data", [b"", b"\x10", b"\x10\x23", b"\x10\x23\x03"])
def test_a_short_emergency_is_still_an_emergency(data: bytes) -> None:
    emergency = decode_emergency(data, t=0.0)
    assert not emergency.is_reset
    assert f"short EMCY of {len(data)} bytes" in emergency.text


@pytest.mark.parametrize(("code", "text"), [
    (0x2310, "0x2310 over-current"), (0x2399, "0x2399 current, output side"), (0x25FF, "0x25FF current"),
    (0xFF07, "0xFF07 vendor specific"), (0x0100, "0x0100 unknown error")])
def test_an_error_code_has_a_text(code: int, text: str) -> None:
    assert emergency_text(code) == text


@given(st.integers(0, 0xFFFF), st.integers(0, 0xFF), st.binary(min_size=5, max_size=5))
def test_emergencies_survive_the_wire(code: int, register: int, vendor: bytes) -> None:
    emergency = decode_emergency(encode_emergency(code, register, vendor), t=0.0)
    assert (emergency.code, emergency.register, emergency.vendor) == (code, register, vendor)


def test_the_error_register_is_spelled_out() -> None:
    assert register_text(0x11) == "generic, communication"
    assert register_text(0) == "none"


@pytest.mark.parametrize(("kind", "value", "data"), [
    (DataType.I8, -3, "FD"), (DataType.U16, 0x6041, "41 60"), (DataType.I32, -1, "FF FF FF FF"),
    (DataType.U32, 0x007F00C8, "C8 00 7F 00"), (DataType.TEXT, "servo", "73 65 72 76 6F")])
def test_values_are_little_endian(kind: DataType, value: int | str, data: str) -> None:
    assert encode(kind, value) == bytes.fromhex(data)
    assert decode(kind, bytes.fromhex(data)) == value


@pytest.mark.parametrize(("kind", "value"), [(DataType.U8, 256), (DataType.U16, -1), (DataType.U8, "1"),
                                             (DataType.TEXT, 1)])
def test_a_value_that_does_not_fit_its_type_is_refused(kind: DataType, value: int | str) -> None:
    with pytest.raises(ValueError, match=kind.name):
        encode(kind, value)


def test_bytes_of_another_length_than_the_type_are_refused() -> None:
    with pytest.raises(ValueError, match="U16 has 2 bytes, 4 came"):
        decode(DataType.U16, bytes(4))


def test_every_default_fits_its_type() -> None:
    for entry in DICTIONARY.values():
        assert decode(entry.type, encode(entry.type, entry.initial(126))) == entry.initial(126)


def test_the_highest_sub_index_of_every_record_exists() -> None:
    for (index, sub), entry in DICTIONARY.items():
        if sub == 0 and (index, 1) in DICTIONARY and entry.access == "const":
            assert (index, entry.default) in DICTIONARY, f"0x{index:04X}"


def test_cob_ids_follow_the_node() -> None:
    assert DICTIONARY[0x1800, 1].initial(5) == 0x40000185
    assert DICTIONARY[0x1014, 0].initial(5) == 0x85


def test_an_object_is_described_by_address_and_name() -> None:
    assert describe(0x6083, 0) == "0x6083:00 (profile acceleration)"
    assert describe(0x2000, 1) == "0x2000:01"
