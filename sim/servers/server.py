"""The simulated rig alive in real time, with its doors open.

One thread, one loop: it sleeps in ``select`` until a client sends something, a frame has arrived on a simulated wire,
a node has something due or the next step of the plant is. Clients come and go; the rig lives on.
"""

from __future__ import annotations

import select
from collections.abc import Callable
from contextlib import ExitStack
from math import inf
from pathlib import Path
from typing import Protocol

from sim.rig import SHORTEST_STEP_S, SimRig
from sim.servers.adapter_door import AdapterDoor
from sim.servers.connection import listen
from sim.servers.doors import CAN_DOORS, Doors, Place, WireDoor
from sim.servers.pty_doors import RtuDoor, SlcanDoor
from sim.servers.tcp_doors import GatewayDoor, SocketcandDoor

STEP_S = 0.01
"""The rig is advanced this often at least, s, and shown to the observer."""
LONGEST_SLEEP_S = 0.05
"""Of this computer's clock: how long it takes to notice, at most, that it is asked to end, s [A]."""


class Observer(Protocol):
    """Sees the rig every ``STEP_S``."""

    def observe(self, rig: SimRig, controlled: bool) -> None:
        """Take note of the rig as it is; ``controlled``: a program is on its CAN bus."""
        ...


class Life(Protocol):
    """What advances the rig: the rig itself, or what happens to it on the way."""

    @property
    def due_s(self) -> float:
        """When something happens by itself, s of the rig."""
        ...

    def advance(self, now: float) -> None:
        """Let everything live until ``now`` s."""
        ...


class RigServer:
    """A simulated rig in real time behind doors.

    ``can`` and ``lines`` are its doors; ``latest_s`` is how late the loop has come to something at most, s of the rig:
    more than some milliseconds means that this machine cannot keep the rig's time. ``speed`` is how many seconds of
    the rig a second of this computer's clock is worth: the loop has to know it to sleep.
    """

    def __init__(
        self, rig: SimRig, host: str, port: int, observer: Observer | None = None, doors: Doors | None = None
    ) -> None:
        """Open a door for every wire; without ``doors`` on ``host`` and ``port``.

        Raises OSError where a port, a device or an interface cannot be had.
        """
        self.rig = rig
        self.latest_s = 0.0
        self.speed = 1.0
        self.life: Life | None = None
        self.observer = observer
        with ExitStack() as opened:
            self.can, self.lines = _open(rig, doors or Doors(host=host, port=port), opened)
            opened.pop_all()
        self._doors: list[WireDoor] = [self.can, *self.lines.values()]
        self._step_due_s = 0.0

    @property
    def line_places(self) -> dict[str, Place]:
        """Where each Modbus line is."""
        return {name: door.place for name, door in self.lines.items()}

    def add(self, door: WireDoor) -> None:
        """Serve one more door, which is shut with the others."""
        self._doors.append(door)

    def serve(self, now: Callable[[], float], stopped: Callable[[], bool]) -> None:
        """Let the rig live by the clock ``now`` (s, from 0) until ``stopped``, which is asked every step."""
        self._step_due_s = now()
        while not stopped():
            self.turn(now)

    def turn(self, now: Callable[[], float]) -> None:
        """Sleep until something is to be done, and do it."""
        due = self._due_s()
        asleep_s = min(max(0.0, due - now()) / self.speed, LONGEST_SLEEP_S)
        sources = [source for door in self._doors for source in door.sources()]
        ready, _, _ = select.select(sources, (), (), asleep_s)
        t = now()
        if t - due > self.latest_s:
            self.latest_s = t - due
        (self.life or self.rig).advance(t)
        readable = set(ready)
        for door in self._doors:
            door.read(readable, t)
        for door in self._doors:
            door.deliver(t)
        if t >= self._step_due_s:
            if self.observer is not None:
                self.observer.observe(self.rig, self.can.taken)
            while self._step_due_s <= t:
                self._step_due_s += STEP_S

    def close(self) -> None:
        """Shut every door."""
        for door in self._doors:
            door.close()

    def _due_s(self) -> float:
        """Return when the loop must turn next, s."""
        due = self._step_due_s if self.life is None else min(self._step_due_s, self.life.due_s)
        # The rig takes no step shorter than this: what a node has due before it waits as long.
        soonest = self.rig.now_s + SHORTEST_STEP_S
        for drive in self.rig.axes.values():
            if drive.due_s < due:
                due = max(drive.due_s, soonest)
        for node in self.rig.nodes:
            if node.due_s < due:
                due = max(node.due_s, soonest)
        return min(due, min((door.due_s for door in self._doors), default=inf))


def _open(rig: SimRig, doors: Doors, opened: ExitStack) -> tuple[WireDoor, dict[str, WireDoor]]:
    """Open the doors of a rig: all of them or none."""

    def kept(door: WireDoor) -> WireDoor:
        opened.callback(door.close)
        return door

    def at(number: int) -> int:
        return doors.port + number if doors.port else 0

    links = Path(doors.links) if doors.links else None
    can: WireDoor
    if doors.can == "tcp":
        can = kept(SocketcandDoor(rig.can, listen(doors.host, at(0))))
    elif doors.can == "slcan":
        can = kept(SlcanDoor(rig.can, links / "can" if links else None))
    else:
        interface, colon, channel = doors.can.partition(":")
        if not colon or not interface or not channel:
            known = ", ".join(CAN_DOORS)
            raise ValueError(f"{doors.can!r} is no door of the CAN bus; expected {known} or INTERFACE:CHANNEL")
        can = kept(AdapterDoor(rig.can, interface, channel))
    lines: dict[str, WireDoor] = {}
    for number, (name, wire) in enumerate(rig.lines.items(), 1):
        if doors.lines == "tcp":
            lines[name] = kept(GatewayDoor(wire, listen(doors.host, at(number))))
        else:
            lines[name] = kept(RtuDoor(wire, wire.baud, links / name if links else None))
    return can, lines
