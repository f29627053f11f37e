"""Numbers as a Modbus device holds them: types of registers and of bits, and the order of their bytes on the wire."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, get_args

Number = Literal["bit", "u8", "u16", "i16", "u32", "i32", "f32"]
"""``bit``: one coil or discrete input, or one bit of a register; ``u8``: eight coils or discrete inputs."""
Order = Literal["high_first", "low_first"]

CODES: dict[Number, str] = {"bit": "H", "u8": "H", "u16": "H", "i16": "h", "u32": "I", "i32": "i", "f32": "f"}
"""struct codes of the register types; a bit's is that of the register that holds it."""
SIZES: dict[Number, int] = {"bit": 1, "u8": 8, "u16": 1, "i16": 1, "u32": 2, "i32": 2, "f32": 2}
"""Number of addresses of each type: of registers, for u8 of bits."""
LIMITS: dict[Number, tuple[int, int]] = {
    "bit": (0, 1),
    "u8": (0, 0xFF),
    "u16": (0, 0xFFFF),
    "i16": (-0x8000, 0x7FFF),
    "u32": (0, 0xFFFF_FFFF),
    "i32": (-0x8000_0000, 0x7FFF_FFFF),
    "f32": (-(1 << 24), 1 << 24),
}
"""Least and greatest count of each type; for f32, the range of exact whole numbers."""
MOST_F32 = 3.4028234e38
"""Greatest number of an f32."""
BIT_READS = (1, 2)
"""Functions that read coils (1) and discrete inputs (2), a bit at each address."""


def on_wire(words: Iterable[int]) -> bytes:
    """Return the bytes of registers, each with its high byte first (Modbus)."""
    return b"".join(word.to_bytes(2, "big") for word in words)


@dataclass(frozen=True, slots=True)
class NumberOrder:
    """Order of a number that takes two registers. A number of one register always has its high byte first (Modbus)."""

    words: Order = "high_first"
    """Order of the two registers."""
    bytes: Order = "high_first"
    """Order of the two bytes in each register."""

    @property
    def places(self) -> tuple[int, int, int, int]:
        """Return the place on the wire of each byte of a number, the highest byte first; it is its own inverse."""
        a, b, c, d = (1, 0, 3, 2) if self.bytes == "low_first" else (0, 1, 2, 3)
        return (c, d, a, b) if self.words == "low_first" else (a, b, c, d)

    def sorted(self, data: bytes) -> bytes:
        """Return the four bytes of a number with the highest first, or from there in the order of the wire."""
        return bytes([data[place] for place in self.places])


HIGH_FIRST = NumberOrder()
ORDERS = tuple(NumberOrder(words, in_words) for in_words in get_args(Order) for words in get_args(Order))
"""Every order."""
