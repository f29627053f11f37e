"""The TCP edge: bytes through, nothing blocks, every failure is BusLost."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from select import select

import pytest

from drivers.ports import BusLost
from drivers.transports.tcp_line import REOPEN_S, TcpLine, open_tcp_line

PATIENCE_S = 5.0
"""Bound of every wait for the kernel."""


@pytest.fixture
def ends() -> Iterator[tuple[TcpLine, socket.socket]]:
    """Give an open line and the socket at its other end."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        line = open_tcp_line("127.0.0.1", listener.getsockname()[1])
        peer, _ = listener.accept()
        with peer:
            peer.settimeout(PATIENCE_S)
            yield line, peer
        line.close()


def test_written_bytes_arrive(ends: tuple[TcpLine, socket.socket]) -> None:
    line, peer = ends
    line.write(b"abc", 0.0)
    assert peer.recv(10) == b"abc"


def test_received_bytes_are_stamped_with_the_time_of_the_read(ends: tuple[TcpLine, socket.socket]) -> None:
    line, peer = ends
    peer.sendall(b"abc")
    assert select([line], [], [], PATIENCE_S)[0]
    assert line.read(12.5) == [(12.5, b"abc")]


def test_reading_nothing_does_not_block(ends: tuple[TcpLine, socket.socket]) -> None:
    line, _ = ends
    assert line.read(0.0) == []


def test_a_closed_connection_is_bus_lost(ends: tuple[TcpLine, socket.socket]) -> None:
    line, peer = ends
    peer.close()
    assert select([line], [], [], PATIENCE_S)[0]
    with pytest.raises(BusLost, match="closed by the other side"):
        line.read(0.0)


def test_a_reset_connection_is_bus_lost(ends: tuple[TcpLine, socket.socket]) -> None:
    line, peer = ends
    # Linger of 0 s: closing sends a reset.
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\x01\x00\x00\x00\x00\x00\x00\x00")
    peer.close()
    assert select([line], [], [], PATIENCE_S)[0]
    with pytest.raises(BusLost):
        line.read(0.0)


def test_bytes_that_the_kernel_refuses_are_sent_later(ends: tuple[TcpLine, socket.socket]) -> None:
    line, peer = ends
    size = 16_000_000
    line.write(bytes(size), 0.0)
    got = 0
    while got < size:
        got += len(peer.recv(1 << 20))
        line.read(0.0)
    assert got == size


def test_a_connection_begun_anew_has_nothing_of_the_old_one() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        line = open_tcp_line("127.0.0.1", listener.getsockname()[1])
        old, _ = listener.accept()
        old.sendall(b"late")
        line.renew(0.0)
        line.write(b"asked", 0.0)
        peer, _ = listener.accept()
        peer.settimeout(PATIENCE_S)
        for _ in range(1000):
            line.read(0.0)
            if select([peer], [], [], 0.005)[0]:
                break
        assert peer.recv(10) == b"asked"
        peer.sendall(b"new")
        assert select([line], [], [], PATIENCE_S)[0]
        assert line.read(1.0) == [(1.0, b"new")]
        assert line.renewed == 1
        for one in (old, peer):
            one.close()
        line.close()


def test_a_connection_that_does_not_come_back_in_time_is_bus_lost() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        line = open_tcp_line("127.0.0.1", listener.getsockname()[1])
    line.renew(0.0)
    line.renew(REOPEN_S - 0.01)  # requested again before it is there: the time still counts from the first request
    assert line.read(REOPEN_S - 0.01) == []
    with pytest.raises(BusLost, match="no connection within 500 ms"):
        line.read(REOPEN_S)
    line.close()


def test_a_missing_server_is_bus_lost() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
    with pytest.raises(BusLost, match=f"127.0.0.1:{port}"):
        open_tcp_line("127.0.0.1", port)
