"""Contents of a device profile: registers, scalings, status bits and timing of one type of Modbus device."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from drivers.profiles.numbers import BIT_READS, SIZES, Number, NumberOrder, on_wire
from drivers.profiles.registers import RegisterBlock, Signal

Kind = Literal["load_cell", "ir_thermometer", "jacket", "chamber", "sensor"]
"""Role of a device in a rig; ``sensor`` is one that measures anything else."""


class ProfileError(ValueError):
    """A profile that is missing, incomplete, or unsuitable for the driver."""


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
    type: Number = "u16"
    read: int = 3
    """Function that reads it back."""
    mask: int = 0
    """Bits of the value that count when it is read back; 0 = all."""
    lasts: bool = False
    """For a value that is waited for: whether it lasts, and is read again whenever a reply did not come."""
    first: bool = False
    """Whether a controller needs it before it can be put into standby, which otherwise comes first."""

    @property
    def count(self) -> int:
        """Number of registers; of coils or discrete inputs where these hold it."""
        return SIZES[self.type]

    @property
    def expected(self) -> bytes:
        """Bytes of a reply that holds the value."""
        return bytes(self.words) if self.read in BIT_READS else on_wire(self.words)


@dataclass(frozen=True, slots=True)
class Switch:
    """A register, or a coil, with one value for on and one for off."""

    address: int
    on: int
    off: int
    coil: bool = False


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
    stop_bits: Literal[1, 2] = 1


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
    standby_c: float | None = None
    """For a controller without a switch ``run``: the setpoint that asks for no heat, degC, which takes its place."""

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
        """Channels of a sensor: the names in its reads except the status and what guards a channel, read by read in
        order of address.
        """
        return tuple(
            signal.name
            for block in self.blocks
            for signal in block.signals
            if signal.name != "status" and not signal.guards
        )

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
