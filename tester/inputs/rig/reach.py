"""The rig file that reaches a simulated rig behind its doors: a machine's file in every respect."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from tester.inputs.rig.config import OneRig

BUS = "vcan0"
"""Name that a client of the TCP door opens; the door takes any."""


def reached(rig: OneRig, can: tuple[str, str], lines: Mapping[str, tuple[str, bool]], how: str) -> OneRig:
    """Return ``rig`` as a machine, its bus at ``can`` (python-can's interface and channel), its lines at ``lines``.

    Those are port, and whether it is one of Modbus TCP. ``how`` goes into its name. What it is to believe of the air
    around it is what the simulated rig's air is.
    """
    interface, channel = can
    return replace(
        rig.in_air(rig.ambient_c),
        rig=f"{rig.rig}, over {how}",
        simulated=False,
        can=replace(rig.can, interface=interface, channel=channel),
        lines={
            name: replace(line, port=lines[name][0], framing="socket" if lines[name][1] else "rtu")
            for name, line in rig.lines.items()
        },
    )


def reached_over_tcp(rig: OneRig, can: tuple[str, int], lines: Mapping[str, tuple[str, int]]) -> OneRig:
    """Return ``rig`` as a machine whose bus is at ``can`` (host, port; socketcand) and whose Modbus lines are at
    ``lines`` (Modbus TCP)."""
    places = {name: (_text(address), True) for name, address in lines.items()}
    return reached(rig, ("socketcand", f"{BUS}@{_text(can)}"), places, "TCP")


def _text(address: tuple[str, int]) -> str:
    return f"{address[0]}:{address[1]}"
