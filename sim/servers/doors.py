"""What a door into the simulated rig is, and which ones there are to choose from."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Protocol

CAN_DOORS = ("tcp", "slcan")
"""Ways to the CAN bus besides a real interface, which is named ``INTERFACE:CHANNEL``."""


class Readable(Protocol):
    """Something that ``select`` takes."""

    def fileno(self) -> int:
        """Return its descriptor."""
        ...


@dataclass(frozen=True, slots=True)
class Place:
    """Where a wire is for a program: what it speaks, and the address, device or channel to open."""

    speaks: str
    at: str

    def __str__(self) -> str:
        """Return it as the ready line shows it."""
        return f"{self.at} ({self.speaks})"


class WireDoor(Protocol):
    """One wire of the rig, open to other programs. No method waits, and none raises for what a client does."""

    @property
    def place(self) -> Place:
        """Where it is."""
        ...

    @property
    def taken(self) -> bool:
        """Whether a program is connected, as far as the door can know."""
        ...

    @property
    def due_s(self) -> float:
        """When ``deliver`` has something to do next, s of the rig; infinity when a program has to begin."""
        ...

    def sources(self) -> Sequence[Readable]:
        """Return what may have something to read."""
        ...

    def read(self, ready: Collection[Readable], now: float) -> None:
        """Take what has come from those ``sources`` that are ready, at ``now`` s of the rig."""
        ...

    def deliver(self, now: float) -> None:
        """Pass on what has arrived on the wire by ``now`` s."""
        ...

    def close(self) -> None:
        """Shut it and let go of its clients."""
        ...


@dataclass(frozen=True, slots=True)
class Doors:
    """Which door each wire gets: ``can`` one of CAN_DOORS or ``INTERFACE:CHANNEL`` of python-can, ``lines`` one of
    LINE_DOORS; TCP doors listen at ``host`` from ``port`` on (0 = any free ones): CAN there, the lines after it.

    ``links``: folder that gets a link to each pseudo-terminal, named ``can`` or as the line; "" = none.
    """

    can: str = "tcp"
    lines: str = "tcp"
    host: str = "127.0.0.1"
    port: int = 0
    links: str = ""
