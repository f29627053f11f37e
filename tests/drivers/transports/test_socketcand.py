"""python-can's socketcand client under our edge, against a server of a few lines."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from threading import Event, Thread

import pytest

from drivers.ports import BusLost
from drivers.transports.can_bus import PythonCanPort, open_can
from drivers.transports.socketcand import settings_of


class Server:
    """Does the handshake with the last client: the edge first checks that a server listens."""

    def __init__(self) -> None:
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.channel = f"vcan0@127.0.0.1:{self.listener.getsockname()[1]}"
        self.connected = Event()
        self.connection: socket.socket | None = None
        Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        while self.connection is None:
            accepted, _ = self.listener.accept()
            accepted.sendall(b"< hi >")
            try:
                if not accepted.recv(100):
                    continue
            except ConnectionError:
                continue
            accepted.sendall(b"< ok >")
            accepted.recv(100)
            accepted.sendall(b"< ok >")
            self.connection = accepted
        self.connected.set()

    def peer(self) -> socket.socket:
        assert self.connected.wait(2.0)
        assert self.connection is not None
        return self.connection


@pytest.fixture
def server() -> Iterator[Server]:
    server = Server()
    yield server
    server.listener.close()
    if server.connection is not None:
        server.connection.close()


def open_port(server: Server, urgent: Event) -> PythonCanPort:
    return open_can("socketcand", server.channel, 500_000, lambda: 1.0, urgent.set)


def test_frames_go_both_ways(server: Server) -> None:
    urgent = Event()
    port = open_port(server, urgent)
    port.send(0x080, b"", 0.0)
    port.send(0x201, b"\x0f\x00", 0.0)
    text = b""
    while text.count(b">") < 3:
        text += server.peer().recv(100)
    assert b"".join(text.split()).endswith(b"><send0800><send2012f0>")
    server.peer().sendall(b"< frame 081 1.5 3081200000000000 >")
    assert urgent.wait(2.0)
    assert port.receive(1.0) == [(1.0, 0x081, bytes.fromhex("3081200000000000"))]
    port.close()


def test_the_end_of_the_stream_is_a_lost_bus(server: Server) -> None:
    urgent = Event()
    port = open_port(server, urgent)
    server.peer().close()
    assert urgent.wait(2.0)
    with pytest.raises(BusLost, match="closed"):
        port.receive(1.0)
    port.close()


def test_a_server_that_refuses_is_a_lost_bus() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def turn_away() -> None:
            accepted, _ = listener.accept()
            accepted.sendall(b"< error another program is connected >")
            accepted.close()

        Thread(target=turn_away, daemon=True).start()
        with pytest.raises(BusLost, match="another program"):
            open_can("socketcand", f"vcan0@127.0.0.1:{listener.getsockname()[1]}", 500_000)


def test_a_missing_server_is_reported_at_once() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
    with pytest.raises(BusLost, match=f"vcan0@127.0.0.1:{port}"):
        open_can("socketcand", f"vcan0@127.0.0.1:{port}", 500_000)


@pytest.mark.parametrize("channel", ["vcan0", "vcan0@host", "vcan0@:29536", "@host:1", "vcan0@host:http"])
def test_a_channel_without_an_address_names_the_expected_form(channel: str) -> None:
    with pytest.raises(ValueError, match="bus@host:port"):
        settings_of(channel)


def test_a_silent_server_is_a_lost_bus(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("drivers.transports.socketcand.CONNECT_S", 0.05)
    with (
        socket.create_server(("127.0.0.1", 0)) as listener,
        pytest.raises(BusLost, match="timed out"),
    ):
        open_can("socketcand", f"vcan0@127.0.0.1:{listener.getsockname()[1]}", 500_000)
