"""Calex PyroMiniBus thermometer (PMB21): operator's manual p. 7. Temperatures are in tenths of degC, signed.

Emissivity is in 1/10000; 0x07 is non-volatile, 0x17 is not.
"""

from __future__ import annotations

from tests.campaigns.makers.table import Register, State, Table

TABLE = Table(
    profile="calex_pyrominibus",
    source="Calex PMB21 operator's manual p. 7",
    functions=frozenset({3, 4, 6, 16}),
    registers=(
        Register("type", "holding", (0x00,), "u16", at_start=17),
        Register("field of view", "holding", (0x01,), "u16", at_start=1),
        Register("serial number", "holding", (0x02,), "u32", at_start=4711),
        Register("slave address", "holding", (0x04,), "u16", 1, 247, "rw", 1),
        Register("compensation", "holding", (0x05,), "u16", 0, 1, "rw"),
        Register("reflected", "holding", (0x06,), "i16", access="rw", at_start=230),
        Register("emissivity", "holding", (0x07,), "u16", 2000, 10000, "rw", 7000),
        Register("hold mode", "holding", (0x08,), "u16", 0, 2, "rw"),
        Register("hold period", "holding", (0x09,), "u16", 1, 12000, "rw", 10),
        Register("average period", "holding", (0x0A,), "u16", 1, 600, "rw", 1),
        Register("average", "holding", (0x0B,), "i16", at_start=-150),
        Register("minimum", "holding", (0x0C,), "i16", at_start=-160),
        Register("maximum", "holding", (0x0D,), "i16", at_start=-140),
        Register("filtered", "holding", (0x0E,), "i16", -200, 10000),
        Register("unfiltered", "holding", (0x0F,), "i16", -200, 10000),
        Register("sensor temperature", "holding", (0x10,), "i16", 0, 1800),
        Register("status", "holding", (0x11,), "u16"),
        Register("reflected, volatile", "holding", (0x16,), "i16", access="rw", at_start=230),
        Register("emissivity, volatile", "holding", (0x17,), "u16", 2000, 10000, "rw", 7000),
    ),
    faults=tuple(
        State(name, {"status": 1 << bit})
        for bit, name in enumerate(
            ("measurement error", "sensor too cold", "sensor too hot", "object too cold", "object too hot")
        )
    ),
    one_area=True,
    shown={"surface": ("filtered", 0.1), "unfiltered": ("unfiltered", 0.1), "sensor": ("sensor temperature", 0.1)},
    parameters={"emissivity": ("emissivity, volatile", 1e-4)},
)
