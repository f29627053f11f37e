"""Our own frames distinguished from other nodes' frames, whatever the interface echoes."""

from __future__ import annotations

from drivers.ports import CanFrame
from drivers.transports.own_frames import PROBE_ID, RETURN_S, SETTLE_S, OwnFrames

TOKEN = b"echo1234"
SYNC: CanFrame = (0.01, 0x080, b"")
PROBE: CanFrame = (0.01, PROBE_ID, TOKEN)


def begun() -> OwnFrames:
    """Return an instance whose probe and first SYNC were sent at 0."""
    own = OwnFrames(TOKEN)
    probe = own.probe
    assert probe is not None
    own.sent(*probe, 0.0)
    own.sent(0x080, b"", 0.0)
    return own


def test_before_the_first_send_every_frame_is_foreign() -> None:
    own = OwnFrames(TOKEN)
    assert own.others([SYNC], 0.01) == [SYNC]
    assert own.echoes is None


def test_a_frame_like_ours_waits_until_the_echo_is_known() -> None:
    own = begun()
    other = (0.01, 0x181, b"\x01")
    assert own.others([SYNC, other], 0.02) == [other]
    assert own.others([], SETTLE_S) == [SYNC]
    assert own.echoes is False


def test_where_ours_do_not_come_back_a_frame_like_ours_is_another_masters() -> None:
    own = begun()
    own.others([], SETTLE_S)
    own.sent(0x080, b"", 1.0)
    assert own.others([(1.0, 0x080, b"")], 1.01) == [(1.0, 0x080, b"")]


def test_an_echo_that_overtakes_the_probe_is_an_echo() -> None:
    own = begun()
    assert own.others([SYNC, PROBE], 0.02) == []
    assert own.echoes is True
    assert own.returned == 2


def test_one_frame_more_than_we_sent_is_another_masters() -> None:
    own = begun()
    assert own.others([PROBE, SYNC, SYNC], 0.02) == [SYNC]


def test_our_frames_are_recognised_in_any_order() -> None:
    own = begun()
    own.sent(0x201, b"\x0f", 0.0)
    assert own.others([PROBE, (0.01, 0x201, b"\x0f"), SYNC], 0.02) == []


def test_a_frame_of_ours_that_never_came_back_hides_foreign_frames_only_briefly() -> None:
    own = begun()
    own.others([PROBE], 0.02)
    assert own.others([], RETURN_S + 0.1) == []
    assert own.unreturned == 1
    assert own.others([SYNC], RETURN_S + 0.2) == [SYNC]


def test_an_interface_that_gives_ours_back_twice_is_refused() -> None:
    own = begun()
    own.others([PROBE, PROBE], 0.02)
    assert "more than once" in own.trouble


def test_an_interface_that_gives_ours_back_too_late_is_refused() -> None:
    own = begun()
    own.others([], SETTLE_S)
    own.others([PROBE], 0.5)
    assert "later than 100 ms" in own.trouble
