"""Laumas TLB weight transmitter: registers 40001 on (TLU and TLB4 manuals), status bits (LCB manual p. 3).

Weights are magnitudes in two registers, high half first; their signs are bits of the status. It knows functions 3 and
16, and exceptions 1 to 3; one request reads at most 32 registers.
"""

from __future__ import annotations

from tests.campaigns.makers.slave import MakersSlave
from tests.campaigns.makers.table import Register, State, Table

GROSS_NEGATIVE, NET_NEGATIVE = 1 << 7, 1 << 8
COUNT_N = 0.01 * 9.80665
"""Weight of a count, N: two decimals of a kilogram."""
TARE = 1234
"""Net weight is less than gross by this here, counts."""


def react(slave: MakersSlave, written: str) -> None:
    """Show the weights and their signs."""
    status = int(slave.get("status")) & ~(GROSS_NEGATIVE | NET_NEGATIVE)
    for name, bit, weight in (
        ("gross", GROSS_NEGATIVE, slave.get("weight")),
        ("net", NET_NEGATIVE, slave.get("weight") - TARE),
    ):
        slave.put(name, abs(weight))
        status |= bit if weight < 0 else 0
    slave.put("status", status)


TABLE = Table(
    profile="laumas_tlb",
    source="Laumas TLU manual p. 30, LCB manual p. 3",
    functions=frozenset({3, 16}),
    registers=(
        Register("firmware", "holding", (0,), "u16", at_start=102),
        Register("instrument", "holding", (1,), "u16"),
        Register("year", "holding", (2,), "u16", at_start=2018),
        Register("serial number", "holding", (3,), "u16", at_start=4711),
        Register("program", "holding", (4,), "u16"),
        Register("command", "holding", (5,), "u16", access="rw"),
        Register("status", "holding", (6,), "u16"),
        Register("gross", "holding", (7,), "u32"),
        Register("net", "holding", (9,), "u32"),
        Register("peak", "holding", (11,), "u32", at_start=99),
        Register("divisions", "holding", (13,), "u16"),
        Register("weight", "inside", (), "i32", -12000, 12000),
    ),
    faults=(
        *(
            State(name, {"status": 1 << bit})
            for bit, name in enumerate(
                ("cell error", "converter malfunction", "nine divisions too many", "110 % of full scale", "off scale")
            )
        ),
        State("full scale, weight at its end", {"status": 1 << 3, "weight": 12000}),
    ),
    harmless=(
        State("net weight displayed", {"status": 1 << 10}),
        State("stable", {"status": 1 << 11}),
        State("near zero", {"status": 1 << 12, "weight": 0}),
    ),
    react=react,
    shown={"force": ("weight", COUNT_N)},
)
