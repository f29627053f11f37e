"""Doors behind sockets: socketcand for the CAN bus, Modbus TCP for a line."""

from __future__ import annotations

import socket
from collections.abc import Collection, Sequence
from math import inf
from typing import Final

from drivers.ports import BusLost
from sim.servers.connection import ClientsDoor, Connection, accepted
from sim.servers.doors import Place, Readable
from sim.servers.modbus_tcp import ModbusGateway, ModbusSession
from sim.servers.socketcand import BUSY, SocketcandSession
from sim.wires.can_wire import CanWire
from sim.wires.modbus_wire import ModbusWire

MOST_CLIENTS = 8
"""Connections of one Modbus line [A]."""
SOCKETCAND: Final = "socketcand"
GATEWAY: Final = "Modbus TCP"
BUS: Final = "vcan0"
"""Name of the bus that clients should open; the door takes any."""


class SocketcandDoor:
    """The CAN bus behind socketcand's protocol; one client at a time."""

    def __init__(self, wire: CanWire, listener: socket.socket) -> None:
        """Wait for a client."""
        self.listener = listener
        self.connection: Connection | None = None
        self._wire = wire
        self._session = SocketcandSession()

    @property
    def place(self) -> Place:
        """Its address: bus@host:port."""
        return Place(SOCKETCAND, f"{BUS}@{address_of(self.listener)}")

    @property
    def taken(self) -> bool:
        """Whether a client is connected."""
        return self.connection is not None

    @property
    def due_s(self) -> float:
        """Arrival of the next frame for the client, s."""
        return inf if self.connection is None else self._wire.arrives_s

    def sources(self) -> Sequence[Readable]:
        """Return the listener and the client."""
        return [self.listener] if self.connection is None else [self.connection.socket, self.listener]

    def read(self, ready: Collection[Readable], now: float) -> None:
        """Serve the client, then new connections."""
        if self.connection is not None and self.connection.socket in ready:
            self._take(now)
        if self.listener in ready:
            self._accept()

    def _accept(self) -> None:
        """Accept a client, or reject it if another one is connected."""
        connection = accepted(self.listener)
        if connection is None:
            return
        if self.connection is None:
            self.connection, self._session = connection, SocketcandSession()
            connection.send(self._session.outgoing)
        else:
            connection.send(bytearray(BUSY))
            connection.close()

    def _take(self, now: float) -> None:
        """Put the client's frames on the bus."""
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
            self._close_client()

    def deliver(self, now: float) -> None:
        """Send the client the frames that have arrived; without a client they are dropped."""
        connection, session = self.connection, self._session
        try:
            frames = self._wire.receive(now)
        except BusLost:
            self._close_client()
            return
        if connection is None:
            return
        if frames:
            session.relay(frames, now)
        connection.send(session.outgoing)
        if connection.gone:
            self._close_client()

    def _close_client(self) -> None:
        if self.connection is not None:
            self.connection.close()
            self.connection = None

    def close(self) -> None:
        """Close it."""
        self.listener.close()
        self._close_client()


class GatewayDoor(ClientsDoor[ModbusSession]):
    """One Modbus line behind Modbus TCP."""

    def __init__(self, wire: ModbusWire, listener: socket.socket) -> None:
        """Wait for clients."""
        super().__init__(listener, MOST_CLIENTS, ModbusSession)
        self.gateway = ModbusGateway(wire)

    @property
    def place(self) -> Place:
        """Its address: host:port."""
        return Place(GATEWAY, address_of(self.listener))

    @property
    def due_s(self) -> float:
        """Time when the gateway has work, s."""
        return self.gateway.due_s

    def serve(self, connection: Connection, session: ModbusSession, now: float) -> None:
        self.gateway.take(session, connection.receive(), now)
        if session.ended:
            connection.gone = True

    def deliver(self, now: float) -> None:
        """Send replies that have arrived, and forget clients that are gone."""
        self.gateway.serve(now)
        super().deliver(now)

    def outgoing(self, session: ModbusSession) -> bytearray:
        return session.outgoing

    def left(self, session: ModbusSession, now: float) -> None:
        self.gateway.forget(session)
        self.gateway.serve(now)  # it may have held the line


def address_of(listener: socket.socket) -> str:
    """Return the address of a listener, as host:port."""
    host, port = listener.getsockname()[:2]
    return f"{host}:{port}"
