"""A client of the service, for screens and scripts.

    async with await Client.connect(control=True) as client:
        await client.command(RunRecipe("quickstart", speed=60.0, yes=True))
        async for message in client:
            if isinstance(message, Snapshot):
                print(message.state.mode, message.state.progress.title)

``Client`` is one connection. ``Link`` keeps a connection up: it reconnects after a loss and misses no event.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncIterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Literal, TypeAlias

from pydantic import JsonValue
from websockets.asyncio.client import ClientConnection, connect, unix_connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake

from tester.base import clock
from tester.base.screen import MachineView
from tester.base.trouble import in_words
from tester.queue.view import QueueView
from tester.service.address import Address, AddressError, UnixAddress, default_address
from tester.service.commands import Action, Attend, Command, Join, Stop
from tester.service.protocol import (
    EVENTS_KEPT,
    TREND_ROWS,
    Accepted,
    BadMessageError,
    Event,
    Frames,
    Goodbye,
    Hello,
    MachineMessage,
    PlanMessage,
    QueueMessage,
    Refused,
    ResultsMessage,
    ServerMessage,
    Snapshot,
    encode,
    from_server,
)
from tester.service.results_view import GivenResults
from tester.service.state_view import PlanView, StateView
from tester.service.stop_call import takes_stop

MAX_INCOMING = 64 * 1024 * 1024
"""Longest message from the service, bytes: a hello holds ten minutes of trend and two thousand events."""
CONNECT_S = 10.0
ANSWER_S = 30.0
"""A command without an answer after this time has failed, s; checking and planning may take seconds."""
AGAIN_S = 0.5
"""Time between two attempts to reconnect, s."""


class NoServiceError(Exception):
    """No service listens at the address, or it rejects this client; the message gives the reason."""


class RefusedError(Exception):
    """The service refused a command; the message is its reason."""


class LostError(Exception):
    """The connection has ended; the message gives the service's reason if it sent one."""


Newest: TypeAlias = Hello | Snapshot | PlanMessage | ResultsMessage | QueueMessage | MachineMessage | Frames
"""Messages of which only the newest counts."""
Gone: TypeAlias = Literal["", "ended", "died"]
"""How the service ended: unknown, on request, or without a request."""


@dataclass(frozen=True, slots=True)
class Lost:
    """A ``Link`` yields this when the connection breaks; it then tries to reconnect."""

    reason: str
    gone: Gone = ""


class Client:
    """One connection. ``state``, ``plan``, ``results``, ``queue``, ``events``, ``trend`` hold the newest data."""

    def __init__(self, connection: ClientConnection, hello: Hello) -> None:
        """Use ``Client.connect`` instead."""
        self._connection = connection
        self.service = hello.service
        self.number = hello.client
        self.state: StateView = hello.state
        self.plan: PlanView | None = hello.plan
        self.queue: QueueView | None = hello.queue
        self.results: GivenResults | None = hello.results
        self.events: deque[Event] = deque(hello.events, maxlen=EVENTS_KEPT)
        self.complete = hello.complete
        """Whether no event is missing between those seen before and ``events``."""
        self.trend: deque[tuple[float | None, ...]] = deque(hello.trend, maxlen=TREND_ROWS)
        self.machine: MachineView = hello.machine
        """Tables of the kind of rig; ``machine.trend`` names the columns of ``trend``."""
        self.received_s = clock.monotonic()
        """Time at which the newest state arrived (tester.base.clock.monotonic)."""
        self.lost = ""
        """Why the connection has ended; "" while it is open."""
        self.ended = False
        """Whether the service has announced that it ends on request."""
        self._goodbye = ""
        self._ids = 0
        self._sending: set[asyncio.Task[None]] = set()
        self._answers: dict[int, asyncio.Future[Accepted]] = {}
        self._events_due: deque[Event] = deque()
        self._newest: dict[type, Newest] = {Hello: hello}
        self._something = asyncio.Event()
        self._something.set()
        self._reading = asyncio.create_task(self._read())

    @classmethod
    async def connect(
        cls,
        address: Address | None = None,
        *,
        name: str = "client",
        control: bool = False,
        service: str = "",
        since: int = 0,
    ) -> Client:
        """Open a connection and introduce this client. Raises NoServiceError.

        ``control``: request control. ``service``, ``since``: the service and the last event that this client has seen
        (``Client.service`` and ``last_seq``); the service then sends every later event.
        """
        try:
            connection = await _open(address or default_address())
            await connection.send(encode(Join(name, control=control, service=service, since=since)), text=True)
            async with asyncio.timeout(CONNECT_S):
                first = from_server(await connection.recv())
        except (OSError, AddressError, InvalidHandshake, TimeoutError, BadMessageError) as error:
            why = in_words(error)
            raise NoServiceError(f"no service there: {why}") from error
        except ConnectionClosed as error:
            raise NoServiceError(f"the service hung up: {error}") from error
        if not isinstance(first, Hello):
            raise NoServiceError(first.reason if isinstance(first, Goodbye) else "no hello")
        return cls(connection, first)

    @property
    def controls(self) -> bool:
        """Whether this client has control."""
        return self.state.clients.controller_id == self.number

    @property
    def age_s(self) -> float:
        """Seconds since the newest state arrived; above 2 s no value is reliable."""
        return clock.monotonic() - self.received_s

    @property
    def last_seq(self) -> int:
        """Number of the newest event, 0 before the first."""
        return self.events[-1].seq if self.events else 0

    async def command(self, action: Action, *, within_s: float = ANSWER_S) -> JsonValue:
        """Send a command and return its result. Raises RefusedError, LostError, TimeoutError."""
        self._ids += 1
        number = self._ids  # other commands may raise the counter while this one waits
        answer: asyncio.Future[Accepted] = asyncio.get_running_loop().create_future()
        self._answers[number] = answer
        try:
            if self.lost:
                raise LostError(self.lost)
            async with asyncio.timeout(within_s):
                await self._connection.send(encode(Command(number, action)), text=True)
                return (await answer).result
        except ConnectionClosed as error:
            raise LostError(str(error)) from error
        finally:
            del self._answers[number]

    def attend(self) -> None:
        """Send a sign of life without waiting for the answer. Manual mode needs one a second from the controller."""
        self._ids += 1
        text = encode(Command(self._ids, Attend()))
        task = asyncio.create_task(self._send(text))
        self._sending.add(task)
        task.add_done_callback(self._sending.discard)

    async def _send(self, text: bytes) -> None:
        with suppress(ConnectionClosed):
            await self._connection.send(text, text=True)

    async def stop(self, *, fast: bool = False) -> None:
        """Send STOP. It works for every client, with or without control."""
        await self.command(Stop(fast))

    def __aiter__(self) -> AsyncIterator[ServerMessage]:
        """Yield messages as they arrive: ``hello`` first, every event, and the newest of each other type."""
        return self._messages()

    async def close(self) -> None:
        """Close the connection. A run continues."""
        await self._connection.close()
        await self._reading

    async def __aenter__(self) -> Client:
        return self

    async def __aexit__(self, *_: object) -> None:
        """Close the connection."""
        await self.close()

    # -- reading ----------------------------------------------------------------------------------------------

    async def _read(self) -> None:
        try:
            async for text in self._connection:
                with suppress(BadMessageError):  # skip an unknown message of a newer service
                    self._take(from_server(text))
            self._end(self._goodbye or "the service has closed the connection")
        except ConnectionClosed as error:
            self._end(self._goodbye or (error.rcvd.reason if error.rcvd is not None else "connection lost"))

    def _take(self, message: ServerMessage) -> None:
        if isinstance(message, Accepted | Refused):
            waiting = self._answers.get(message.id)
            if waiting is None or waiting.done():
                return
            if isinstance(message, Accepted):
                waiting.set_result(message)
            else:
                waiting.set_exception(RefusedError(message.reason))
            return
        if isinstance(message, Goodbye):
            self._goodbye, self.ended = message.reason, message.ended
            return
        if isinstance(message, Event):
            self.events.append(message)
            self._events_due.append(message)
        else:
            if isinstance(message, Snapshot):
                self.state, self.received_s = message.state, clock.monotonic()
                self.trend.append(message.row)
            elif isinstance(message, PlanMessage):
                self.plan = message.plan
            elif isinstance(message, QueueMessage):
                self.queue = message.queue
            elif isinstance(message, ResultsMessage):
                self.results = message.results
            elif isinstance(message, MachineMessage):
                self.machine = message.machine
                self.trend.clear()
            self._newest[type(message)] = message
        self._something.set()

    def _end(self, reason: str) -> None:
        self.lost = reason
        for waiting in self._answers.values():
            if not waiting.done():
                waiting.set_exception(LostError(reason))
        self._something.set()

    async def _messages(self) -> AsyncIterator[ServerMessage]:
        while True:
            if (first := next((kind for kind in (Hello, MachineMessage) if kind in self._newest), None)) is not None:
                yield self._newest.pop(first)
            elif self._events_due:
                yield self._events_due.popleft()
            elif self._newest:
                yield self._newest.pop(next(iter(self._newest)))
            elif self.lost:
                return
            else:
                self._something.clear()
                await self._something.wait()


class Link:
    """A connection that reconnects by itself. ``client`` is the present one, None while there is no connection."""

    def __init__(self, address: Address | None = None, *, name: str = "client", control: bool = False) -> None:
        """Open no connection before ``messages`` is called. ``control`` as in ``Client.connect``."""
        self.address = address
        self.name = name
        self.control = control
        self.client: Client | None = None

    async def messages(self) -> AsyncIterator[ServerMessage | Lost]:
        """Yield messages without end, and a ``Lost`` when the connection breaks. Each event arrives exactly once.

        Each new connection begins with a ``Hello``. If its ``complete`` is False, or its ``service`` differs, the
        events in between are lost.
        """
        service, since, reported = "", 0, Lost("")
        while True:
            try:
                self.client = await Client.connect(
                    self.address, name=self.name, control=self.control, service=service, since=since
                )
            except NoServiceError as error:
                lost = Lost(str(error), reported.gone or await self._gone(service))
                if lost != reported:
                    reported = lost
                    yield lost
                await asyncio.sleep(AGAIN_S)
                continue
            client = self.client
            service = client.service
            try:
                async for message in client:
                    yield message
                since, reported = client.last_seq or since, Lost(client.lost, "ended" if client.ended else "")
            finally:
                self.client = None
                await client.close()
            yield reported
            await asyncio.sleep(AGAIN_S)

    async def _gone(self, service: str) -> Gone:
        """Return "died" for a service that has died, "" if only its gateway is restarting (STOP then still works)."""
        there = not service or await asyncio.to_thread(takes_stop, self.address)
        return "" if there else "died"

    async def command(self, action: Action) -> JsonValue:
        """Send a command as ``Client.command`` does; raises LostError while there is no connection."""
        if self.client is None:
            raise LostError("not connected to the service")
        return await self.client.command(action)


async def _open(address: Address) -> ClientConnection:
    """Open the WebSocket; no compression and no proxy on a local socket."""
    if isinstance(address, UnixAddress):
        return await unix_connect(
            str(address.path), uri="ws://localhost/", compression=None, max_size=MAX_INCOMING, open_timeout=CONNECT_S,
            proxy=None,
        )  # fmt: skip
    return await connect(
        f"ws://{address.host}:{address.port}/", compression=None, max_size=MAX_INCOMING, open_timeout=CONNECT_S,
        proxy=None, additional_headers={"Authorization": f"Bearer {address.token}"},
    )  # fmt: skip
