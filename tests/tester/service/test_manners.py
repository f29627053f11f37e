from __future__ import annotations

import logging
from unittest.mock import Mock

import pytest

from tester.service.manners import (
    BYTES_PER_MESSAGE,
    LINES_PER_MINUTE,
    MESSAGES_AT_ONCE,
    MESSAGES_PER_S,
    MOST_STRANGERS,
    Bucket,
    SparseLog,
    Strangers,
)


def test_a_client_that_talks_now_and_then_never_waits() -> None:
    now = [0.0]
    bucket = Bucket(lambda: now[0])
    for _ in range(1000):
        now[0] += 1.1 / MESSAGES_PER_S
        assert bucket.spend(100) == 0.0


def test_a_client_that_talks_without_a_pause_is_held_to_the_rate() -> None:
    now = [0.0]
    bucket = Bucket(lambda: now[0])
    for _ in range(1000):
        now[0] += bucket.spend(0)
    assert now[0] == pytest.approx((1000 - MESSAGES_AT_ONCE) / MESSAGES_PER_S, abs=0.1)


def test_a_long_message_counts_as_many() -> None:
    bucket = Bucket(lambda: 0.0)
    assert bucket.spend(int(MESSAGES_AT_ONCE) * BYTES_PER_MESSAGE + BYTES_PER_MESSAGE) > 1.0 / MESSAGES_PER_S


def test_of_too_many_strangers_the_oldest_has_to_go() -> None:
    strangers, transports = Strangers(), [Mock() for _ in range(MOST_STRANGERS + 1)]
    for transport in transports:
        strangers.came(Mock(), transport)
    assert [bool(transport.abort.called) for transport in transports] == [True] + [False] * MOST_STRANGERS
    assert len(strangers) == MOST_STRANGERS


def test_the_log_gets_some_lines_a_minute_and_how_many_were_left_out() -> None:
    now, lines = [0.0], list[str]()
    log = SparseLog(lines.append, lambda: now[0])
    logger = logging.Logger("x")
    logger.addHandler(log)
    for _ in range(600):
        try:
            raise ValueError("no\nhandshake")
        except ValueError:
            logger.exception("opening handshake failed")
    assert len(lines) == LINES_PER_MINUTE and all(line.count("\n") == 1 for line in lines)
    assert "ValueError: no handshake" in lines[0]
    now[0] = 61.0
    logger.warning("again")
    assert lines[LINES_PER_MINUTE].startswith(f"{600 - LINES_PER_MINUTE} more")
