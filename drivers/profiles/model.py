"""Contents of a device profile: registers, scalings, status bits and timing of one type of Modbus device."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import isfinite
from struct import Struct
from typing import Literal, get_args

Kind = Literal["load_cell", "ir_thermometer", "jacket", "chamber", "sensor"]
"""Role of a device in a rig; ``sensor`` is one that measures anything else."""
Number = Literal["u16", "i16", "u32", "i32", "f32"]
Order = Literal["high_first", "low_first"]

CODES: dict[Number, str] = {"u16": "H", "i16": "h", "u32": "I", "i32": "i", "f32": "f"}
"""struct codes of the register types."""
SIZES: dict[Number, int] = {"u16": 1, "i16": 1, "u32": 2, "i32": 2, "f32": 2}
"""Number of registers of each type."""
LIMITS: dict[Number, tuple[int, int]] = {
    "u16": (0, 0xFFFF),
    "i16": (-0x8000, 0x7FFF),
    "u32": (0, 0xFFFF_FFFF),
    "i32": (-0x8000_0000, 0x7FFF_FFFF),
    "f32": (-(1 << 24), 1 << 24),
}
"""Least and greatest count of each type; for f32, the range of exact whole numbers."""


MOST_F32 = 3.4028234e38
"""Greatest number of an f32."""


class ProfileError(ValueError):
    """A profile that is missing, incomplete, or unsuitable for the driver."""


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
        return counts * self.scale + self.offset


@dataclass(frozen=True, slots=True)
class RegisterBlock:
    """Registers read in one request, and their conversion to numbers."""

    function: int
    address: int
    count: int
    period_s: float
    signals: tuple[Signal, ...]
    """In order of address; ``unpack`` returns and ``pack`` takes their counts in this order."""
    order: NumberOrder = HIGH_FIRST
    unpack: Callable[[bytes], tuple[int, ...]] = field(init=False, compare=False)
    """Returns the counts of the signals from the block's bytes."""
    pack: Callable[..., bytes] = field(init=False, compare=False)
    """Returns the block's bytes from the counts of the signals."""

    def __post_init__(self) -> None:
        """Compile the conversions between bytes and counts."""
        codes, at = ">", self.address
        for signal in self.signals:
            codes += f"{2 * (signal.address - at)}x" if signal.address > at else ""
            codes += CODES[signal.type]
            at = signal.address + signal.size
        layout = Struct(codes)
        unpack, pack = layout.unpack, layout.pack
        if self.order != HIGH_FIRST and any(signal.size > 1 for signal in self.signals):
            sorter = _ByteSorter(layout, self)
            unpack, pack = sorter.unpack, sorter.pack
        object.__setattr__(self, "unpack", unpack)
        object.__setattr__(self, "pack", pack)

    def __deepcopy__(self, memo: dict[int, object]) -> RegisterBlock:
        """Return itself: it never changes."""
        return self

    def index(self, name: str) -> int:
        """Return the place of a signal in the counts. Raises KeyError."""
        for place, signal in enumerate(self.signals):
            if signal.name == name:
                return place
        raise KeyError(name)


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


@dataclass(frozen=True, slots=True)
class Identity:
    """A register whose value identifies the type of device."""

    address: int
    function: int
    value: int


@dataclass(frozen=True, slots=True)
class SetupWrite:
    """A value to write when a device is connected, or to wait for."""

    name: str
    address: int
    words: tuple[int, ...]
    """Registers of the value, in the order of sending."""
    read_back: bool
    """Whether the registers are read and compared afterwards."""
    within_s: float = 0.0
    """Time that the device may take until its registers hold the value, s; 0 = the first read-back must hold it."""
    writes: bool = True
    """False: only wait for the value, and write nothing."""


@dataclass(frozen=True, slots=True)
class Switch:
    """A register with one value for on and one for off."""

    address: int
    on: int
    off: int


@dataclass(frozen=True, slots=True)
class Timing:
    """Reply times of a device."""

    turnaround_s: float
    """Usual time from the end of a request to the start of the reply."""
    reply_max_s: float
    """Longest time of this kind; after a time-out the line must have been quiet for it."""
    retries: int = 1
    """Further attempts after one that failed."""


@dataclass(frozen=True, slots=True)
class LineData:
    """Settings of the line: the device's defaults, or our advice."""

    baud: int
    parity: Literal["N", "E", "O"]


@dataclass(frozen=True, slots=True)
class DeviceProfile:
    """Everything that a driver and its simulated device need to know about a type of device."""

    name: str
    kind: Kind
    title: str
    functions: frozenset[int]
    """Function codes that the device knows."""
    write_function: int
    order: NumberOrder
    line: LineData
    timing: Timing
    blocks: tuple[RegisterBlock, ...]
    """Blocks that are polled; the first is the most important one."""
    invalid_bits: int
    """Mask of the status bits that make a reading invalid."""
    status_bits: dict[str, int]
    """Bit numbers of the status register by meaning."""
    identity: Identity | None = None
    setup: tuple[SetupWrite, ...] = ()
    writes: dict[str, Signal] = field(default_factory=dict[str, Signal])
    """Registers to write by name: ``setpoint`` and ``lease`` of a jacket; a sensor's parameters (``emissivity``)."""
    switches: dict[str, Switch] = field(default_factory=dict[str, Switch])
    """Registers with an on and an off value: ``run``."""
    tare: bool = False
    """Whether the computer may tare a sensor's channels."""
    saturated: float | None = None
    """Share of its range, to either side, from which a channel counts as saturated and the reading as invalid; None =
    the bounds of a value are ``least`` and ``greatest`` instead."""

    falls_back_s: float | None = None
    """For a controller: time without a setpoint, s, after which it continues with its own setpoint. Its set-up makes
    that a setpoint without heat. None = it never does so."""

    def __deepcopy__(self, memo: dict[int, object]) -> DeviceProfile:
        """Return itself: it never changes."""
        return self

    def expect(self, kind: Kind) -> None:
        """Raise ProfileError unless this is a profile of ``kind``."""
        if self.kind != kind:
            raise ProfileError(f"profile {self.name} describes a {self.kind}, not a {kind}")

    def expect_sensor(self) -> None:
        """Raise ProfileError unless this is a profile of a sensor."""
        if self.kind == "jacket":
            raise ProfileError(f"profile {self.name} describes a {self.kind}, not a sensor")

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels of a sensor: the names in its first read except the status, in order of address."""
        return tuple(signal.name for signal in self.blocks[0].signals if signal.name != "status")

    def signal(self, name: str) -> Signal:
        """Return a signal that is read. Raises ProfileError if the device has none of this name."""
        for block in self.blocks:
            for signal in block.signals:
                if signal.name == name:
                    return signal
        raise ProfileError(f"profile {self.name} has no signal {name!r}")

    def has(self, name: str) -> bool:
        """Return whether a signal of this name is read."""
        return any(signal.name == name for block in self.blocks for signal in block.signals)

    def bit(self, meaning: str) -> int:
        """Return the mask of the status bit with this meaning, 0 if the device has none."""
        return 1 << self.status_bits[meaning] if meaning in self.status_bits else 0
