"""Spoiled SDO answers and TPDOs. A CAN controller checks every frame's bits, so the remaining faults are whole frames:
extra, missing, too short, or of another transfer. An identifier with wrong bits is another valid frame, which cannot be
detected."""

from __future__ import annotations

import random
import struct
from typing import Final

from drivers.canopen.sdo import SdoClient
from tests.campaigns.wire.tally import Tally
from tests.drivers.can_bench import joined, tpdo1, wheel

INDEX, SUB = 0x1018, 2
ANSWER_S: Final = 0.001
SPOILINGS: Final = ("none", "dropped", "twice", "short", "toggle", "other index", "other sub", "other command",
                    "late of another", "abort of another")  # fmt: skip


def _server(value: bytes) -> list[bytes]:
    """Return the answers of an upload: expedited, or announced and in segments."""
    head = struct.pack("<HB", INDEX, SUB)
    if len(value) <= 4:
        return [bytes((0x43 | (4 - len(value)) << 2,)) + head + value.ljust(4, b"\0")]
    frames = [b"\x41" + head + struct.pack("<I", len(value))]
    for number, at in enumerate(range(0, len(value), 7)):
        part = value[at : at + 7]
        command = (number & 1) << 4 | (7 - len(part)) << 1 | (at + 7 >= len(value))
        frames.append(bytes((command,)) + part.ljust(7, b"\0"))
    return frames


def _spoil(source: random.Random, kind: str, frame: bytes, first: bool) -> list[bytes]:
    other = struct.pack("<HB", INDEX ^ source.randint(1, 0xFFFF), SUB)
    match kind:
        case "dropped":
            return []
        case "twice":
            return [frame, frame]
        case "short":
            return [frame[: source.randrange(8)]]
        case "toggle" if not first:
            return [bytes((frame[0] ^ 0x10,)) + frame[1:]]
        case "other index" if first:
            return [frame[:1] + other + frame[4:]]
        case "other sub" if first:
            return [frame[:3] + bytes((SUB ^ source.randint(1, 255),)) + frame[4:]]
        case "other command":
            return [bytes((source.choice((0x60, 0x20, 0x30, 0xA0, 0xC2, 0xE0)),)) + frame[1:]]
        case "late of another" if first:
            return [b"\x43" + other + source.randbytes(4), frame]
        case "abort of another":
            return [b"\x80" + other + source.randbytes(4), frame]
        case _:
            return [frame]


def sdo(source: random.Random, tally: Tally) -> None:
    """Read an object whose answers are spoiled once, and compare the value."""
    value = source.randbytes(source.choice((1, 2, 3, 4, 5, 7, 8, 14, 20, 40)))
    frames, kind = _server(value), source.choice(SPOILINGS)
    where = source.randrange(len(frames))
    tally.kinds[kind] += 1
    client, now = SdoClient(), 0.0
    client.upload(INDEX, SUB, now)
    for number, frame in enumerate(frames):
        for one in _spoil(source, kind, frame, number == 0) if number == where else [frame]:
            now += ANSWER_S
            client.feed(one, now)
        if kind == "dropped" and number == where:
            break  # the server waits for the next request
    client.expire(now + 1.0)
    if client.busy:
        raise AssertionError(f"{kind}: the transfer has no end")
    if client.error is None:
        tally.accepted += 1
        if client.result != value:
            tally.wrong += 1
            tally.blame(f"{kind} at {where}: {client.result.hex()} for {value.hex()}")


class ProcessData:
    """A drive whose TPDO1 come whole, short, long, twice or not at all."""

    def __init__(self) -> None:
        """Begin with a connected drive."""
        self.drive = joined(wheel())
        self.now = 0.0
        self.raw = 0

    def __call__(self, source: random.Random, tally: Tally) -> None:
        """Send one, and compare the accepted speed."""
        self.now += 0.01
        raw = source.randint(-50_000, 50_000)
        frame = tpdo1(0x0240, raw, 0)
        kind = source.choice(("none", "short", "long", "twice", "dropped"))
        tally.kinds[f"TPDO {kind}"] += 1
        sent = {
            "none": [frame], "twice": [frame, frame], "dropped": [], "long": [frame + b"\0"],
            "short": [frame[: source.randrange(len(frame))]],
        }[kind]
        for one in sent:
            self.drive.on_tpdo1(self.now, one)
        if kind in ("none", "twice"):
            self.raw = raw
            tally.accepted += 1
        if self.drive.actual != self.raw / 1000.0:
            tally.wrong += 1
            tally.blame(f"TPDO {kind}: {self.drive.actual} for {self.raw / 1000.0}")
