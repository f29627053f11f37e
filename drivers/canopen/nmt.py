"""Network management frames (CiA 301, 7.2.8.2)."""

from __future__ import annotations

from drivers.canopen.objects import NmtCommand, NmtState

ALL_NODES = 0


def encode(command: NmtCommand, node_id: int) -> bytes:
    """Return the data of an NMT frame for one node (1..127), or for ALL_NODES."""
    return bytes((command, node_id))


def decode(data: bytes) -> tuple[int, int] | None:
    """Return (command byte, node id) of an NMT frame, or None where it has not two bytes."""
    if len(data) != 2:
        return None
    return data[0], data[1]


def state_name(state: int) -> str:
    """Return the name of a heartbeat's state byte."""
    try:
        return NmtState(state).name.replace("_", "-")
    except ValueError:
        return f"unknown state {state}"
