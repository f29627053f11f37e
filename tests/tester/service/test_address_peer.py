"""The peer of a connection, as recorded."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest

from tester.service.address import peer_text, with_peer


@pytest.mark.skipif(not hasattr(socket, "SO_PEERCRED"), reason="the system does not tell")
def test_on_a_unix_socket_it_is_the_user_id() -> None:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        assert peer_text(ours) == f"user id {os.getuid()}"


def test_an_unsupported_system_is_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(socket, "SO_PEERCRED", raising=False)
    ours, theirs = socket.socketpair()
    with ours, theirs:
        assert peer_text(ours) in ("user id not known", f"address 127.0.0.1:{port_of(theirs)}")


def port_of(one: socket.socket) -> int:
    name = one.getsockname()
    return int(name[1]) if isinstance(name, tuple) else 0


def test_behind_tcp_it_is_the_address() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server, socket.create_connection(server.getsockname()) as client:
        taken, _ = server.accept()
        with taken:
            assert peer_text(taken) == f"address 127.0.0.1:{client.getsockname()[1]}"


def test_a_gone_peer_is_unknown(tmp_path: Path) -> None:
    gone = socket.socket()
    gone.close()
    assert peer_text(gone) == "peer not known"


def test_a_name_without_a_peer_is_just_the_name() -> None:
    assert (with_peer("ada", ""), with_peer("ada", "user id 7")) == ("ada", "ada (user id 7)")
