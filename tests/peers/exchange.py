"""Our Modbus link on a TCP connection to a third-party server."""

from __future__ import annotations

from collections.abc import Callable
from select import select

from drivers.modbus import ModbusLink
from drivers.transports.tcp_line import TcpLine

PATIENCE_S = 10.0
"""Bound of every wait for the server's threads."""


class Exchange:
    """Our link on a connection. Its time is counted: a millisecond for each answer, whatever the server takes."""

    def __init__(self, line: TcpLine) -> None:
        self.line = line
        self.link = ModbusLink("socket")
        self.now = 0.0

    def until(self, done: Callable[[], bool], transactions: int = 50) -> None:
        """Serve the link until ``done``; fails after so many transactions or when the server stays silent."""
        for _ in range(transactions):
            self.link.service(self.line, self.now)
            if done():
                return
            assert select([self.line], [], [], PATIENCE_S)[0], "the server is silent"
            self.now += 0.001
            self.link.feed(self.line.read(self.now), self.now)
            self.now = max(self.now, min(self.link.deadline, self.now + 0.2))
        raise AssertionError(f"not reached within {transactions} transactions")
