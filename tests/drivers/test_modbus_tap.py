"""Frames of a line used by others: where each ends, and which side sent it."""

from __future__ import annotations

import random

import pytest

from drivers.crc16 import with_crc
from drivers.modbus.tap import LineTap

READ = with_crc(bytes.fromhex("01 03 0000 0002"))
ANSWER = with_crc(bytes.fromhex("01 03 04 0003 0405"))
WRITE_ONE = with_crc(bytes.fromhex("02 06 0017 2400"))
WRITE_MANY = with_crc(bytes.fromhex("01 10 0002 0002 04 0102 0304"))
WRITTEN = with_crc(bytes.fromhex("01 10 0002 0002"))
REFUSED = with_crc(bytes.fromhex("01 83 02"))
TALK = [
    (READ, True), (ANSWER, False), (WRITE_ONE, True), (WRITE_ONE, False), (WRITE_MANY, True), (WRITTEN, False),
    (READ, True), (REFUSED, False), (READ, True), (READ, True), (ANSWER, False),
]  # fmt: skip
"""The last request but one gets no answer."""


@pytest.mark.parametrize("seed", range(20))
def test_frames_are_separated_in_any_pieces(seed: int) -> None:
    pieces = random.Random(seed)
    stream = b"".join(frame for frame, _ in TALK)
    tap, found = LineTap(), []
    while stream:
        size = pieces.randint(1, 20)
        found += tap.feed(stream[:size])
        stream = stream[size:]
    assert found == TALK
    assert tap.garbage == 0


def test_noise_before_a_frame_costs_the_noise() -> None:
    tap = LineTap()
    assert tap.feed(b"\x00\xff\xfe" + 40 * (READ + ANSWER)) == 40 * [(READ, True), (ANSWER, False)]
    assert tap.garbage == 3
