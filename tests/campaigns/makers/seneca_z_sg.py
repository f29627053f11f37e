"""Seneca Z-SG strain gauge converter: manual p. 17 to 20. Holding registers, the first one 40001, at offset 0.

A 32-bit number has its most significant word first, as it leaves the factory. The manual's pages name no fault
register: a cell beyond its end scale shows in the weight alone, and a broken wire as full scale or as no number.
"""

from __future__ import annotations

from math import inf, nan

from tests.campaigns.makers.table import Register, State, Table

NEWTONS = 9.80665
"""Weight of a kilogram, N."""

TABLE = Table(
    profile="seneca_z_sg",
    source="Seneca Z-SG manual p. 17-20",
    functions=frozenset({3, 6, 16}),
    registers=(
        Register("threshold", "holding", (51,), "f32", access="rw", at_start=5000.0),
        Register("delta weight", "holding", (53,), "f32", access="rw", at_start=1.0),
        Register("delta time", "holding", (55,), "u16", access="rw", at_start=100),
        Register("net", "holding", (63,), "f32", -1000.0, 1000.0),
    ),
    faults=(
        State("wire broken", {"net": nan}),
        State("at the end of the float", {"net": inf}),
        State("far beyond the end scale", {"net": 1e6}),
        State("far below zero", {"net": -1e6}),
    ),
    shown={"force": ("net", NEWTONS)},
)
