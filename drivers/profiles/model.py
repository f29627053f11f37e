"""Contents of a device profile: registers, scalings, status bits and timing of one type of Modbus device."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import isfinite
from struct import Struct
from typing import Literal

Kind = Literal["load_cell", "ir_thermometer", "jacket", "chamber", "sensor"]
"""Role of a device in a rig; ``sensor`` is one that measures anything else."""
Number = Literal["u16", "i16", "u32", "i32", "f32"]
WordOrder = Literal["high_first", "low_first"]

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
class Signal:
    """One number in the registers of a device."""

    name: str
    address: int
    """Protocol address, counted from 0."""
    type: Number
    scale: float
    """Value of one count, in ``unit``."""
    unit: str
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

    def words(self, value: float, word_order: WordOrder) -> tuple[int, ...]:
        """Return the registers for ``value``, in the order of sending; the value is rounded to the register's type.

        Raises ValueError for a value that is not finite, or greater than an f32 can hold.
        """
        if not isfinite(value):
            raise ValueError(f"{self.name} must be a finite number, not {value}")
        counts = value / self.scale
        if self.type == "f32":
            if abs(counts) > MOST_F32:
                raise ValueError(f"{self.name} is too great for its registers: {value}")
            data = Struct(">f").pack(counts)
        else:
            least, greatest = LIMITS[self.type]
            data = Struct(">" + CODES[self.type]).pack(min(max(round(counts), least), greatest))
        words = tuple(int.from_bytes(data[at : at + 2], "big") for at in range(0, len(data), 2))
        return words if word_order == "high_first" else words[::-1]

    def value(self, data: bytes, word_order: WordOrder) -> float:
        """Return the number in the registers ``data``, their bytes in the order of sending."""
        if word_order == "low_first" and self.size == 2:
            data = data[2:] + data[:2]
        counts: float = Struct(">" + CODES[self.type]).unpack(data)[0]
        return counts * self.scale


@dataclass(frozen=True, slots=True)
class RegisterBlock:
    """Registers read in one request, and their conversion to numbers."""

    function: int
    address: int
    count: int
    period_s: float
    signals: tuple[Signal, ...]
    """In order of address; ``unpack`` returns and ``pack`` takes their counts in this order."""
    word_order: WordOrder = "high_first"
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
        if self.word_order == "low_first" and any(signal.size > 1 for signal in self.signals):
            swapper = _WordSwapper(layout, self)
            unpack, pack = swapper.unpack, swapper.pack
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


class _WordSwapper:
    """Turns a block with the low word first into one with the high word first, and back."""

    def __init__(self, layout: Struct, block: RegisterBlock) -> None:
        self._layout = layout
        order = list(range(layout.size))
        for signal in block.signals:
            if signal.size > 1:
                at = 2 * (signal.address - block.address)
                order[at : at + 4] = [at + 2, at + 3, at, at + 1]
        self._order = tuple(order)

    def unpack(self, data: bytes) -> tuple[int, ...]:
        """Return the counts."""
        return self._layout.unpack(bytes([data[at] for at in self._order]))

    def pack(self, *counts: int) -> bytes:
        """Return the bytes; swapping twice is no swap."""
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
    """A value to write when a device is connected."""

    name: str
    address: int
    value: int
    read_back: bool


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
    word_order: WordOrder
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
