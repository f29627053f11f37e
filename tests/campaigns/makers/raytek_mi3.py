"""Raytek MI3 thermometer, head 1 on its box: manual Rev. G Nov/2015, p. 97 to 101, and Rev. G2, p. 104.

Floats have their most significant word first. Head parameters are at 1000 times the head's number, counted from 0; the
status is eight discrete inputs. A value outside its range raises no exception: the box keeps the previous one, and sets
its error code (p. 99). The head calculates with the internal emissivity while its source is "I".
"""

from __future__ import annotations

from tests.campaigns.makers.slave import MakersSlave
from tests.campaigns.makers.table import Register, State, Table


def react(slave: MakersSlave, written: str) -> None:
    """Show the emissivity with which the head calculates, and the unit in its status."""
    internal = slave.get("emissivity source") == ord("I")
    slave.put("emissivity calculated", slave.get("emissivity internal") if internal else 0.5)
    if written == "temperature unit":
        fahrenheit = slave.get("temperature unit") == ord("F")
        slave.put("head status", int(slave.get("head status")) & ~1 | fahrenheit)


TABLE = Table(
    profile="raytek_mi3",
    source="Raytek MI3 manual Rev. G p. 97-101, Rev. G2 p. 104",
    functions=frozenset({1, 2, 3, 4, 6, 16}),
    registers=(
        Register("error code", "input", (1,), "u16"),
        Register("temperature unit", "holding", (70,), "u16", ord("C"), ord("F"), "rw", ord("F")),
        Register("box temperature", "input", (80,), "f32"),
        Register("connected heads", "discrete", (100,), "bits8", at_start=0b1),
        Register("registered heads", "discrete", (110,), "bits8", at_start=0b1),
        Register("head status", "discrete", (1005,), "bits8", at_start=0b1),
        Register("device bottom", "input", (1060,), "f32", at_start=-40.0),
        Register("device top", "input", (1070,), "f32", at_start=600.0),
        Register("target temperature", "input", (1080,), "f32", -40.0, 600.0),
        Register("internal temperature", "input", (1090,), "f32", -10.0, 120.0),
        Register("ambient", "holding", (1100,), "f32", access="rw"),
        Register("ambient control", "holding", (1120,), "u16", 0, 2, "rw"),
        Register("emissivity calculated", "input", (1160,), "f32", at_start=0.95),
        Register("sensor gain", "holding", (1180,), "f32", access="rw", at_start=1.0),
        Register("sensor offset", "holding", (1190,), "f32", access="rw"),
        Register("emissivity internal", "holding", (1200,), "f32", 0.1, 1.1, "rw", 0.95),
        Register("emissivity pointer", "holding", (1210,), "u16", 0, 7, "rw"),
        Register("emissivity source", "holding", (1220,), "u16", ord("D"), ord("I"), "rw", ord("E")),
    ),
    faults=(
        State("object out of range", {"head status": 0b10, "target temperature": 600.0}),
        State("object below its range", {"head status": 0b10, "target temperature": -40.0}),
        State("ambient out of range", {"head status": 0b100, "internal temperature": 130.0}),
        State("self-test error", {"head status": 0b10_0000}),
        State("degrees Fahrenheit", {"head status": 0b1, "target temperature": 212.0}),
    ),
    harmless=(State("background compensation on", {"head status": 0b1000_0000}),),
    out_of_range=None,
    react=react,
    shown={"surface": ("target temperature", 1.0), "sensor": ("internal temperature", 1.0)},
    parameters={"emissivity": ("emissivity internal", 1.0)},
    wanted={"emissivity source": ord("I"), "temperature unit": ord("C")},
)
