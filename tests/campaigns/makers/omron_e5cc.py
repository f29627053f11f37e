"""Omron E5CC controller: Communications Manual H175, sections 4 (commands, error codes) and 5 (variable area, status).

Every number is in the variable area twice: in two registers (four-byte mode), and in one (two-byte mode). Commands are
written by function 6 to address 0000 or FFFF hex. Until communications writing is on, every other write is an operation
error, exception 4. Temperatures and output are in tenths here.
"""

from __future__ import annotations

from tests.campaigns.makers.slave import MakersSlave
from tests.campaigns.makers.table import Register, State, Table

WRITING, RUN_STOP, WRITE_MODE, AUTO_MANUAL = 0x00, 0x01, 0x04, 0x09
"""Codes of commands, in the high byte; the low byte is 0 or 1."""
STATES = {WRITE_MODE: ("RAM", 20), RUN_STOP: ("stopped", 24), WRITING: ("writing", 25), AUTO_MANUAL: ("manual", 26)}
"""By command: the device's state, and its bit of the status."""
FAULTS = (2, 6)
"""Bits of the status: converter error, input error."""
OPERATION_ERROR, DATA_ERROR = 4, 3


def forbids(slave: MakersSlave, written: str) -> int:
    """Refuse writes while communications writing is off, and unknown commands."""
    if written == "command":
        code, related = divmod(int(slave.get("command")), 0x100)
        if code not in STATES or related > 1:
            return DATA_ERROR
        return 0 if code == WRITING or slave.get("writing") else OPERATION_ERROR
    return 0 if slave.get("writing") else OPERATION_ERROR


def react(slave: MakersSlave, written: str) -> None:
    """Obey a command, regulate, and show every number in both modes."""
    if written == "command":
        code, related = divmod(int(slave.get("command")), 0x100)
        slave.put(STATES[code][0], related)
    if written == "set point, long":
        slave.put("set point", slave.get("set point, long"))
    status = int(slave.get("faults and outputs"))
    for name, bit in STATES.values():
        status |= int(slave.get(name)) << bit
    slave.put("status, long", status)
    slave.put("status", status & 0xFFFF)
    slave.put("status, upper", status >> 16)
    slave.put("internal set point", slave.get("set point"))
    output = 0.0 if slave.get("stopped") else min(max(slave.get("set point") - slave.get("PV"), 0.0), 1000.0)
    slave.put("MV", output)
    for name in ("PV", "internal set point", "MV", "set point"):
        slave.put(f"{name}, long", slave.get(name))


TABLE = Table(
    profile="omron_e5cc",
    source="Omron H175 p. 3-25, 4-5, 4-12, 5-2",
    functions=frozenset({3, 6, 8, 16}),
    registers=(
        Register("PV", "holding", (0x2000, 0x2402), "i16", -200, 5000),
        Register("status", "holding", (0x2001, 0x2406), "u16"),
        Register("internal set point", "holding", (0x2002, 0x2403), "i16"),
        Register("heater current", "holding", (0x2003,), "u16"),
        Register("MV", "holding", (0x2004,), "i16"),
        Register("MV cooling", "holding", (0x2005,), "i16"),
        Register("status, upper", "holding", (0x2407,), "u16"),
        Register("set point", "holding", (0x2103,), "i16", 0, 1500, "rw"),
        Register("PV, long", "holding", (0x0000, 0x0404), "i32"),
        Register("status, long", "holding", (0x0002, 0x040C), "u32"),
        Register("internal set point, long", "holding", (0x0004, 0x0406), "i32"),
        Register("heater current, long", "holding", (0x0006,), "i32"),
        Register("MV, long", "holding", (0x0008,), "i32"),
        Register("MV cooling, long", "holding", (0x000A,), "i32"),
        Register("set point, long", "holding", (0x0106,), "i32", 0, 1500, "rw"),
        Register("command", "inside", (), "u16"),
        Register("faults and outputs", "inside", (), "u16"),
        *(Register(name, "inside", (), "u16") for name, _ in STATES.values()),
    ),
    faults=tuple(
        State(name, {"faults and outputs": 1 << bit})
        for name, bit in zip(("converter error", "input error"), FAULTS, strict=True)
    ),
    harmless=(
        State("heating", {"faults and outputs": 1 << 8}),
        State("alarm 1", {"faults and outputs": 1 << 12}),
    ),
    commands=(0x0000, 0xFFFF),
    forbids=forbids,
    react=react,
    shown={"pv": ("PV", 0.1), "setpoint": ("internal set point", 0.1), "output": ("MV", 0.1)},
    parameters={"setpoint": ("set point", 0.1)},
    wanted={"writing": 1, "manual": 0},
)
