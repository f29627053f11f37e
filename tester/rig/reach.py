"""The rig file that reaches a simulated rig behind its doors: a machine's file in every respect."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from tester.rig.config import OneRig

BUS = "vcan0"
"""Name that a client opens; the door takes any."""


def reached_over_tcp(rig: OneRig, can: tuple[str, int], lines: Mapping[str, tuple[str, int]]) -> OneRig:
    """Return ``rig`` as a machine whose bus is at ``can`` (host, port; socketcand) and whose Modbus lines are at
    ``lines`` (Modbus TCP). What it is to believe of the air around it is what the simulated rig's air is."""
    return replace(
        rig.in_air(rig.ambient_c),
        rig=f"{rig.rig}, over TCP",
        simulated=False,
        can=replace(rig.can, interface="socketcand", channel=f"{BUS}@{_text(can)}"),
        lines={name: replace(line, port=_text(lines[name]), framing="socket") for name, line in rig.lines.items()},
    )


def _text(address: tuple[str, int]) -> str:
    return f"{address[0]}:{address[1]}"
