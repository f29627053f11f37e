"""The server's half of socketcand's protocol against bytes."""

from __future__ import annotations

import pytest

from sim.servers.socketcand import HOLD_BACK_S, LONGEST_ELEMENT, SocketcandSession


@pytest.fixture
def session() -> SocketcandSession:
    """Return a session in raw mode since 0 s, everything so far fetched."""
    session = SocketcandSession()
    session.feed(b"< open can0 >< rawmode >", 0.0)
    session.outgoing.clear()
    return session


def test_the_handshake_is_greeting_open_and_raw_mode() -> None:
    session = SocketcandSession()
    assert session.outgoing == b"< hi >"
    session.feed(b"< open can7 >", 0.0)
    assert (session.bus, session.raw) == ("can7", False)
    session.feed(b"< rawmode >", 0.0)
    assert session.raw
    assert session.outgoing == b"< hi >< ok >< ok >"


def test_raw_mode_needs_an_open_bus() -> None:
    session = SocketcandSession()
    session.feed(b"< rawmode >", 0.0)
    assert not session.raw
    assert session.outgoing.endswith(b"< error unknown command >")


def test_a_frame_is_taken_from_its_element(session: SocketcandSession) -> None:
    assert session.feed(b"< send 201 6 f 0 a ff 0 1 >", 1.0) == [(0x201, b"\x0f\x00\x0a\xff\x00\x01")]


def test_a_frame_without_data_is_taken(session: SocketcandSession) -> None:
    assert session.feed(b"< send 080 0  >", 1.0) == [(0x080, b"")]


def test_elements_may_come_in_pieces_or_together(session: SocketcandSession) -> None:
    assert session.feed(b"< send 080 0 >< send 20", 1.0) == [(0x080, b"")]
    assert session.feed(b"1 1 5 ><", 1.0) == [(0x201, b"\x05")]
    assert session.feed(b" send 080 0 >", 1.0) == [(0x080, b"")]


@pytest.mark.parametrize(
    "element",
    [b"< send >", b"< send 201 >", b"< send 201 2 1 >", b"< send 201 9 1 2 3 4 5 6 7 8 9 >", b"< send 201 1 100 >",
     b"< send xyz 0 >", b"< send 201 1 -1 >", b"< send -01 0 >", b"< send FFF 0 >"],
)  # fmt: skip
def test_an_invalid_frame_is_refused_and_the_rest_continues(session: SocketcandSession, element: bytes) -> None:
    assert session.feed(element + b"< send 080 0 >", 1.0) == [(0x080, b"")]
    assert session.refused + session.ignored == 1


def test_a_frame_with_a_29_bit_identifier_is_ignored(session: SocketcandSession) -> None:
    assert session.feed(b"< send 00000201 0 >", 1.0) == []
    assert session.ignored == 1


def test_frames_go_out_with_time_and_data(session: SocketcandSession) -> None:
    session.relay([(1.2345678, 0x181, b"\x27\x06\x00\xff"), (1.24, 0x701, b"")], 2.0)
    assert session.outgoing == b"< frame 181 1.234568 270600FF >< frame 701 1.240000  >"


def test_frames_are_held_back_after_the_answer_to_raw_mode(session: SocketcandSession) -> None:
    session.relay([(0.01, 0x181, b"")], 0.9 * HOLD_BACK_S)
    assert not session.outgoing
    session.relay([(0.06, 0x181, b"")], HOLD_BACK_S)
    assert session.outgoing


def test_the_first_frame_of_the_client_ends_the_holding_back(session: SocketcandSession) -> None:
    session.feed(b"< send 000 2 82 0 >", 0.01)
    session.relay([(0.011, 0x181, b"")], 0.011)
    assert session.outgoing


def test_no_frame_is_relayed_before_raw_mode() -> None:
    session = SocketcandSession()
    session.feed(b"< open can0 >", 0.0)
    session.relay([(5.0, 0x181, b"")], 5.0)
    assert session.outgoing == b"< hi >< ok >"


def test_an_echo_is_answered(session: SocketcandSession) -> None:
    session.feed(b"< echo >", 1.0)
    assert session.outgoing == b"< echo >"


def test_an_element_without_an_end_ends_the_conversation(session: SocketcandSession) -> None:
    session.feed(b"<" + b"a" * LONGEST_ELEMENT, 1.0)
    assert session.ended


def test_bytes_outside_elements_are_passed_over(session: SocketcandSession) -> None:
    assert session.feed(b"\xff\x00 hello > \r\n< send 080 0 >", 1.0) == [(0x080, b"")]
    session.feed(b"x" * 10_000, 1.0)
    assert not session.ended
