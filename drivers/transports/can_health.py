"""How a CAN bus does: error frames that an adapter passes on, by what they say, and the adapter's own state."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from drivers.transports import socketcand

if TYPE_CHECKING:
    import can

BUS_OFF: Final = 0x40
"""Class bit of a SocketCAN error frame (linux/can/error.h, CAN_ERR_BUSOFF)."""
_CLASSES: Final = {
    0x001: "transmit time-out", 0x002: "lost arbitration", 0x004: "controller", 0x008: "protocol violation",
    0x010: "transceiver", 0x020: "no acknowledgement", BUS_OFF: "bus-off", 0x080: "bus error", 0x100: "restarted",
    0x200: "error counters",
}  # fmt: skip
"""Class bits of a SocketCAN error frame (linux/can/error.h)."""
_BY_CLASS: Final = ("socketcan", socketcand.INTERFACE)
"""Interfaces whose error frames have these; those of others say what their makers chose."""


def kinds_of(interface: str, can_id: int) -> tuple[str, ...]:
    """Return what an error frame with this identifier says."""
    found = tuple(text for bit, text in _CLASSES.items() if can_id & bit) if interface in _BY_CLASS else ()
    return found or ("error",)


def state_of(bus: can.BusABC) -> str:
    """Return an adapter's state, in small letters: active, passive or error; "" where its interface tells none."""
    import can

    if type(bus).state is can.BusABC.state:  # it says ACTIVE whatever the bus does
        return ""
    try:
        return bus.state.name.lower()
    except (can.CanError, OSError, NotImplementedError, ValueError, AttributeError):
        return ""
