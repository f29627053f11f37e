"""Calex PyroUSB thermometer (PUA8): manual p. 11 and 12. Temperatures are in tenths of degC, signed.

Emissivity is in 1/10000; 0x08 is non-volatile, 0x18 is not.
"""

from __future__ import annotations

from tests.campaigns.makers.calex_pyrominibus import TABLE as PYROMINIBUS
from tests.campaigns.makers.table import Register, Table

TABLE = Table(
    profile="calex_pyrousb",
    source="Calex PyroUSB manual p. 11-12",
    functions=frozenset({3, 4, 6, 16}),
    registers=(
        Register("type", "holding", (0x00,), "u16", at_start=21),
        Register("field of view", "holding", (0x01,), "u16"),
        Register("serial number", "holding", (0x02,), "u32", at_start=4712),
        Register("range", "holding", (0x04,), "u16"),
        Register("slave address", "holding", (0x05,), "u16", 1, 247, "rw", 1),
        Register("compensation", "holding", (0x06,), "u16", 0, 1, "rw"),
        Register("reflected", "holding", (0x07,), "i16", access="rw", at_start=230),
        Register("emissivity", "holding", (0x08,), "u16", 1000, 10000, "rw", 7000),
        Register("transmissivity", "holding", (0x09,), "u16", 2000, 10000, "rw", 10000),
        Register("at 4 mA", "holding", (0x0A,), "i16", access="rw"),
        Register("at 20 mA", "holding", (0x0B,), "i16", access="rw", at_start=5000),
        Register("hold mode", "holding", (0x0C,), "u16", 0, 2, "rw"),
        Register("hold period", "holding", (0x0D,), "u16", 0, 12000, "rw", 10),
        Register("average period", "holding", (0x0E,), "u16", 0, 600, "rw", 1),
        Register("average", "holding", (0x0F,), "i16", at_start=-150),
        Register("minimum", "holding", (0x10,), "i16", at_start=-160),
        Register("maximum", "holding", (0x11,), "i16", at_start=-140),
        Register("filtered", "holding", (0x12,), "i16", -400, 10000),
        Register("unfiltered", "holding", (0x13,), "i16", -400, 10000),
        Register("sensor temperature", "holding", (0x14,), "i16", 0, 700),
        Register("status", "holding", (0x15,), "u16"),
        Register("reflected, volatile", "holding", (0x17,), "i16", access="rw", at_start=230),
        Register("emissivity, volatile", "holding", (0x18,), "u16", 1000, 10000, "rw", 7000),
    ),
    faults=PYROMINIBUS.faults,
    one_area=True,
    shown={"surface": ("filtered", 0.1), "unfiltered": ("unfiltered", 0.1), "sensor": ("sensor temperature", 0.1)},
    parameters={"emissivity": ("emissivity, volatile", 1e-4)},
)
