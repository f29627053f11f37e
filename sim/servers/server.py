"""The simulated rig in real time, with its doors open.

One thread, one loop: it sleeps in ``select`` until a client sends something, a frame arrives on a simulated wire,
a node has something due, or the next step of the plant is due. Clients come and go; the rig continues.
"""

from __future__ import annotations

import select
from collections.abc import Callable
from contextlib import ExitStack
from math import inf
from pathlib import Path
from typing import Protocol

from drivers.canopen import objects as o
from drivers.canopen.messages import encode_emergency
from sim.rig import SHORTEST_STEP_S, SimRig
from sim.servers.adapter_door import AdapterDoor
from sim.servers.connection import listen
from sim.servers.doors import CAN_DOORS, Doors, Place, WireDoor
from sim.servers.pty_doors import RtuDoor, SlcanDoor
from sim.servers.tcp_doors import GatewayDoor, SocketcandDoor

STEP_S = 0.01
"""Longest step of the rig, s; after each the observer sees the rig."""
LATE_S = 0.015
"""Lateness that the machine reports, s of this computer's clock: a scan of 100 Hz trips where two answers are missing.
"""
STARVED_S = 0.15
"""Lateness of which its user reads, s of this computer's clock: drives are then taken for silent in every state."""
LONGEST_SLEEP_S = 0.05
"""Longest delay before the loop notices a request to end, s of this computer's clock [A]."""


class Observer(Protocol):
    """Sees the rig every ``STEP_S``."""

    def observe(self, rig: SimRig, controlled: bool) -> None:
        """Record the rig's present state; ``controlled``: a program is on its CAN bus."""
        ...


class Life(Protocol):
    """Advances the rig: the rig itself, or a wrapper that causes events on the way."""

    @property
    def due_s(self) -> float:
        """Time of the next event, s of the rig."""
        ...

    def advance(self, now: float) -> None:
        """Advance everything to ``now`` s."""
        ...


class RigServer:
    """A simulated rig in real time behind doors.

    ``can`` and ``lines`` are its doors; ``latest_s`` is the greatest delay of the loop, s of the rig: more than some
    milliseconds means that this machine cannot keep the rig's time. ``speed`` is the number of seconds of the rig in a
    second of this computer's clock: the loop needs it to sleep.
    """

    def __init__(
        self, rig: SimRig, host: str, port: int, observer: Observer | None = None, doors: Doors | None = None
    ) -> None:
        """Open a door for every wire, on ``host`` and ``port`` if ``doors`` is not given.

        Raises OSError if a port, a device or an interface is not available.
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
        self.starved_s: list[float] = []
        """Every lateness beyond ``STARVED_S`` while a program was on the CAN bus, s of this computer's clock."""

    @property
    def line_places(self) -> dict[str, Place]:
        """Address of each Modbus line."""
        return {name: door.place for name, door in self.lines.items()}

    def add(self, door: WireDoor) -> None:
        """Serve one more door, which is closed with the others."""
        self._doors.append(door)

    def serve(self, now: Callable[[], float], stopped: Callable[[], bool]) -> None:
        """Run the rig by the clock ``now`` (s, from 0) until ``stopped``, which is called every step."""
        self._step_due_s = now()
        while not stopped():
            self.turn(now)

    def turn(self, now: Callable[[], float]) -> None:
        """Sleep until work is due, and do it."""
        due = self._due_s()
        asleep_s = min(max(0.0, due - now()) / self.speed, LONGEST_SLEEP_S)
        sources = [source for door in self._doors for source in door.sources()]
        ready, _, _ = select.select(sources, (), (), asleep_s)
        t = now()
        if t - due > self.latest_s:
            self.latest_s = t - due
        if t - due > LATE_S * self.speed and self.can.taken:
            self._report_late((t - due) / self.speed, t)
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

    def _report_late(self, late_s: float, t: float) -> None:
        """Let a drive report that its machine was late, as a device reports an overrun."""
        if late_s > STARVED_S:
            self.starved_s.append(late_s)
        drive = next((drive for drive in self.rig.axes.values() if drive.io is not None), None)
        if drive is not None:
            milliseconds = min(round(1e3 * late_s), 0xFFFF).to_bytes(2, "little")
            frame = encode_emergency(o.MACHINE_LATE, 0, milliseconds + o.MACHINE_LATE_MARK)
            self.rig.can.transmit(o.EMERGENCY_BASE + drive.node_id, frame, t)

    def close(self) -> None:
        """Close every door."""
        for door in self._doors:
            door.close()

    def _due_s(self) -> float:
        """Return the time of the next turn, s."""
        due = self._step_due_s if self.life is None else min(self._step_due_s, self.life.due_s)
        # The rig takes no shorter step: a node's due time before its end waits until then.
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
