"""SHT20 temperature and humidity transmitter, as its vendors describe it: two input registers in tenths, signed degC.

It has no fault register: a broken sensor shows impossible numbers.
"""

from __future__ import annotations

from tests.campaigns.makers.table import Register, State, Table

TABLE = Table(
    profile="hygrometer_sht20",
    source="SHT20 transmitter, vendor's page (qariya.net), XY-MD02",
    functions=frozenset({3, 4, 6, 16}),
    registers=(
        Register("temperature", "input", (0x0001,), "i16", -400, 800),
        Register("humidity", "input", (0x0002,), "u16", 0, 1000),
        Register("device address", "holding", (0x0101,), "u16", 1, 247, "rw", 1),
        Register("baud rate", "holding", (0x0102,), "u16", 0, 2, "rw"),
        Register("temperature correction", "holding", (0x0103,), "i16", -100, 100, "rw"),
        Register("humidity correction", "holding", (0x0104,), "i16", -100, 100, "rw"),
    ),
    faults=(State("more than 100 % of humidity", {"humidity": 1300}), State("far too hot", {"temperature": 30000})),
    shown={"ambient_c": ("temperature", 0.1), "humidity_percent": ("humidity", 0.1)},
)
