"""A maker's manual of a device as data: its registers, and its behaviour on a fault. No profile is read here."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import inf, isfinite
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from tests.campaigns.makers.slave import MakersSlave

Area = Literal["coil", "discrete", "holding", "input", "inside"]
"""Tables of Modbus; ``inside``: a number of the device that no register shows directly."""
Type = Literal["bit", "bits8", "u16", "i16", "u32", "i32", "f32"]
SIZES: Mapping[Type, int] = {"bit": 1, "bits8": 8, "u16": 1, "i16": 1, "u32": 2, "i32": 2, "f32": 2}
"""Number of addresses of a number."""


@dataclass(frozen=True)
class Register:
    """A number in the maker's table."""

    name: str
    area: Area
    addresses: tuple[int, ...]
    """Protocol addresses, from 0; several if the device shows the number in several places."""
    type: Type
    least: float = -inf
    """Range in the maker's unit."""
    greatest: float = inf
    access: Literal["r", "w", "rw"] = "r"
    at_start: float = 0.0

    @property
    def measured(self) -> bool:
        """Whether the device measures it, within a range that its manual states."""
        return self.access == "r" and isfinite(self.greatest)


@dataclass(frozen=True)
class State:
    """A state of the device as shown by its registers: values by register, which replace measured ones."""

    name: str
    values: Mapping[str, float]


@dataclass(frozen=True)
class Table:
    """A maker's table."""

    profile: str
    source: str
    functions: frozenset[int]
    registers: tuple[Register, ...]
    faults: tuple[State, ...] = ()
    """States in which no number is valid."""
    harmless: tuple[State, ...] = ()
    """Lookalike states in which numbers are valid."""
    framing: Literal["rtu", "socket"] = "rtu"
    low_word_first: bool = False
    one_area: bool = False
    """Whether functions 3 and 4 read the same registers."""
    protected: int = 2
    """Exception on a write to a register that is read-only."""
    out_of_range: int | None = 3
    """Exception on a write outside the register's range; None: the device answers, and keeps the previous value."""
    commands: tuple[int, ...] = ()
    """Addresses at which function 6 writes the number ``command``, whatever they return when read."""
    forbids: Callable[[MakersSlave, str], int] = lambda slave, written: 0
    """Exception on a write to a register, or a command, in the device's present state; 0 = none."""
    react: Callable[[MakersSlave, str], None] = lambda slave, written: None
    """The device's own reaction to a written register or a changed measurement."""
    shown: Mapping[str, tuple[str, float]] = field(default_factory=dict[str, tuple[str, float]])
    """By channel of the profile: the register with its value, and the number of the channel's units in one of the
    maker's."""
    parameters: Mapping[str, tuple[str, float]] = field(default_factory=dict[str, tuple[str, float]])
    """The same for the profile's parameters."""
    wanted: Mapping[str, float] = field(default_factory=dict[str, float])
    """Registers that must have a value so that the numbers have the profile's meaning."""

    def __getitem__(self, name: str) -> Register:
        return next(register for register in self.registers if register.name == name)
