"""Moxa ioLogik E1240, eight analogue inputs: E1200 manual, appendix A-11, A-15 and the E1240 map. Modbus TCP.

Scaled values are floats, high word first, by function 4; in mode "4-20 mA, burnout" each channel has a status: 1 below
the burnout value of 2 mA, 3 up to 4 mA, 2 above 20 mA, where the value stays at the end of its range.
"""

from __future__ import annotations

from tests.campaigns.makers.slave import MakersSlave
from tests.campaigns.makers.table import Register, State, Table

CHANNELS = range(8)
FULL_MA, FULL_COUNTS = 20.0, 0xFFFF
BURNOUT = 4
"""Mode "4-20 mA, burnout"."""
BURNT_OUT, OVER, UNDER = 1, 2, 3
"""Status of a channel; 0 = normal."""


def react(slave: MakersSlave, written: str) -> None:
    """Show the raw counts of each channel's current."""
    for number in CHANNELS:
        burnt_out = slave.get(f"status {number}") == BURNT_OUT
        current_ma = 0.0 if burnt_out else slave.get(f"scaled {number}")
        slave.put(f"raw {number}", min(max(round(current_ma / FULL_MA * FULL_COUNTS), 0), FULL_COUNTS))


TABLE = Table(
    profile="moxa_e1240",
    source="Moxa ioLogik E1200 manual p. A-11, A-15",
    functions=frozenset({1, 2, 3, 4, 5, 6, 15, 16}),
    registers=(
        *(Register(f"raw {number}", "input", (number,), "u16") for number in CHANNELS),
        *(Register(f"scaled {number}", "input", (8 + 2 * number,), "f32", 4, FULL_MA, "r", 4.0) for number in CHANNELS),
        *(Register(f"status {number}", "input", (0x3C + number,), "u16") for number in CHANNELS),
        *(Register(f"mode {number}", "holding", (0x18 + number,), "u16", 0, 4, "rw", BURNOUT) for number in CHANNELS),
        *(Register(f"limit {number}", "holding", (0x28 + 2 * number,), "f32", 0, 4, "rw", 2.0) for number in CHANNELS),
    ),
    faults=tuple(
        State(f"{name}, channel {number}", {f"status {number}": status, f"scaled {number}": current_ma})
        for number in range(4)
        for name, status, current_ma in (
            ("burnt out", BURNT_OUT, 0.0),
            ("over range", OVER, FULL_MA),
            ("under range", UNDER, 3.2),
        )
    ),
    harmless=(State("an input without a sensor", {"status 6": BURNT_OUT, "scaled 6": 0.0}),),
    framing="socket",
    react=react,
    shown={f"input_{number}": (f"scaled {number}", 1.0) for number in range(4)},
)
