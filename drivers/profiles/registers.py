"""Registers and bits of a Modbus device: a number in them, and blocks of them that one request reads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import isfinite
from struct import Struct

from drivers.profiles.numbers import BIT_READS, CODES, HIGH_FIRST, LIMITS, MOST_F32, SIZES, Number, NumberOrder

Unpack = Callable[[bytes], tuple[int, ...]]
Pack = Callable[..., bytes]


@dataclass(frozen=True, slots=True)
class Signal:
    """One number in the registers of a device."""

    name: str
    address: int
    """Protocol address, counted from 0."""
    type: Number
    scale: float
    """Value of one count, in ``unit``."""
    unit: str
    offset: float = 0.0
    """Value at a count of 0, in ``unit``."""
    least: float = float("-inf")
    """A value below it is not plausible; the device does not accept it for a parameter."""
    greatest: float = float("inf")
    sign_bit: int | None = None
    """Status bit that makes the value negative, if the register holds the magnitude."""
    bit: int = 0
    """Place of a ``bit`` in its register, 0 = the lowest; 0 for a coil or a discrete input."""
    guards: str = ""
    """Channel that is invalid while this number is out of its bounds: the number is no channel itself."""
    default: float | None = None
    """For a parameter: value written if the rig file states none; None = the rig file must state one."""

    @property
    def size(self) -> int:
        """Number of registers."""
        return SIZES[self.type]

    def words(self, value: float, order: NumberOrder = HIGH_FIRST) -> tuple[int, ...]:
        """Return the registers for ``value``, in the order of sending; the value is rounded to the register's type.

        Raises ValueError for a value that is not finite, or that the type cannot hold.
        """
        if not isfinite(value):
            raise ValueError(f"{self.name} must be a finite number, not {value}")
        counts = (value - self.offset) / self.scale
        whole = self.type != "f32"
        least, greatest = LIMITS[self.type] if whole else (-MOST_F32, MOST_F32)
        if not least <= (round(counts) if whole else counts) <= greatest:
            raise ValueError(f"{self.name} does not fit into its register, {self.type}: {value}")
        data = Struct(">" + CODES[self.type]).pack(round(counts) if whole else counts)
        if self.size == 2:
            data = order.sorted(data)
        return tuple(int.from_bytes(data[at : at + 2], "big") for at in range(0, len(data), 2))

    def value(self, data: bytes, order: NumberOrder = HIGH_FIRST) -> float:
        """Return the number in the registers ``data``, their bytes in the order of sending."""
        if self.size == 2:
            data = order.sorted(data)
        counts: float = Struct(">" + CODES[self.type]).unpack(data)[0]
        if self.type == "bit":
            counts = int(counts) >> self.bit & 1
        return counts * self.scale + self.offset


@dataclass(frozen=True, slots=True)
class RegisterBlock:
    """Registers, or bits, read in one request, and their conversion to numbers."""

    function: int
    address: int
    count: int
    """Number of registers; of bits for functions 1 and 2."""
    period_s: float
    signals: tuple[Signal, ...]
    """In order of address; ``unpack`` returns and ``pack`` takes their counts in this order."""
    order: NumberOrder = HIGH_FIRST
    unpack: Unpack = field(init=False, compare=False)
    """Returns the counts of the signals from the block's bytes."""
    pack: Pack = field(init=False, compare=False)
    """Returns the block's bytes from the counts of the signals."""

    def __post_init__(self) -> None:
        """Compile the conversions between bytes and counts."""
        if self.function in BIT_READS:
            bits = _BitCoder(self)
            unpack, pack = bits.unpack, bits.pack
        else:
            unpack, pack = self._of_registers()
        object.__setattr__(self, "unpack", unpack)
        object.__setattr__(self, "pack", pack)

    def _of_registers(self) -> tuple[Unpack, Pack]:
        codes, at = ">", self.address
        for signal in self.signals:
            if signal.address < at:
                continue  # a further bit of the register before it
            codes += f"{2 * (signal.address - at)}x" if signal.address > at else ""
            codes += CODES[signal.type]
            at = signal.address + signal.size
        layout = Struct(codes)
        unpack, pack = layout.unpack, layout.pack
        if self.order != HIGH_FIRST and any(signal.size > 1 for signal in self.signals):
            sorter = _ByteSorter(layout, self)
            unpack, pack = sorter.unpack, sorter.pack
        if any(signal.type == "bit" for signal in self.signals):
            flags = _FlagCoder(unpack, pack, self.signals)
            return flags.unpack, flags.pack
        return unpack, pack

    def __deepcopy__(self, memo: dict[int, object]) -> RegisterBlock:
        """Return itself: it never changes."""
        return self

    @property
    def size(self) -> int:
        """Number of bytes in a reply to it."""
        return (self.count + 7) // 8 if self.function in BIT_READS else 2 * self.count

    def index(self, name: str) -> int:
        """Return the place of a signal in the counts. Raises KeyError."""
        for place, signal in enumerate(self.signals):
            if signal.name == name:
                return place
        raise KeyError(name)


class _BitCoder:
    """Converts coils or discrete inputs: the first is the lowest bit of the first byte (Modbus)."""

    def __init__(self, block: RegisterBlock) -> None:
        self._size = block.size
        self._fields = tuple(
            (signal.address - block.address, (1 << SIZES[signal.type]) - 1) for signal in block.signals
        )

    def unpack(self, data: bytes) -> tuple[int, ...]:
        """Return the counts."""
        bits = int.from_bytes(data, "little")
        return tuple([bits >> at & mask for at, mask in self._fields])

    def pack(self, *counts: int) -> bytes:
        """Return the bytes."""
        bits = 0
        for (at, mask), count in zip(self._fields, counts, strict=True):
            bits |= (count & mask) << at
        return bits.to_bytes(self._size, "little")


class _FlagCoder:
    """Takes single bits out of registers, beside numbers that fill theirs."""

    def __init__(self, unpack: Unpack, pack: Pack, signals: tuple[Signal, ...]) -> None:
        self._unpack, self._pack = unpack, pack
        places: list[tuple[int, int]] = []  # number of the register's field, bit there; -1 = the whole number
        fields: list[int] = []
        for signal in signals:
            if signal.address not in fields:
                fields.append(signal.address)
            places.append((len(fields) - 1, signal.bit if signal.type == "bit" else -1))
        self._places, self._fields = tuple(places), len(fields)

    def unpack(self, data: bytes) -> tuple[int, ...]:
        """Return the counts."""
        found = self._unpack(data)
        return tuple([found[at] if bit < 0 else found[at] >> bit & 1 for at, bit in self._places])

    def pack(self, *counts: int) -> bytes:
        """Return the bytes; bits that no signal names are 0."""
        found = [0] * self._fields
        for (at, bit), count in zip(self._places, counts, strict=True):
            found[at] = count if bit < 0 else found[at] | (count & 1) << bit
        return self._pack(*found)


class _ByteSorter:
    """Puts the highest byte of each number of a block first, and back."""

    def __init__(self, layout: Struct, block: RegisterBlock) -> None:
        self._layout = layout
        order = list(range(layout.size))
        for signal in block.signals:
            if signal.size > 1:
                at = 2 * (signal.address - block.address)
                order[at : at + 4] = [at + place for place in block.order.places]
        self._order = tuple(order)

    def unpack(self, data: bytes) -> tuple[int, ...]:
        """Return the counts."""
        return self._layout.unpack(bytes([data[at] for at in self._order]))

    def pack(self, *counts: int) -> bytes:
        """Return the bytes: the order of the wire is its own inverse."""
        data = self._layout.pack(*counts)
        return bytes([data[at] for at in self._order])
