"""Flintec DAD 141.1 load cell amplifier: "Modbus Communication", Rev. 2.3, June 2014, p. 2 to 10.

Floats have their high word first; functions 3 and 4 read the same registers. Index 3500 hex shows gross weight, net
weight and qualifier together. The tare is a bit command, and the net weight then counts from there.
"""

from __future__ import annotations

from tests.campaigns.makers.slave import MakersSlave
from tests.campaigns.makers.table import Register, State, Table

RESET_ZERO, SET_ZERO, RESET_TARE, SET_TARE = 0x01, 0x02, 0x04, 0x08
"""Bit commands (p. 4)."""
NEWTONS = 9.80665
"""Weight of a kilogram, N."""
TARED = 0x20
"""Qualifier bit "tare set"."""


def react(slave: MakersSlave, written: str) -> None:
    """Carry out a bit command, and count the net weight from the tare."""
    if written == "bit commands":
        command = int(slave.get("bit commands"))
        if command & (SET_TARE | RESET_TARE):
            slave.kept["tare"] = slave.get("gross") if command & SET_TARE else 0.0
            qualifier = int(slave.get("qualifier")) & ~TARED
            slave.put("qualifier", qualifier | (TARED if command & SET_TARE else 0))
    net = slave.get("gross") - slave.kept.get("tare", 0.0)
    if written in ("gross", "bit commands"):
        slave.put("net", net)
        for name in ("gross", "net"):
            slave.put(f"{name}, whole", round(slave.get(name)))


TABLE = Table(
    profile="flintec_dad141",
    source="Flintec DAD 141.1 Modbus communication Rev. 2.3 p. 2-10",
    functions=frozenset({3, 4, 6, 16}),
    registers=(
        Register("gross", "holding", (0x2000, 0x3500), "f32", -1000.0, 1000.0),
        Register("net", "holding", (0x2002, 0x3502), "f32"),
        Register("average", "holding", (0x2008,), "f32"),
        Register("gross, whole", "holding", (0x2020, 0x3300), "i32"),
        Register("net, whole", "holding", (0x2022, 0x3302), "i32"),
        Register("firmware", "holding", (0x202E,), "u32", at_start=0x0217),
        Register("device status", "holding", (0x2030,), "i32"),
        Register("serial number", "holding", (0x2034,), "i32", at_start=141_001),
        Register("qualifier", "holding", (0x2060, 0x3304, 0x3504), "u16"),
        Register("bit commands", "holding", (0x2061,), "u16", access="w"),
        Register("filter", "holding", (0x2106,), "i32", 0, 7, "rw"),
        Register("filter mode", "holding", (0x2110,), "i32", 0, 1, "rw"),
    ),
    faults=(
        State("under range", {"qualifier": 0x01, "gross": -1000.0}),
        State("over range", {"qualifier": 0x02, "gross": 1000.0}),
        State("over range, in motion", {"qualifier": 0x302, "gross": 12.0}),
    ),
    harmless=(
        State("no motion", {"qualifier": 0x10}),
        State("above set-points", {"qualifier": 0x700}),
        State("tared", {"bit commands": SET_TARE}),
    ),
    one_area=True,
    react=react,
    shown={"force": ("gross", NEWTONS)},
)
