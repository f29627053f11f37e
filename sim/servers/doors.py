"""Interface of the doors into the simulated rig, and the choice of doors."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Protocol

CAN_DOORS = ("tcp", "slcan")
"""Doors of the CAN bus besides a real interface, which is named ``INTERFACE:CHANNEL``."""


class Readable(Protocol):
    """Something that ``select`` takes."""

    def fileno(self) -> int:
        """Return its descriptor."""
        ...


@dataclass(frozen=True, slots=True)
class Place:
    """Address of a wire for a program: its protocol, and the address, device or channel to open."""

    speaks: str
    at: str

    def __str__(self) -> str:
        """Return the address as in the ready line."""
        return f"{self.at} ({self.speaks})"


class WireDoor(Protocol):
    """One wire of the rig, open to other programs. No method waits, and no action of a client makes it raise."""

    @property
    def place(self) -> Place:
        """Its address."""
        ...

    @property
    def taken(self) -> bool:
        """Whether a program is connected, as far as the door can know."""
        ...

    @property
    def due_s(self) -> float:
        """Time when ``deliver`` has work, s of the rig; infinity if it must wait for a program."""
        ...

    def sources(self) -> Sequence[Readable]:
        """Return the objects that may become readable."""
        ...

    def read(self, ready: Collection[Readable], now: float) -> None:
        """Read from those ``sources`` that are ready, at ``now`` s of the rig."""
        ...

    def deliver(self, now: float) -> None:
        """Deliver the frames that have arrived on the wire by ``now`` s."""
        ...

    def close(self) -> None:
        """Close the door and the connections of its clients."""
        ...


@dataclass(frozen=True, slots=True)
class Doors:
    """Choice of a door for each wire: ``can`` is one of CAN_DOORS or ``INTERFACE:CHANNEL`` of python-can, ``lines`` one
    of LINE_DOORS. TCP doors listen at ``host`` from ``port`` on (0 = any free ones): CAN first, then the lines.

    ``links``: folder for a link to each pseudo-terminal, named ``can`` or as the line; "" = none.
    """

    can: str = "tcp"
    lines: str = "tcp"
    host: str = "127.0.0.1"
    port: int = 0
    links: str = ""
