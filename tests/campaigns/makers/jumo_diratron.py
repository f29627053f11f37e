"""JUMO diraTRON controller: interface description 70211000T92Z001K000, p. 16 to 37. Floats with their low word first.

Functions 3 and 4 read the same words. An invalid measured value is shown by the value itself, as 1e37 to 8e37 (p. 24).
A write to a protected address is refused by exception 8 (p. 23); leaving the measuring range puts the controller into
manual mode (0x4B2C). Here it starts in manual mode.
"""

from __future__ import annotations

from tests.campaigns.makers.slave import MakersSlave
from tests.campaigns.makers.table import Register, State, Table

AUTOMATIC, MANUAL = 1, 3
"""Controller modes."""
INVALID = 1e36
"""Greater values are error codes."""


def react(slave: MakersSlave, written: str) -> None:
    """Regulate: the setpoint in use is setpoint 1, and the output is proportional to the deviation."""
    slave.put("setpoint", slave.get("setpoint 1"))
    measured = slave.get("analog input")
    slave.put("actual value", measured)
    invalid = measured > INVALID
    slave.put("manual by range", invalid)
    if written in ("to manual", "to automatic") and slave.get(written):
        slave.put("manual mode", written == "to manual")
    manual = invalid or slave.get("manual mode") != 0.0
    slave.put("mode", MANUAL if manual else AUTOMATIC)
    deviation = slave.get("setpoint") - measured
    slave.put("deviation", 3e37 if invalid else deviation)
    slave.put("output level", slave.get("manual level") if manual else min(max(2.0 * deviation, 0.0), 100.0))


TABLE = Table(
    profile="jumo_diratron",
    source="JUMO diraTRON interface description 70211000T92Z001K000 p. 16-37",
    functions=frozenset({3, 4, 6, 16}),
    registers=(
        Register("tuning active", "holding", (0x4B2A,), "u16"),
        Register("manual mode", "holding", (0x4B2B,), "u16", at_start=1),
        Register("manual by range", "holding", (0x4B2C,), "u16"),
        Register("cycle alarm", "holding", (0x4B2D,), "u16"),
        Register("output alarm", "holding", (0x4B2E,), "u16"),
        Register("mode", "holding", (0x4B38,), "u16", at_start=MANUAL),
        Register("manual inhibited", "holding", (0x4B39,), "u16"),
        Register("tuning inhibited", "holding", (0x4B3A,), "u16"),
        Register("start tuning", "holding", (0x5350,), "u16", 0, 1, "rw"),
        Register("cancel tuning", "holding", (0x5351,), "u16", 0, 1, "rw"),
        Register("to manual", "holding", (0x5352,), "u16", 0, 1, "rw"),
        Register("to automatic", "holding", (0x5353,), "u16", 0, 1, "rw"),
        Register("manual level", "holding", (0x5354,), "f32", access="rw"),
        Register("store", "holding", (0x6D00,), "u16", 0, 1, "rw"),
        Register("limit values", "holding", (0x6D50,), "u16"),
        Register("timer", "holding", (0x6D51,), "u16"),
        Register("digital outputs", "holding", (0x6D52,), "u16"),
        Register("control signals", "holding", (0x6D53,), "u16"),
        Register("digital inputs", "holding", (0x6D54,), "u16"),
        Register("external inputs", "holding", (0x6D55,), "u16"),
        Register("controller outputs", "holding", (0x6D56,), "u16"),
        Register("analog input", "holding", (0x7000,), "f32", 0.0, 150.0),
        Register("least value", "holding", (0x7002,), "f32"),
        Register("greatest value", "holding", (0x7004,), "f32"),
        Register("tara", "holding", (0x7006,), "f32"),
        Register("setpoint", "holding", (0x7010,), "f32"),
        Register("actual value", "holding", (0x7012,), "f32"),
        Register("deviation", "holding", (0x7014,), "f32"),
        Register("output level", "holding", (0x7016,), "f32"),
        Register("setpoint 1", "holding", (0x7018,), "f32", 0.0, 150.0, "rw"),
        Register("setpoint 2", "holding", (0x701A,), "f32", access="rw"),
        Register("setpoint 3", "holding", (0x701C,), "f32", access="rw"),
        Register("setpoint 4", "holding", (0x701E,), "f32", access="rw"),
    ),
    faults=tuple(
        State(name, {"analog input": code})
        for name, code in (
            ("measuring range underflow", 1e37),
            ("measuring range overflow", 2e37),
            ("value invalid", 3e37),
            ("division by zero", 4e37),
            ("math error", 5e37),
            ("terminal temperature", 6e37),
            ("probe short circuit", 7e37),
            ("probe break", 8e37),
        )
    ),
    low_word_first=True,
    one_area=True,
    protected=8,
    react=react,
    shown={"pv": ("analog input", 1.0), "setpoint": ("setpoint", 1.0), "output": ("output level", 1.0)},
    parameters={"setpoint": ("setpoint 1", 1.0)},
    wanted={"mode": AUTOMATIC},
)
