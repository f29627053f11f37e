"""Moxa ioLogik E1214, six digital inputs and six relays: E1200 manual, its map of the E1214, and p. A-10, A-11.

An input is a discrete input from 0 on; all six are bits of an input register as well. Modbus TCP.
"""

from __future__ import annotations

from tests.campaigns.makers.slave import MakersSlave
from tests.campaigns.makers.table import Register, Table

CHANNELS = range(6)


def react(slave: MakersSlave, written: str) -> None:
    """Show all inputs in one register."""
    slave.put("inputs", sum(int(slave.get(f"input {number}")) << number for number in CHANNELS))


TABLE = Table(
    profile="moxa_e1214",
    source="Moxa ioLogik E1200 manual p. A-10, A-11",
    functions=frozenset({1, 2, 3, 4, 5, 6, 15, 16}),
    registers=(
        *(Register(f"input {number}", "discrete", (number,), "bit", 0, 1) for number in CHANNELS),
        *(Register(f"overflow {number}", "discrete", (1000 + number,), "bit") for number in CHANNELS),
        *(Register(f"relay {number}", "coil", (number,), "bit", 0, 1, "rw") for number in CHANNELS),
        *(Register(f"counter {number}", "input", (0x10 + 2 * number,), "u32") for number in CHANNELS),
        Register("inputs", "input", (0x30,), "u16"),
        Register("relays", "holding", (0x20,), "u16", 0, 0x3F, "rw"),
    ),
    framing="socket",
    react=react,
    shown={f"di_{number}": (f"input {number}", 1.0) for number in CHANNELS},
)
