"""The clients that have joined, and which of them controls the rig."""

from __future__ import annotations

import asyncio
import re
from dataclasses import dataclass, field

from websockets.asyncio.server import ServerConnection

from tester.service.commands import TakeControl
from tester.service.manners import Bucket
from tester.service.outbox import Outbox
from tester.service.service_link import GatewayEnd, Presence

AT_REST = frozenset({"OFFLINE", "INTERRUPTED"})
"""Modes in which there is no run and no manual mode."""
_MODE = re.compile(rb'\{"mode":"([^"]*)"')
"""Pattern of the start of an encoded state."""


@dataclass(slots=True, eq=False)
class Guest:
    """One client: its connection, its number and its pending messages."""

    connection: ServerConnection
    number: int
    name: str
    peer: str
    """The client's user or address, as the operating system reports it."""
    asked: bool = False
    """Whether the client requested control in its ``join``."""
    outbox: Outbox = field(default_factory=Outbox)
    frames: bool = False
    leaving: asyncio.Task[None] | None = None
    """The task that closes the connection of a client that fell behind."""
    bucket: Bucket = field(default_factory=Bucket)
    questions: int = 0
    """Number of the client's questions that are being answered."""


class Guests(dict[int, Guest]):
    """The clients by number. One of them, the controller, may send every command; the owner receives each change."""

    def __init__(self, owner: GatewayEnd) -> None:
        """Begin without clients."""
        super().__init__()
        self.controller = 0
        """Number of the client that has control; 0 if none has."""
        self._owner = owner
        self._lender = 0
        """Number of the client that had control before another borrowed it on an idle rig; control returns to it."""
        self._mode = ""
        """The rig's mode in the newest state, "" while unknown."""
        self._signs = 0

    @property
    def holder(self) -> Guest | None:
        """The client that has control."""
        return self.get(self.controller)

    def take_state(self, state: bytes) -> None:
        """Read the rig's mode from an encoded state."""
        match = _MODE.match(state)
        self._mode = match.group(1).decode() if match is not None else ""

    def forget_mode(self) -> None:
        """Forget the mode, which an order may change: it is unknown until the next state."""
        self._mode = ""

    def newest(self, kind: str, message: bytes) -> None:
        """Send a message of which only the newest counts to every client, frames to those that watch them."""
        for guest in self.values():
            if kind != "frames" or guest.frames:
                guest.outbox.newest(kind, message)

    async def sent(self) -> None:
        """Wait until every pending message is sent."""
        while any(len(guest.outbox) for guest in self.values()):
            await asyncio.sleep(0.01)

    def join(self, guest: Guest) -> None:
        """Add a client."""
        self[guest.number] = guest
        self.tell()

    def leave(self, guest: Guest) -> None:
        """Remove a client; control that it borrowed returns to the lender."""
        del self[guest.number]
        if self.controller == guest.number:
            self.controller = self._lender if self._lender in self else 0
            self._lender = 0
        self.tell()

    def refusal(self, guest: Guest) -> str:
        """Return why a client may not command the rig; "" if it may.

        A client that requested control in its ``join`` may borrow it while connected, but only on an idle rig (no run,
        no manual mode), where a command cannot disturb the present controller.
        """
        if self.controller == guest.number:
            return ""
        if guest.asked and self._mode in AT_REST:
            self._lender = self._lender or self.controller
            self.controller = guest.number
            self.tell()
            return ""
        holder = self.holder
        return f"{holder.name} has control" if holder is not None else "no client has control: take it first"

    def change(self, guest: Guest, action: TakeControl) -> str:
        """Give a client control, or take it from the client; return "" or the reason for refusing."""
        self._lender = 0
        holder = self.holder
        if action.take:
            if holder is not None and holder is not guest and not action.force:
                return f"{holder.name} has control"
            self.controller = guest.number
        elif self.controller == guest.number:
            self.controller = 0
        self.tell()
        return ""

    def sign(self, guest: Guest) -> None:
        """Forward the controller's sign of life to the owner; ignore those of other clients."""
        if self.controller == guest.number:
            self._signs += 1
            self.tell()

    def tell(self) -> None:
        """Report to the owner which clients are connected and which has control."""
        holder = self.holder
        frames = any(guest.frames for guest in self.values())
        name, peer = (holder.name, holder.peer) if holder is not None else ("", "")
        viewers = len(self) - (holder is not None)
        self._owner.presence(Presence(name, self.controller, viewers, frames, self._signs, peer))
