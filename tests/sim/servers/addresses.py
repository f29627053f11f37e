"""Where the TCP doors of a rig server are."""

from __future__ import annotations

from sim.servers.server import RigServer
from sim.servers.tcp_doors import GatewayDoor, SocketcandDoor

Address = tuple[str, int]


def can_address(server: RigServer) -> Address:
    """Return host and port of the CAN bus behind its TCP door."""
    assert isinstance(server.can, SocketcandDoor)
    return server.can.listener.getsockname()


def line_addresses(server: RigServer) -> dict[str, Address]:
    """Return host and port of each Modbus line with a TCP door."""
    return {name: door.listener.getsockname() for name, door in server.lines.items() if isinstance(door, GatewayDoor)}
