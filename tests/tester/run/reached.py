"""A simulated rig as a machine that programs reach over TCP."""

from __future__ import annotations

from collections.abc import Mapping

from tester.inputs.rig.config import OneRig
from tester.run.sim_process import reached

BUS = "vcan0"
"""Name that a client of the TCP door opens; the door takes any."""


def reached_over_tcp(rig: OneRig, can: tuple[str, int], lines: Mapping[str, tuple[str, int]]) -> OneRig:
    """Return ``rig`` as a machine whose bus is at ``can`` (host, port; socketcand) and whose Modbus lines are at
    ``lines`` (Modbus TCP)."""
    places = {name: (f"{host}:{port}", True) for name, (host, port) in lines.items()}
    return reached(rig, ("socketcand", f"{BUS}@{can[0]}:{can[1]}"), places, "TCP")
