"""The simulated rig alive in real time, with its doors open.

One thread, one loop: it sleeps in ``select`` until a client sends something, a frame has arrived on a simulated wire,
a node has something due or the next step of the plant is. Clients come and go; the rig lives on.
"""

from __future__ import annotations

import select
import socket
from collections.abc import Callable
from math import inf
from typing import Protocol

from drivers.ports import BusLost
from sim.rig import SHORTEST_STEP_S, SimRig
from sim.servers.connection import Connection, listen
from sim.servers.modbus_tcp import ModbusGateway, ModbusSession
from sim.servers.socketcand import BUSY, SocketcandSession
from sim.wires.modbus_wire import ModbusWire

STEP_S = 0.01
"""The rig is advanced this often at least, s, and shown to the observer."""
MOST_CLIENTS = 8
"""Connections of one Modbus line [A]."""
Address = tuple[str, int]


class Observer(Protocol):
    """Whoever wants to see the rig every ``STEP_S``."""

    def observe(self, rig: SimRig, controlled: bool) -> None:
        """Take note of the rig as it is; ``controlled``: a program is on its CAN bus."""
        ...


class CanDoor:
    """The CAN bus behind socketcand's protocol; one client at a time."""

    def __init__(self, rig: SimRig, listener: socket.socket) -> None:
        """Wait for a client."""
        self.listener = listener
        self.connection: Connection | None = None
        self._wire = rig.can
        self._session = SocketcandSession()

    @property
    def due_s(self) -> float:
        """When the next frame for the client arrives, s."""
        return inf if self.connection is None else self._wire.arrives_s

    def accept(self) -> None:
        """Let a client in, or turn it away where another one is connected."""
        try:
            accepted, _ = self.listener.accept()
        except OSError:
            return  # it has thought better of it
        connection = Connection(accepted)
        if self.connection is None:
            self.connection, self._session = connection, SocketcandSession()
            connection.send(self._session.outgoing)
        else:
            connection.send(bytearray(BUSY))
            connection.close()

    def read(self, now: float) -> None:
        """Put what the client sent on the bus."""
        connection, session = self.connection, self._session
        if connection is None:
            return
        data = connection.receive()
        try:
            for can_id, payload in session.feed(data, now):
                self._wire.send(can_id, payload, now)
        except BusLost:
            session.ended = "the adapter is disconnected"
        if connection.gone or session.ended:
            self.close_client()

    def deliver(self, now: float) -> None:
        """Send the client what has arrived; without one, frames pass unseen."""
        connection, session = self.connection, self._session
        try:
            frames = self._wire.receive(now)
        except BusLost:
            self.close_client()
            return
        if connection is None:
            return
        if frames:
            session.relay(frames, now)
        connection.send(session.outgoing)
        if connection.gone:
            self.close_client()

    def close_client(self) -> None:
        """Let go of the client."""
        if self.connection is not None:
            self.connection.close()
            self.connection = None


class LineDoor:
    """One Modbus line behind Modbus TCP."""

    def __init__(self, wire: ModbusWire, listener: socket.socket) -> None:
        """Wait for clients."""
        self.listener = listener
        self.gateway = ModbusGateway(wire)
        self.clients: dict[socket.socket, tuple[Connection, ModbusSession]] = {}

    def accept(self) -> None:
        """Let a client in; beyond the most it is closed at once."""
        try:
            accepted, _ = self.listener.accept()
        except OSError:
            return
        connection = Connection(accepted)
        if len(self.clients) >= MOST_CLIENTS:
            connection.close()
        else:
            self.clients[accepted] = (connection, ModbusSession())

    def read(self, client: socket.socket, now: float) -> None:
        """Take a client's requests."""
        connection, session = self.clients[client]
        self.gateway.take(session, connection.receive(), now)
        if session.ended:
            connection.gone = True

    def deliver(self, now: float) -> None:
        """Send replies that have arrived, and forget clients that are gone."""
        self.gateway.serve(now)
        for client, (connection, session) in tuple(self.clients.items()):
            if session.outgoing:
                connection.send(session.outgoing)
            if connection.gone:
                self.gateway.forget(session)
                connection.close()
                del self.clients[client]

    def close(self) -> None:
        """Let go of every client."""
        for connection, _ in self.clients.values():
            connection.close()
        self.clients.clear()


class RigServer:
    """A simulated rig in real time behind sockets.

    ``can_address`` and ``line_addresses`` are where it listens; ``latest_s`` is how late the loop has come to something
    at most, s: more than some milliseconds means that this machine cannot keep the rig's time.
    """

    def __init__(self, rig: SimRig, host: str, port: int, observer: Observer | None = None) -> None:
        """Listen: CAN on ``port``, the lines in their order on the ports after it; 0 = any free ones.

        Raises OSError where a port cannot be had.
        """
        self.rig = rig
        self.latest_s = 0.0
        self._observer = observer
        self._listeners = _listen_all(host, port, 1 + len(rig.lines))
        can, *lines = self._listeners
        self.can = CanDoor(rig, can)
        self.lines = {
            name: LineDoor(wire, listener)
            for (name, wire), listener in zip(rig.lines.items(), lines, strict=True)
        }
        self._step_due_s = 0.0

    @property
    def can_address(self) -> Address:
        """Where the CAN bus is."""
        return _address(self.can.listener)

    @property
    def line_addresses(self) -> dict[str, Address]:
        """Where each Modbus line is."""
        return {name: _address(door.listener) for name, door in self.lines.items()}

    def serve(self, now: Callable[[], float], stopped: Callable[[], bool]) -> None:
        """Let the rig live by the clock ``now`` (s, from 0) until ``stopped``, which is asked every step."""
        self._step_due_s = now()
        while not stopped():
            self.turn(now)

    def turn(self, now: Callable[[], float]) -> None:
        """Sleep until something is to be done, and do it."""
        due = self._due_s()
        ready, _, _ = select.select(self._sockets(), (), (), max(0.0, due - now()))
        t = now()
        if t - due > self.latest_s:
            self.latest_s = t - due
        self.rig.advance(t)
        self._read(ready, t)
        self.can.deliver(t)
        for door in self.lines.values():
            door.deliver(t)
        if t >= self._step_due_s:
            if self._observer is not None:
                self._observer.observe(self.rig, self.can.connection is not None)
            while self._step_due_s <= t:
                self._step_due_s += STEP_S

    def close(self) -> None:
        """Shut every door."""
        for listener in self._listeners:
            listener.close()
        self.can.close_client()
        for door in self.lines.values():
            door.close()

    def _sockets(self) -> list[socket.socket]:
        sockets = list(self._listeners)
        if self.can.connection is not None:
            sockets.append(self.can.connection.socket)
        for door in self.lines.values():
            sockets.extend(door.clients)
        return sockets

    def _due_s(self) -> float:
        """Return when the loop must turn next, s."""
        due = self._step_due_s
        # The rig takes no step shorter than this: what a node has due before it waits as long.
        soonest = self.rig.now_s + SHORTEST_STEP_S
        for drive in self.rig.axes.values():
            if drive.due_s < due:
                due = max(drive.due_s, soonest)
        for node in self.rig.nodes:
            if node.due_s < due:
                due = max(node.due_s, soonest)
        due = min(due, self.can.due_s)
        for door in self.lines.values():
            due = min(due, door.gateway.due_s)
        return due

    def _read(self, ready: list[socket.socket], t: float) -> None:
        """Serve the sockets that have something: clients before those who want to become one."""
        waiting = set(ready)
        if self.can.connection is not None and self.can.connection.socket in waiting:
            self.can.read(t)
        for door in self.lines.values():
            for client in [one for one in door.clients if one in waiting]:
                door.read(client, t)
        if self.can.listener in waiting:
            self.can.accept()
        for door in self.lines.values():
            if door.listener in waiting:
                door.accept()


def _listen_all(host: str, port: int, count: int) -> list[socket.socket]:
    """Listen on ``count`` ports from ``port`` on (0 = any free ones): on all of them or on none."""
    listeners: list[socket.socket] = []
    try:
        for number in range(count):
            listeners.append(listen(host, port + number if port else 0))
    except OSError:
        for listener in listeners:
            listener.close()
        raise
    return listeners


def _address(listener: socket.socket) -> Address:
    host, port = listener.getsockname()[:2]
    return str(host), int(port)
