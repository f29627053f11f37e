"""The SDO client against bytes, and against a small server written here."""

from __future__ import annotations

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.canopen.sdo import SdoClient, abort_text


def frame(text: str) -> bytes:
    return bytes.fromhex(text)


def test_an_expedited_upload_asks_and_takes_two_bytes() -> None:
    client = SdoClient()
    assert client.upload(0x6041, 0, now=0.0) == frame("40 41 60 00 00 00 00 00")
    assert client.feed(frame("4B 41 60 00 37 06 00 00"), now=0.001) is None
    assert (client.busy, client.error, client.result) == (False, None, frame("37 06"))


def test_an_expedited_upload_without_size_has_four_bytes() -> None:
    client = SdoClient()
    client.upload(0x1000, 0, now=0.0)
    client.feed(frame("42 00 10 00 92 01 02 00"), now=0.001)
    assert client.result == frame("92 01 02 00")


@pytest.mark.parametrize(("data", "request_frame"), [
    ("05", "2F 60 60 00 05 00 00 00"),
    ("0F 00", "2B 60 60 00 0F 00 00 00"),
    ("01 02 03", "27 60 60 00 01 02 03 00"),
    ("C8 00 7F 00", "23 60 60 00 C8 00 7F 00"),
])
def test_an_expedited_download_states_its_size(data: str, request_frame: str) -> None:
    client = SdoClient()
    assert client.download(0x6060, 0, frame(data), now=0.0) == frame(request_frame)
    assert client.feed(frame("60 60 60 00 00 00 00 00"), now=0.001) is None
    assert (client.busy, client.error) == (False, None)


def test_a_segmented_upload_alternates_the_toggle_bit() -> None:
    client = SdoClient()
    client.upload(0x1008, 0, now=0.0)
    assert client.feed(frame("41 08 10 00 0A 00 00 00"), now=0.001) == frame("60 00 00 00 00 00 00 00")
    assert client.feed(b"\x00servo d", now=0.002) == frame("70 00 00 00 00 00 00 00")
    assert client.feed(b"\x19riv\0\0\0\0", now=0.003) is None
    assert client.result == b"servo driv"


def test_a_segmented_download_alternates_the_toggle_bit() -> None:
    client = SdoClient()
    assert client.download(0x2000, 1, b"servo driv", now=0.0) == frame("21 00 20 01 0A 00 00 00")
    assert client.feed(frame("60 00 20 01 00 00 00 00"), now=0.001) == b"\x00servo d"
    assert client.feed(frame("20 00 00 00 00 00 00 00"), now=0.002) == b"\x19riv\0\0\0\0"
    assert client.feed(frame("30 00 00 00 00 00 00 00"), now=0.003) is None
    assert (client.busy, client.error) == (False, None)


def test_an_abort_ends_the_transfer_with_its_meaning() -> None:
    client = SdoClient()
    client.upload(0x6502, 0, now=0.0)
    client.feed(frame("80 02 65 00 00 00 02 06"), now=0.001)
    assert client.error is not None
    assert client.error.code == 0x06020000
    assert str(client.error) == "abort 0x06020000 (object does not exist)"
    assert not client.busy


def test_both_refusals_of_a_drive_in_the_wrong_state_name_it() -> None:
    assert "refused in this state" in abort_text(0x06090030)
    assert "refused in the present device state" in abort_text(0x08000022)


def test_a_reply_for_another_object_is_not_taken() -> None:
    client = SdoClient()
    client.upload(0x6041, 0, now=0.0)
    assert client.feed(frame("4B 64 60 00 99 99 00 00"), now=0.001) is None
    assert (client.busy, client.ignored) == (True, 1)


def test_an_abort_of_another_object_is_not_taken() -> None:
    client = SdoClient()
    client.upload(0x6041, 0, now=0.0)
    client.feed(frame("80 64 60 00 00 00 02 06"), now=0.001)
    assert (client.busy, client.ignored) == (True, 1)


def test_silence_ends_in_an_abort_frame_and_a_time_out() -> None:
    client = SdoClient(timeout_s=0.3)
    client.upload(0x6041, 0, now=1.0)
    assert client.expire(now=1.29) is None
    assert client.expire(now=1.3) == frame("80 41 60 00 00 00 04 05")
    assert str(client.error) == "no reply within 0.3 s"


def test_every_segment_has_its_own_time_out() -> None:
    client = SdoClient(timeout_s=0.3)
    client.upload(0x1008, 0, now=0.0)
    client.feed(frame("41 08 10 00 0A 00 00 00"), now=0.29)
    assert client.expire(now=0.5) is None
    assert client.due == pytest.approx(0.59)


def test_a_repeated_toggle_bit_aborts_the_upload() -> None:
    client = SdoClient()
    client.upload(0x1008, 0, now=0.0)
    client.feed(frame("41 08 10 00 0A 00 00 00"), now=0.001)
    client.feed(b"\x00servo d", now=0.002)
    assert client.feed(b"\x09riv\0\0\0\0", now=0.003) == frame("80 08 10 00 00 00 03 05")
    assert "toggle bit" in str(client.error)


def test_a_repeated_toggle_bit_aborts_the_download() -> None:
    client = SdoClient()
    client.download(0x2000, 1, b"servo driv", now=0.0)
    client.feed(frame("60 00 20 01 00 00 00 00"), now=0.001)
    assert client.feed(frame("30 00 00 00 00 00 00 00"), now=0.002) == frame("80 00 20 01 00 00 03 05")


@pytest.mark.parametrize("segments", [[b"\x00servo d", b"\x17ri\0\0\0\0\0"], [b"\x01servo d"],
                                      [b"\x00servo d", b"\x10rive no", b"\x01. 1 and"]])
def test_a_text_of_another_length_than_announced_is_refused(segments: list[bytes]) -> None:
    client = SdoClient()
    client.upload(0x1008, 0, now=0.0)
    client.feed(frame("41 08 10 00 0A 00 00 00"), now=0.001)
    for segment in segments:
        if client.busy:
            client.feed(segment, now=0.002)
    assert client.error is not None
    assert client.error.code == 0x06070010


def test_an_absurd_length_is_refused() -> None:
    client = SdoClient()
    client.upload(0x1008, 0, now=0.0)
    assert client.feed(frame("41 08 10 00 00 00 00 40"), now=0.001) == frame("80 08 10 00 05 00 04 05")


def test_a_reply_of_the_wrong_kind_is_refused() -> None:
    client = SdoClient()
    client.download(0x6040, 0, b"\0\0", now=0.0)
    assert client.feed(frame("4B 40 60 00 00 00 00 00"), now=0.001) == frame("80 40 60 00 01 00 04 05")


def test_a_short_frame_is_no_reply() -> None:
    client = SdoClient()
    client.upload(0x6041, 0, now=0.0)
    assert client.feed(frame("4B 41 60 00"), now=0.001) is None
    assert client.busy


def test_a_second_transfer_is_refused_while_one_runs() -> None:
    client = SdoClient()
    client.upload(0x6041, 0, now=0.0)
    with pytest.raises(ValueError, match="0x6041:00 is still"):
        client.upload(0x6064, 0, now=0.0)


class Server:
    """One value behind an SDO server, written from CiA 301 and apart from the client."""

    def __init__(self, value: bytes) -> None:
        self.value = value
        self.incoming = b""
        self.sent = 0

    def answer(self, request: bytes) -> bytes:
        command = request[0]
        if command == 0x40:
            if 1 <= len(self.value) <= 4:
                return bytes([0x43 | (4 - len(self.value)) << 2]) + request[1:4] + self.value.ljust(4, b"\0")
            return b"\x41" + request[1:4] + struct.pack("<I", len(self.value))
        if command >> 5 == 3:
            part = self.value[self.sent:self.sent + 7]
            self.sent += len(part)
            last = self.sent >= len(self.value)
            return bytes([command & 0x10 | (7 - len(part)) << 1 | last]) + part.ljust(7, b"\0")
        if command >> 5 == 1:
            if command & 2:
                self.value = request[4:8 - (command >> 2 & 3)]
            return b"\x60" + request[1:4] + bytes(4)
        self.incoming += request[1:8 - (command >> 1 & 7)]
        if command & 1:
            self.value = self.incoming
        return bytes([0x20 | command & 0x10]) + bytes(7)


def transfer(client: SdoClient, server: Server, request: bytes | None) -> None:
    while request is not None:
        request = client.feed(server.answer(request), now=0.0)


@given(st.binary(max_size=300))
def test_any_value_is_read_back_whole(value: bytes) -> None:
    client = SdoClient()
    transfer(client, Server(value), client.upload(0x2000, 3, now=0.0))
    assert (client.error, client.result) == (None, value)


@given(st.binary(max_size=300))
def test_any_value_is_written_whole(value: bytes) -> None:
    client, server = SdoClient(), Server(b"before")
    transfer(client, server, client.download(0x2000, 3, value, now=0.0))
    assert (client.error, server.value) == (None, value)


@given(st.lists(st.binary(min_size=8, max_size=8), max_size=12))
def test_no_reply_whatever_breaks_the_client(replies: list[bytes]) -> None:
    client = SdoClient()
    client.upload(0x1008, 0, now=0.0)
    for reply in replies:
        client.feed(reply, now=0.0)
    client.expire(now=1.0)
    assert not client.busy
