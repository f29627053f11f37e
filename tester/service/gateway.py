"""The gateway: the WebSocket side of the service. It forwards messages between clients and owner and decides who
controls.

It runs in a process of its own (docs/decisions/0021), so that a slow, stalled or hostile client does not delay the
scan. It keeps what a new client needs (newest state, plan, events, ten minutes of trend) as JSON, and reads only the
mode in it.
"""

from __future__ import annotations

import asyncio
import socket
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import cast

from pydantic_core import to_json
from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

from tester.base.screen import UNKNOWN
from tester.service.address import peer_text
from tester.service.commands import (
    VERSION,
    Attend,
    CheckRecipe,
    Join,
    ListRecipes,
    ListRuns,
    Query,
    QueueEdit,
    QueueQuery,
    RigAction,
    RunEdit,
    ShowPlan,
    Stop,
    TakeControl,
    WatchFrames,
)
from tester.service.guests import Guest, Guests
from tester.service.live_results import LiveResults
from tester.service.manners import MOST_CLIENTS, Strangers
from tester.service.protocol import (
    EVENTS_KEPT,
    TREND_ROWS,
    Accepted,
    BadMessageError,
    Goodbye,
    Refused,
    encode,
    foreign_join,
    id_in,
    stop_in,
    to_server,
)
from tester.service.queries import Queries, QueryError
from tester.service.queue_answers import QueueAnswers
from tester.service.service_link import GatewayEnd, Order

EVENTS_AT_FIRST = 200
"""Number of events in the ``hello`` to a client that has seen none."""
FELL_BEHIND = 4001
"""Close code for a client that does not read its events fast enough."""
JOIN_WITHIN_S = 10.0
"""The gateway closes a connection without a ``join`` after this time, s."""
QUESTIONS = 4
"""Greatest number of questions of one client that may run or wait at the same time."""
FULL = 1013
"""Close code when the service has no place left (try again later)."""
LAST_WORDS, LAST_WORDS_S = 8, 1.0
"""Number of messages that the gateway still reads, and for how long (s), from a client that it rejects: STOP may be
among them.
"""
STRANGER = 0
"""Number of a client that has not joined."""
NOT_JOINED = "a client that has not joined"
"""Name in the record of a client that has not joined."""
GREETED_WITHIN_S = 30.0
"""Time within which the owner must send its first state, s."""


class Gateway:
    """The state that all connections share."""

    def __init__(
        self,
        tell: Callable[[bytes], None],
        service: str,
        software: str,
        queries: Queries,
        notify: Callable[[bytes], None],
    ) -> None:
        """``tell`` sends a line to the owner, ``notify`` a note to the sender of notices; ``service`` identifies this
        instance of the service.
        """
        self.owner = GatewayEnd(tell)
        self.strangers = Strangers()
        self.service = service
        self.software = software
        self.queries = queries
        self._notify = notify
        self.guests = Guests(self.owner)
        self.ended = False
        """Whether the owner has ended on request."""
        self._next = 1
        self._state = b""
        self._plan = b"null"
        self.queue = QueueAnswers()
        self.results = LiveResults(queries.runs, self._take_results, lambda: bool(self.guests))
        self._machine = to_json(UNKNOWN)
        """Tables of the kind of rig; the owner sends them before its first state."""
        self._events: deque[tuple[int, bytes]] = deque(maxlen=EVENTS_KEPT)
        self._rows: deque[bytes] = deque(maxlen=TREND_ROWS)
        self._greeted = asyncio.Event()

    # -- from the owner ---------------------------------------------------------------------------------------

    def take(self, line: bytes) -> None:
        """Receive one line from the owner and forward it to the clients concerned."""
        kind, rest = line[:1], line[1:]
        if kind == b"s":
            self._state, _, row = rest.partition(b"\t")
            self.guests.take_state(self._state)
            self._rows.append(row)
            self._greeted.set()
            self.guests.newest("snapshot", b'{"state":' + self._state + b',"row":' + row + b',"type":"snapshot"}')
        elif kind == b"e":
            number, _, event = rest.partition(b" ")
            self._events.append((int(number), event))
            self.results.event(event)
            for guest in self.guests.values():
                guest.outbox.event(event)
                self._keep(guest)
        elif kind == b"p":
            self._plan = rest
            self.guests.newest("plan", b'{"plan":' + rest + b',"type":"plan"}')
        elif kind == b"q":
            self.queue.encoded = rest
            self.guests.newest("queue", b'{"queue":' + rest + b',"type":"queue"}')
        elif kind == b"m":
            self._take_machine(rest)
        elif kind == b"a":
            number, _, reply = rest.partition(b" ")
            if (asker := self.guests.get(int(number))) is not None:
                self._reply(asker, reply)
        elif kind == b"b":
            self.ended = True
        elif kind == b"k":
            self.owner.looked_at(int(rest))
        elif kind == b"t":
            self._rows.append(rest)
        elif kind == b"n":
            self._notify(rest)
        elif kind == b"f":
            self.guests.newest("frames", rest)

    def _take_results(self, results: bytes) -> None:
        self.guests.newest("results", b'{"results":' + results + b',"type":"results"}')

    def _take_machine(self, machine: bytes) -> None:
        """Store the tables of a kind of rig. If they change, drop the trend, whose columns belong to the old kind."""
        if machine != self._machine:
            self._machine = machine
            self._rows.clear()
            for guest in self.guests.values():
                self._reply(guest, b'{"machine":' + machine + b',"type":"machine"}')

    def farewell(self) -> None:
        """Send every client a ``goodbye``: the owner has ended or, if it sent no goodbye itself, has died."""
        last = Goodbye("the service has ended", ended=True) if self.ended else Goodbye("the service has died")
        for guest in self.guests.values():
            guest.outbox.reply(encode(last))

    # -- a connection -----------------------------------------------------------------------------------------

    async def serve(self, connection: ServerConnection) -> None:
        """Serve one client until the client or the service ends."""
        raw = cast("socket.socket | None", connection.transport.get_extra_info("socket"))
        peer = peer_text(raw) if raw is not None else "peer not known"
        try:
            joined = await self._joined(connection, peer)
        except (ConnectionClosed, TimeoutError, BadMessageError) as error:
            await self._turn_away(connection, peer, str(error) or "no join")
            return
        self.strangers.known(connection)
        if len(self.guests) >= MOST_CLIENTS:
            await self._turn_away(connection, peer, f"{MOST_CLIENTS} clients are here already", FULL)
            return
        guest = Guest(connection, self._next, joined.name, peer, joined.control)
        self._next += 1
        guest.outbox.reply(self._hello(joined, guest))
        self.guests.join(guest)
        sending = asyncio.create_task(self._send(guest))
        try:
            async for text in connection:
                if (wait_s := guest.bucket.spend(len(text))) > 0.0:
                    await asyncio.wait({sending}, timeout=wait_s)  # read nothing more from this client meanwhile
                self._obey(guest, text, gone=sending.done())
        except ConnectionClosed:
            pass  # a client may disconnect at any time: that is not an error of the service
        finally:
            sending.cancel()
            self.guests.leave(guest)

    async def _joined(self, connection: ServerConnection, peer: str) -> Join:
        async with asyncio.timeout(JOIN_WITHIN_S):
            text = await connection.recv()
        if self._stop_of_stranger(text, peer):
            raise BadMessageError("STOP was taken; anything else needs a join first")
        if foreign := foreign_join(text):
            raise BadMessageError(foreign)
        message = to_server(text)
        if not isinstance(message, Join):
            raise BadMessageError("the first message is a join")
        async with asyncio.timeout(GREETED_WITHIN_S):
            await self._greeted.wait()
        return message

    async def _turn_away(self, connection: ServerConnection, peer: str, reason: str, code: int = 1008) -> None:
        """Close a client's connection with a reason; before that, read a few messages in case one is STOP."""
        with suppress(ConnectionClosed):
            await connection.send(encode(Goodbye(reason)), text=True)
        with suppress(ConnectionClosed, TimeoutError):
            async with asyncio.timeout(LAST_WORDS_S):
                for _ in range(LAST_WORDS):
                    self._stop_of_stranger(await connection.recv(), peer)
        with suppress(ConnectionClosed):
            await connection.close(code, reason[:100])

    def _stop_of_stranger(self, text: str | bytes, peer: str) -> bool:
        """Forward a STOP from a client that has not joined; return whether the message was a STOP."""
        stop = stop_in(text)
        if stop is None or not isinstance(stop.action, Stop):
            return False
        self.owner.stop(Order(STRANGER, NOT_JOINED, stop.id, stop.action, peer))
        return True

    def _hello(self, joined: Join, guest: Guest) -> bytes:
        if joined.control and not self.guests.controller:
            self.guests.controller = guest.number
        known = joined.service == self.service
        events = list(self._events)
        first = events[0][0] if events else 1
        if known:
            sent = [event for number, event in events if number > joined.since]
        else:
            sent = [event for _, event in events[-EVENTS_AT_FIRST:]]
        complete = (first <= joined.since + 1) if known else len(sent) == len(events) and first == 1
        return b"".join(
            (
                b'{"version":%d,' % VERSION,
                b'"service":' + to_json(self.service) + b',"software":' + to_json(self.software),
                b',"client":%d,' % guest.number,
                b'"control":' + (b"true" if self.guests.controller == guest.number else b"false"),
                b',"machine":' + self._machine + b',"state":' + self._state + b',"plan":' + self._plan,
                b',"events":[' + b",".join(sent) + b'],"complete":' + (b"true" if complete else b"false"),
                b',"trend":[' + b",".join(self._rows) + b'],"queue":' + self.queue.encoded,
                b',"results":' + self.results.encoded + b',"type":"hello"}',
            )
        )

    async def _send(self, guest: Guest) -> None:
        """Send pending messages, the most urgent first, and wait while the client does not read."""
        try:
            while True:
                await guest.connection.send(await guest.outbox.next(), text=True)
        except ConnectionClosed:
            return

    async def _drop(self, guest: Guest) -> None:
        """Disconnect a client that does not keep up: events are never left out."""
        await guest.connection.close(FELL_BEHIND, f"{guest.outbox.behind} messages behind: come back with since")

    def _reply(self, guest: Guest, message: bytes) -> None:
        guest.outbox.reply(message)
        self._keep(guest)

    def _answer(self, guest: Guest, number: int, refusal: str = "") -> None:
        """Answer a command: refused, with the reason, or accepted."""
        self._reply(guest, encode(Refused(number, refusal) if refusal else Accepted(number)))

    def _keep(self, guest: Guest) -> None:
        """Disconnect a client that does not read its messages; do nothing for any other client."""
        if guest.outbox.behind and not guest.leaving:
            guest.leaving = asyncio.create_task(self._drop(guest))

    # -- commands ---------------------------------------------------------------------------------------------

    def _obey(self, guest: Guest, text: str | bytes, *, gone: bool) -> None:
        """Carry out a message. If the client has disconnected (``gone``), carry out only STOP."""
        try:
            message = to_server(text)
        except BadMessageError as error:
            stop = stop_in(text)  # STOP counts, even in a message that is otherwise invalid
            if stop is None:
                self._answer(guest, id_in(text), str(error))
                return
            message = stop
        if isinstance(message, Join):
            self._reply(guest, encode(Goodbye("joined already")))
            return
        action = message.action
        if gone and not isinstance(action, Stop):
            return
        if isinstance(action, TakeControl):
            self._answer(guest, message.id, self.guests.change(guest, action))
        elif isinstance(action, WatchFrames):
            guest.frames = action.on
            self.guests.tell()
            self._answer(guest, message.id)
        elif isinstance(action, Attend):
            self.guests.sign(guest)
            self._answer(guest, message.id)
        elif isinstance(action, QueueQuery):
            self._reply(guest, self.queue.reply(message.id, action))
        elif isinstance(action, CheckRecipe | ShowPlan | ListRecipes | ListRuns):
            self._ask(guest, message.id, action)
        else:
            self._order(guest, message.id, action)

    def _order(self, guest: Guest, number: int, action: RigAction) -> None:
        """Forward a command to the rig's owner if this client may send it."""
        if not isinstance(action, Stop | QueueEdit | RunEdit) and (refusal := self.guests.refusal(guest)):
            self._answer(guest, number, refusal)
            return
        self.guests.forget_mode()
        order = Order(guest.number, guest.name, number, action, guest.peer)
        if isinstance(action, Stop):
            if (replaced := self.owner.stop(order)) is not None:
                self._answer(guest, replaced.id)
        elif not self.owner.order(order):
            self._answer(guest, number, "too many commands at once: wait for their answers")

    def _ask(self, guest: Guest, number: int, question: Query) -> None:
        if guest.questions >= QUESTIONS:
            self._answer(guest, number, f"{QUESTIONS} questions are being worked out already: wait for their answers")
            return
        guest.questions += 1
        self.queries.start(self._query(guest, number, question))

    async def _query(self, guest: Guest, number: int, question: Query) -> None:
        try:
            result = await self.queries.answer(question)
        except QueryError as error:
            self._answer(guest, number, str(error))
        else:
            self._reply(guest, encode(Accepted(number, result)))
        finally:
            guest.questions -= 1
