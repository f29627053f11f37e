"""The SDO server on bytes: expedited and segmented transfers, toggle, abort codes (CiA 301, 7.2.4)."""

from __future__ import annotations

import pytest

from drivers.canopen.sdo import NO_OBJECT, READ_ONLY
from sim.nodes.object_store import SdoAbortError
from sim.nodes.sdo_server import MAX_OBJECT_BYTES, SdoServer

LONG = b"a long device name"


class Objects:
    """A tiny dictionary: 0x2000 holds 4 bytes, 0x2001 a text of any length, 0x2002 nothing writable."""

    def __init__(self) -> None:
        self.values = {0x2000: b"\x78\x56\x34\x12", 0x2001: LONG, 0x2002: b"\x07", 0x2003: b""}
        self.exact: bool | None = None

    def upload(self, index: int, sub: int) -> bytes:
        if index not in self.values:
            raise SdoAbortError(NO_OBJECT)
        return self.values[index]

    def check_writable(self, index: int, sub: int) -> None:
        self.upload(index, sub)
        if index == 0x2002:
            raise SdoAbortError(READ_ONLY)

    def download(self, index: int, sub: int, data: bytes, exact: bool) -> None:
        self.check_writable(index, sub)
        self.values[index] = data
        self.exact = exact


@pytest.fixture
def objects() -> Objects:
    return Objects()


@pytest.fixture
def server(objects: Objects) -> SdoServer:
    return SdoServer(objects)


def ask(server: SdoServer, request: str) -> str:
    reply = server.request(bytes.fromhex(request))
    assert reply is not None
    assert len(reply) == 8
    return reply.hex(" ")


def test_four_bytes_are_uploaded_expedited(server: SdoServer) -> None:
    assert ask(server, "40 00 20 00 00000000") == "43 00 20 00 78 56 34 12"


def test_one_byte_is_uploaded_expedited_with_its_size(server: SdoServer) -> None:
    assert ask(server, "40 02 20 00 00000000") == "4f 02 20 00 07 00 00 00"


def test_four_bytes_are_downloaded_expedited(server: SdoServer, objects: Objects) -> None:
    assert ask(server, "23 00 20 00 01020304") == "60 00 20 00 00 00 00 00"
    assert objects.values[0x2000] == b"\x01\x02\x03\x04"


def test_the_size_of_an_expedited_download_is_taken_from_the_command(server: SdoServer, objects: Objects) -> None:
    ask(server, "2b 00 20 00 0102ffff")
    assert (objects.values[0x2000], objects.exact) == (b"\x01\x02", True)


def test_an_expedited_download_without_size_leaves_it_to_the_object(server: SdoServer, objects: Objects) -> None:
    ask(server, "22 00 20 00 0102ffff")
    assert (objects.values[0x2000], objects.exact) == (b"\x01\x02\xff\xff", False)


def test_a_long_value_is_uploaded_in_segments_with_toggle(server: SdoServer) -> None:
    assert ask(server, "40 01 20 00 00000000") == "41 01 20 00 12 00 00 00"
    assert ask(server, "60 00000000000000") == "00 " + LONG[:7].hex(" ")
    assert ask(server, "70 00000000000000") == "10 " + LONG[7:14].hex(" ")
    assert ask(server, "60 00000000000000") == "07 " + LONG[14:].hex(" ") + " 00 00 00"


def test_an_empty_value_is_uploaded_as_one_empty_segment(server: SdoServer) -> None:
    assert ask(server, "40 03 20 00 00000000") == "41 03 20 00 00 00 00 00"
    assert ask(server, "60 00000000000000") == "0f 00 00 00 00 00 00 00"


def test_a_long_value_is_downloaded_in_segments(server: SdoServer, objects: Objects) -> None:
    assert ask(server, "21 01 20 00 09000000") == "60 01 20 00 00 00 00 00"
    assert ask(server, "00 31323334353637") == "20 00 00 00 00 00 00 00"
    assert ask(server, "1b 38390000000000") == "30 00 00 00 00 00 00 00"
    assert objects.values[0x2001] == b"123456789"


def test_a_wrong_toggle_in_an_upload_aborts_it(server: SdoServer) -> None:
    ask(server, "40 01 20 00 00000000")
    assert ask(server, "70 00000000000000") == "80 01 20 00 00 00 03 05"
    assert ask(server, "60 00000000000000") == "80 00 00 00 01 00 04 05"


def test_a_wrong_toggle_in_a_download_aborts_it_and_writes_nothing(server: SdoServer, objects: Objects) -> None:
    ask(server, "21 01 20 00 09000000")
    assert ask(server, "10 31323334353637") == "80 01 20 00 00 00 03 05"
    assert objects.values[0x2001] == LONG


def test_more_segments_than_announced_are_a_length_error(server: SdoServer) -> None:
    ask(server, "21 01 20 00 08000000")
    ask(server, "00 31323334353637")
    assert ask(server, "11 31323334353637") == "80 01 20 00 10 00 07 06"


def test_fewer_segments_than_announced_are_a_length_error(server: SdoServer, objects: Objects) -> None:
    ask(server, "21 01 20 00 09000000")
    assert ask(server, "01 31323334353637") == "80 01 20 00 10 00 07 06"
    assert objects.values[0x2001] == LONG


def test_a_download_without_end_runs_out_of_memory(server: SdoServer) -> None:
    ask(server, "20 01 20 00 00000000")
    for number in range(MAX_OBJECT_BYTES // 7):
        ask(server, f"{number % 2 << 4:02x} 31323334353637")
    assert ask(server, f"{MAX_OBJECT_BYTES // 7 % 2 << 4:02x} 31323334353637") == "80 01 20 00 05 00 04 05"


def test_an_announced_size_beyond_memory_is_refused_at_once(server: SdoServer) -> None:
    assert ask(server, "21 01 20 00 00001000") == "80 01 20 00 05 00 04 05"


def test_a_segmented_download_of_a_read_only_object_is_refused_at_once(server: SdoServer) -> None:
    assert ask(server, "21 02 20 00 09000000") == "80 02 20 00 02 00 01 06"


def test_an_unknown_object_is_named_in_the_abort(server: SdoServer) -> None:
    assert ask(server, "40 34 12 56 00000000") == "80 34 12 56 00 00 02 06"


@pytest.mark.parametrize("request_hex", ["a4 00 20 00 7f000000", "c2 00 20 00 04000000"])
def test_block_transfer_is_an_unknown_command(server: SdoServer, request_hex: str) -> None:
    assert ask(server, request_hex) == "80 00 20 00 01 00 04 05"


def test_a_segment_of_no_transfer_is_an_unknown_command(server: SdoServer) -> None:
    assert ask(server, "60 00000000000000") == "80 00 00 00 01 00 04 05"


def test_an_abort_of_the_client_ends_the_transfer_unanswered(server: SdoServer) -> None:
    ask(server, "40 01 20 00 00000000")
    assert server.request(bytes.fromhex("80 01 20 00 00000405")) is None
    assert ask(server, "60 00000000000000").startswith("80")


def test_a_new_request_takes_the_place_of_a_transfer(server: SdoServer) -> None:
    ask(server, "40 01 20 00 00000000")
    assert ask(server, "40 00 20 00 00000000") == "43 00 20 00 78 56 34 12"
    assert ask(server, "60 00000000000000").startswith("80")


def test_a_short_request_is_ignored(server: SdoServer) -> None:
    assert server.request(bytes(7)) is None
