"""Meaning of the bits in a drive's digital inputs (0x60FD) and outputs (0x60FE:01).

The program uses one arrangement of bits, the usual one below. ``DigitalWiring`` translates the words of a drive that
has another.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Final

SAFETY_CHAIN: Final = 1 << 16
GUARD: Final = 1 << 17
CONTACTOR: Final = 1 << 18
"""Inputs, in the program's arrangement (docs/safety.md)."""
REQUEST: Final = 1 << 16
"""Output: pull the contactor in."""


@dataclass(frozen=True, slots=True)
class DigitalWiring:
    """Bit numbers, 0..31; raises ValueError for a number out of range or used twice.

    Only the contactor's feedback may be inverted: with an inverted safety chain or guard a broken wire would read as
    closed, and an inverted request would pull the contactor in without a request.
    """

    safety_chain: int = 16
    guard: int = 17
    contactor: int = 18
    request: int = 16
    contactor_inverted: bool = False

    def __post_init__(self) -> None:
        """Check the numbers."""
        for one in fields(self):
            value: int = getattr(self, one.name)
            if not 0 <= value <= 31:
                raise ValueError(f"{one.name}: bit {value} (expected 0 to 31)")
        if len({self.safety_chain, self.guard, self.contactor}) < 3:
            raise ValueError("safety_chain, guard and contactor need a bit each")

    @property
    def mask(self) -> int:
        """Outputs that the program sets, for 0x60FE:02."""
        return 0xFFFF_0000 if self == USUAL_WIRING else 1 << self.request

    def from_drive(self, word: int) -> int:
        """Return a drive's input word with its bits in the program's order."""
        if self == USUAL_WIRING:
            return word
        found = (word >> self.safety_chain & 1) * SAFETY_CHAIN | (word >> self.guard & 1) * GUARD
        return found | ((word >> self.contactor & 1) ^ self.contactor_inverted) * CONTACTOR

    def to_drive(self, outputs: int) -> int:
        """Return the drive's output word for an output word of the program."""
        if self == USUAL_WIRING:
            return outputs
        return int(bool(outputs & REQUEST)) << self.request

    def inputs_shown(self, inputs: int) -> int:
        """Return a simulated drive's input word: ``inputs``, in the program's order, moved to the drive's bits."""
        if self == USUAL_WIRING:
            return inputs
        found = bool(inputs & SAFETY_CHAIN) << self.safety_chain | bool(inputs & GUARD) << self.guard
        return found | (bool(inputs & CONTACTOR) ^ self.contactor_inverted) << self.contactor

    def outputs_meant(self, word: int) -> int:
        """Return an output word received by a simulated drive, with its bits in the program's order."""
        if self == USUAL_WIRING:
            return word
        return (word >> self.request & 1) * REQUEST


USUAL_WIRING: Final = DigitalWiring()
