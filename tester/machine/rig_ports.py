"""The wires to a rig, simulated or real."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass

from drivers.ports import CanPort, LinePort
from tester.base.clock import Pace


@dataclass(frozen=True, slots=True)
class Ports:
    """The wires to a rig: one CAN bus, and the Modbus lines by their names in the rig file.

    Real wires have a clock that stamps their arrivals (``pace``); ``opened`` closes the wires.
    """

    can: CanPort
    lines: dict[str, LinePort]
    pace: Pace | None = None
    opened: ExitStack | None = None

    def close(self) -> None:
        """Close the wires."""
        if self.opened is not None:
            self.opened.close()
