"""What the machine's screen asks of the page process: who is paired, which codes are shown; a new code, an end.

One request and one answer, each a line of JSON, over a Unix socket of the user (mode 0600, beside the service's). On
systems without Unix sockets it is loopback, and the first line is the token of a file that only the user can read.
"""

from __future__ import annotations

import socket
from dataclasses import dataclass
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, TypeAdapter, ValidationError

from tester.base.trouble import in_words
from tester.page.roles import Role
from tester.service.address import (
    HAS_UNIX,
    Address,
    AddressError,
    TcpAddress,
    UnixAddress,
    folder,
    read_card,
)
from tester.service.commands import StrictMessage

SUFFIX = ".page"
"""Suffix of the socket, beside the service's."""
CARD = "page.json"
WITHIN_S = 1.0
"""Time for an answer, s."""
MOST = 100_000
"""Longest answer, bytes: 32 pairings with their names."""


@dataclass(frozen=True, slots=True)
class ShowDesk(StrictMessage):
    """Ask for the present state."""

    ask: Literal["show"] = "show"


@dataclass(frozen=True, slots=True)
class NewCode(StrictMessage):
    """Ask for a new code for a role."""

    role: Role
    ask: Literal["code"] = "code"


@dataclass(frozen=True, slots=True)
class Revoke(StrictMessage):
    """End a pairing; its pages are closed. 0: all pairings."""

    number: int
    ask: Literal["revoke"] = "revoke"


DeskRequest: TypeAlias = Annotated[ShowDesk | NewCode | Revoke, Field(discriminator="ask")]
REQUEST: TypeAdapter[DeskRequest] = TypeAdapter(DeskRequest)


@dataclass(frozen=True, slots=True)
class ShownCode:
    """A code on the machine's screen. ``page``: who asks, "" for a code that pairs; ``what``: the role, or the action
    in words.
    """

    digits: str
    page: str
    what: str
    left_s: float


@dataclass(frozen=True, slots=True)
class ShownPairing:
    """A pairing; ``pages``: number of its open pages."""

    number: int
    name: str
    role: Role
    expires_utc: str
    pages: int


@dataclass(frozen=True, slots=True)
class DeskView:
    """The state for the machine's screen. ``roles``: those that may be given."""

    address: str
    roles: tuple[Role, ...]
    code: ShownCode | None
    asked: tuple[ShownCode, ...]
    pairings: tuple[ShownPairing, ...]


VIEW: TypeAdapter[DeskView] = TypeAdapter(DeskView)


class NoPageError(Exception):
    """No page process answers; the message gives the reason."""


def desk_address(service: Address | None) -> UnixAddress | None:
    """Return the socket that belongs to a service (None = the user's own); None where there are no Unix sockets."""
    if not HAS_UNIX:
        return None
    if isinstance(service, UnixAddress):
        return UnixAddress(service.path.with_name(service.path.name + SUFFIX))
    return UnixAddress(folder() / f"service.sock{SUFFIX}")


def call_desk(service: Address | None, request: DeskRequest) -> DeskView:
    """Send a request to the page process of a service and return its answer. Blocks up to a second. Raises
    NoPageError.
    """
    try:
        with _connected(desk_address(service)) as connection:
            connection.settimeout(WITHIN_S)
            connection.sendall(REQUEST.dump_json(request) + b"\n")
            reply = b""
            while not reply.endswith(b"\n"):
                data = connection.recv(65536)
                if not data or len(reply) > MOST:
                    raise NoPageError("the page process has not answered")
                reply += data
        return VIEW.validate_json(reply)
    except (OSError, AddressError) as error:
        raise NoPageError(in_words(error)) from error
    except ValidationError:
        raise NoPageError("the page process is of another version") from None


def _connected(address: UnixAddress | None) -> socket.socket:
    if address is not None:
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            connection.settimeout(WITHIN_S)
            connection.connect(str(address.path))
        except OSError:
            connection.close()
            raise
        return connection
    card: TcpAddress = read_card(folder() / CARD)
    connection = socket.create_connection((card.host, card.port), timeout=WITHIN_S)
    connection.sendall(card.token.encode() + b"\n")
    return connection
