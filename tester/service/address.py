"""Addresses of the service: a Unix socket of one user, or loopback TCP with a token on systems without Unix sockets.

Both use a folder that only the user may enter. A TCP service writes its address and token to ``service.json`` there
(mode 0600), so that a client finds either kind of service in the same place.
"""

from __future__ import annotations

import json
import os
import secrets
import socket
import stat
import struct
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from tester.base.trouble import MisuseError

HAS_UNIX = hasattr(socket, "AF_UNIX") and os.name == "posix"
SOCKET = "service.sock"
CARD = "service.json"
CREDENTIALS = struct.Struct("iII")
"""struct ucred of Linux: pid, uid, gid."""


STOP_SUFFIX = ".stop"
"""Suffix of the socket for STOP, in the same folder as the service's socket."""


class AddressError(MisuseError):
    """The address is not usable; the message gives the reason."""


@dataclass(frozen=True, slots=True)
class UnixAddress:
    """A Unix socket in the file system."""

    path: Path

    def __str__(self) -> str:
        """Return the form that ``--connect`` accepts."""
        return f"unix:{self.path}"


@dataclass(frozen=True, slots=True)
class TcpAddress:
    """A loopback port and the token that a client must send."""

    host: str
    port: int
    token: str
    stop_port: int = 0
    """Port for STOP; 0 while unknown."""

    def __str__(self) -> str:
        """Return the address without its token."""
        return f"ws://{self.host}:{self.port}"


Address = UnixAddress | TcpAddress


def folder() -> Path:
    """Return the folder of the user's service, creating it (0700) if needed.

    It is ``TESTER_RUNTIME_DIR``, else ``XDG_RUNTIME_DIR/friction-tester``, else the user's own folder in the temporary
    one. Raises AddressError if it belongs to another user or others may enter it.
    """
    chosen = os.environ.get("TESTER_RUNTIME_DIR")
    base = os.environ.get("XDG_RUNTIME_DIR")
    if chosen:
        path = Path(chosen)
    elif base:
        path = Path(base) / "friction-tester"
    else:
        path = Path(tempfile.gettempdir()) / f"friction-tester-{os.getuid() if HAS_UNIX else os.getlogin()}"
    path.mkdir(mode=0o700, parents=True, exist_ok=True)
    if HAS_UNIX:
        status = path.stat()
        if status.st_uid != os.getuid() or status.st_mode & 0o077:
            raise AddressError(f"{path} belongs to another user, or others may enter it (expected mode 0700)")
    return path


def default_address(where: Path | None = None) -> Address:
    """Return the address of the user's service, whether it runs or not."""
    where = where or folder()
    if HAS_UNIX and not (where / CARD).exists():
        return UnixAddress(where / SOCKET)
    return read_card(where / CARD)


def address_of(text: str) -> Address:
    """Return the address in a text: ``unix:PATH``, a path, or ``ws://HOST:PORT`` (the token is read from the card)."""
    if text.startswith("ws://"):
        card = read_card(folder() / CARD)
        host, _, port = text.removeprefix("ws://").rstrip("/").rpartition(":")
        if not port.isdigit():
            raise AddressError(f"{text}: expected ws://HOST:PORT")
        return TcpAddress(host, int(port), card.token, card.stop_port)
    return UnixAddress(Path(text.removeprefix("unix:")))


def new_tcp_address(port: int = 0) -> TcpAddress:
    """Return a loopback address with a fresh token; port 0 = any free port."""
    return TcpAddress("127.0.0.1", port, secrets.token_urlsafe(32))


def write_card(address: TcpAddress, path: Path) -> None:
    """Write the card: address and token for the user's clients (mode 0600), atomically."""
    part = path.with_name(f"{path.name}.part")
    part.unlink(missing_ok=True)
    descriptor = os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    with os.fdopen(descriptor, "w", encoding="utf-8") as file:
        card = {"host": address.host, "port": address.port, "token": address.token, "stop_port": address.stop_port}
        json.dump(card, file)
    part.replace(path)


def read_card(path: Path) -> TcpAddress:
    """Read address and token from the card. Raises AddressError."""
    try:
        card: object = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise AddressError(f"no service has left its address here: {path}") from error
    match card:
        case {"host": str(host), "port": int(port), "token": str(token), "stop_port": int(stop_port)}:
            return TcpAddress(host, port, token, stop_port)
        case _:
            raise AddressError(f"{path} is not the card of a service")


def stop_path(service: Path) -> Path:
    """Return the path of the socket for STOP that belongs to a service's socket."""
    return service.with_name(service.name + STOP_SUFFIX)


def unlink_socket(path: Path) -> None:
    """Remove a socket that an earlier service left. Raises AddressError for any other file."""
    try:
        status = path.lstat()
    except FileNotFoundError:
        return
    if not stat.S_ISSOCK(status.st_mode):
        raise AddressError(f"{path} exists and is not a socket: it is not replaced")
    path.unlink(missing_ok=True)


def peer_of(connection: socket.socket) -> tuple[int, int | None]:
    """Return process id and user id at the other end of a Unix socket; 0 and None where the system does not report
    them.

    Linux: SO_PEERCRED (unix(7)), three ints pid, uid, gid. Elsewhere the modes of folder and socket protect.
    """
    option = cast("int | None", getattr(socket, "SO_PEERCRED", None))
    if option is None or connection.family != getattr(socket, "AF_UNIX", None):
        return 0, None
    raw = connection.getsockopt(socket.SOL_SOCKET, option, CREDENTIALS.size)
    pid, uid, _ = CREDENTIALS.unpack(raw)
    return int(pid), int(uid)


def peer_text(connection: socket.socket) -> str:
    """Return a name of the other end for the record: the user id on a Unix socket, else the address.

    Never raises: for an unknown peer, or one that has disconnected, the text reports that.
    """
    try:
        if connection.family == getattr(socket, "AF_UNIX", None):
            user = peer_of(connection)[1]
            return f"user id {user}" if user is not None else "user id not known"
        host, port = connection.getpeername()[:2]
    except (OSError, ValueError):
        return "peer not known"
    return f"address {host}:{port}"


def with_peer(name: str, peer: str) -> str:
    """Return a client's name followed by its peer."""
    return f"{name} ({peer})" if peer else name
