"""The pages' common side: one link to the service, whose messages go to every page, and the pages that have entered.

No page delays another one or the link: each has its own queue of answers and events, and only the newest state.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from tester.page.front import to_front
from tester.page.visitor import Visitor
from tester.service.address import Address
from tester.service.client import Client, Link, Lost
from tester.service.protocol import VERSION, Event, Hello, ServerMessage, Snapshot, encode
from tester.service.state_view import RunView

NAME = "page"
"""Name of the page process at the service; what a page commands is sent under the page's own name."""


class Hub:
    """The entered pages, and what the service sends them."""

    def __init__(self, address: Address | None) -> None:
        """``address`` of the service, None = the user's own."""
        self.address = address
        self.link = Link(address, name=NAME)
        self.visitors: list[Visitor] = []
        self._hello: Hello | None = None
        self._lost = "not connected yet"
        self.running = ""
        """Name of the run under way, "" for none."""
        self.run_ended: Callable[[str], None] = lambda _: None
        """Called with the name of a run that has ended."""

    async def relay(self) -> None:
        """Send the service's messages to the pages, without end."""
        async for message in self.link.messages():
            self.take(message)

    def take(self, message: ServerMessage | Lost) -> None:
        """Send one message of the link to every page."""
        if isinstance(message, Lost):
            self._lost = message.reason or "the connection is lost"
            self._hello = None
            for visitor in self.visitors:
                visitor.outbox.reply(self._link())
            return
        if isinstance(message, Hello):
            self._lost, self._hello = "", message
            self._look_for_an_end(message.state.run)
            for visitor in self.visitors:
                self._greet(visitor)
            return
        wrapped = self._wrapped(message)
        if isinstance(message, Snapshot):
            self._look_for_an_end(message.state.run)
        if isinstance(message, Event):
            for visitor in self.visitors:
                if message.seq > visitor.seen:
                    visitor.seen = message.seq
                    visitor.outbox.event(wrapped)
        elif message.type == "machine":
            for visitor in self.visitors:
                visitor.outbox.reply(wrapped)
        else:
            for visitor in self.visitors:
                visitor.outbox.newest(message.type, wrapped)

    def _look_for_an_end(self, run: RunView | None) -> None:
        name = run.name if run is not None and run.exit is None and run.folder else ""
        if self.running and name != self.running:
            self.run_ended(self.running)
        self.running = name

    def enter(self, visitor: Visitor) -> None:
        """Add a page, and send it the present state."""
        self.visitors.append(visitor)
        self._greet(visitor)

    def leave(self, visitor: Visitor) -> None:
        """Remove a page."""
        if visitor in self.visitors:
            self.visitors.remove(visitor)

    def of_pairing(self, number: int) -> Iterator[Visitor]:
        """Yield the open pages of a pairing."""
        return (visitor for visitor in list(self.visitors) if visitor.pairing.number == number)

    def _greet(self, visitor: Visitor) -> None:
        visitor.outbox.reply(self._link())
        client = self.link.client
        if self._hello is not None and client is not None:
            hello = present(self._hello, client)
            visitor.seen = hello.events[-1].seq if hello.events else 0
            visitor.outbox.reply(self._wrapped(hello))

    def _link(self) -> bytes:
        return to_front("link", connected=not self._lost, reason=self._lost)

    def _wrapped(self, message: ServerMessage) -> bytes:
        return b'{"type":"service","message":%b}' % encode(message)


def present(hello: Hello, client: Client) -> Hello:
    """Return a hello with everything that the service has sent since."""
    return replace(
        hello, version=VERSION, machine=client.machine, state=client.state, plan=client.plan,
        events=tuple(client.events), complete=client.complete, trend=tuple(client.trend), queue=client.queue,
        results=client.results,
    )  # fmt: skip
