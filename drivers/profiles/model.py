"""What a device profile says: registers, scalings, status bits and timing of one type of Modbus device."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import isfinite
from struct import Struct
from typing import Literal

Kind = Literal["load_cell", "ir_thermometer", "jacket", "chamber", "sensor"]
"""What a device is to a rig; ``sensor`` is one that measures anything else."""
Number = Literal["u16", "i16", "u32", "i32", "f32"]
WordOrder = Literal["high_first", "low_first"]

CODES: dict[Number, str] = {"u16": "H", "i16": "h", "u32": "I", "i32": "i", "f32": "f"}
"""struct codes of the register types."""
SIZES: dict[Number, int] = {"u16": 1, "i16": 1, "u32": 2, "i32": 2, "f32": 2}
"""Registers that each type takes."""
LIMITS: dict[Number, tuple[int, int]] = {
    "u16": (0, 0xFFFF),
    "i16": (-0x8000, 0x7FFF),
    "u32": (0, 0xFFFF_FFFF),
    "i32": (-0x8000_0000, 0x7FFF_FFFF),
    "f32": (-(1 << 24), 1 << 24),
}
"""Least and greatest count of each type; of f32, those it holds exactly."""


MOST_F32 = 3.4028234e38
"""Greatest number of an f32."""


class ProfileError(ValueError):
    """A profile that is missing, not complete, or not what the driver needs."""


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
    """A value below it is not plausible; of a parameter, the device does not take it."""
    greatest: float = float("inf")
    sign_bit: int | None = None
    """Status bit that makes it negative, where the register holds the magnitude."""
    default: float | None = None
    """Of a parameter: what is written where the rig file does not state it; None = it must."""

    @property
    def size(self) -> int:
        """Registers it takes."""
        return SIZES[self.type]

    def words(self, value: float, word_order: WordOrder) -> tuple[int, ...]:
        """Return the registers that hold ``value``, in the order they are sent: the nearest number of the type.

        Raises ValueError unless it is finite, and for more than an f32 holds.
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
        """Return the number that registers hold; ``data``: their bytes as they are sent."""
        if word_order == "low_first" and self.size == 2:
            data = data[2:] + data[:2]
        counts: float = Struct(">" + CODES[self.type]).unpack(data)[0]
        return counts * self.scale


@dataclass(frozen=True, slots=True)
class RegisterBlock:
    """Registers read in one request, and how they become numbers."""

    function: int
    address: int
    count: int
    period_s: float
    signals: tuple[Signal, ...]
    """In order of address; ``unpack`` and ``pack`` give and take their counts in this order."""
    word_order: WordOrder = "high_first"
    unpack: Callable[[bytes], tuple[int, ...]] = field(init=False, compare=False)
    """Counts of the signals from the block's bytes."""
    pack: Callable[..., bytes] = field(init=False, compare=False)
    """The block's bytes from the counts of the signals."""

    def __post_init__(self) -> None:
        """Compile the two ways between bytes and counts."""
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
        """Return itself: nothing in it changes."""
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
    """A register whose value tells the type of device."""

    address: int
    function: int
    value: int


@dataclass(frozen=True, slots=True)
class SetupWrite:
    """A value to be written when a device is connected."""

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
    """How a device answers."""

    turnaround_s: float
    """Usual time from the end of a request to the start of the reply."""
    reply_max_s: float
    """The longest such time; after a time-out the line must have been quiet for it."""
    retries: int = 1
    """Further attempts after one that failed."""


@dataclass(frozen=True, slots=True)
class LineData:
    """The line as the device has it by default or as we advise it."""

    baud: int
    parity: Literal["N", "E", "O"]


@dataclass(frozen=True, slots=True)
class DeviceProfile:
    """Everything a driver and its simulated device need to know of a type of device."""

    name: str
    kind: Kind
    title: str
    functions: frozenset[int]
    """Function codes the device knows."""
    write_function: int
    word_order: WordOrder
    line: LineData
    timing: Timing
    blocks: tuple[RegisterBlock, ...]
    """What is read again and again; the first is the one that matters."""
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
    """The computer may take a zero off a sensor's channels."""
    saturated: float | None = None
    """Share of its range, to either side, from which a channel counts as saturated and the reading as invalid; None =
    a value is plausible from ``least`` to ``greatest``."""

    falls_back_s: float | None = None
    """Of a controller: without a setpoint for so long, s, it continues with its own, which its set-up makes one
    of no heat; None = it does not."""

    def __deepcopy__(self, memo: dict[int, object]) -> DeviceProfile:
        """Return itself: nothing in it changes."""
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
        """What a sensor measures: the names in its first read but for the status, in order of address."""
        return tuple(signal.name for signal in self.blocks[0].signals if signal.name != "status")

    def signal(self, name: str) -> Signal:
        """Return a signal that is read. Raises ProfileError where the device has none of this name."""
        for block in self.blocks:
            for signal in block.signals:
                if signal.name == name:
                    return signal
        raise ProfileError(f"profile {self.name} has no signal {name!r}")

    def has(self, name: str) -> bool:
        """Return whether a signal of this name is read."""
        return any(signal.name == name for block in self.blocks for signal in block.signals)

    def bit(self, meaning: str) -> int:
        """Return the mask of the status bit with this meaning, 0 where the device has none."""
        return 1 << self.status_bits[meaning] if meaning in self.status_bits else 0
