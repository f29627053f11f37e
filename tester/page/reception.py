"""The WebSocket of a page: pairing or entering first, then commands and questions, each refused or carried out."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from http import HTTPStatus
from pathlib import Path

from pydantic import JsonValue, ValidationError
from pydantic_core import to_json
from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from tester.page.allowed import ACTION, NotAllowedError, in_words, outside, rule_of
from tester.page.answers import CALENDAR, SOCKET, File, Tickets, answer_calendar, answer_file
from tester.page.answers import refused as refused_http
from tester.page.front import (
    BadFrontError,
    PageCommand,
    PageQuestion,
    PairPage,
    accepted,
    edit_of,
    first_of,
    in_one_line,
    message_of,
    refused,
    stop_of,
    to_front,
)
from tester.page.hub import Hub
from tester.page.origins import Origins
from tester.page.pairing import Pairing, PairingError, Pairings
from tester.page.roles import includes
from tester.page.visitor import Visitor
from tester.service.client import LostError, NoServiceError, RefusedError
from tester.service.commands import ListRecipes
from tester.service.manners import Bucket, Strangers
from tester.service.stop_line import StopLine

FIRST_WITHIN_S = 10.0
"""A socket without a first message is closed after this time, s."""
WRONG_S = 0.5
"""How long a page that is refused waits for its answer, s: a flood of guesses waits, and takes no time from STOP."""
NOT_PAIRED = 4003
"""Close code for a page whose code or secret is not accepted, or no longer."""
FELL_BEHIND = 4001
"""Close code for a page that does not read its answers and events."""

Answering = Callable[[Pairing, PageQuestion], Awaitable[bytes]]
"""Answers a question of a page as JSON; raises AskError."""


class AskError(Exception):
    """A question cannot be answered; the message gives the reason."""


class Reception:
    """Receives pages."""

    def __init__(
        self, pairings: Pairings, hub: Hub, origins: Origins, files: dict[str, File], tickets: Tickets,
        answering: Answering, runs: Path,
    ) -> None:  # fmt: skip
        """Take the parts of the process. ``runs``: folder of the stored runs, with the keys of calendars."""
        self.pairings, self.hub, self.origins = pairings, hub, origins
        self.files, self.tickets = files, tickets
        self.answering = answering
        self.runs = runs
        self.strangers = Strangers()
        self.changed: Callable[[], None] = lambda: None
        """Called when a pairing or a code changes, for the machine's screen."""

    async def admit(self, connection: ServerConnection, request: Request) -> Response | None:
        """Answer a request over HTTP; None lets a WebSocket open."""
        wants_socket = request.path == SOCKET
        if reason := self.origins.refusal(request.headers, socket=wants_socket):
            return refused_http(HTTPStatus.FORBIDDEN, reason)
        if getattr(request, "method", "GET") not in ("GET", "HEAD"):
            return refused_http(HTTPStatus.METHOD_NOT_ALLOWED, "only GET is answered")
        if wants_socket:
            return None
        if request.path.partition("?")[0] == CALENDAR:
            client = self.hub.link.client
            queue = client.queue if client is not None else None
            return await asyncio.to_thread(answer_calendar, request, self.runs, queue)
        return answer_file(request, self.files, self.tickets)

    # -- a page -----------------------------------------------------------------------------------------------

    async def serve(self, connection: ServerConnection) -> None:
        """Serve one page until it or its pairing ends."""
        try:
            async with asyncio.timeout(FIRST_WITHIN_S):
                pairing, greeting = self._entered(await connection.recv())
        except (PairingError, BadFrontError) as error:
            await asyncio.sleep(WRONG_S)
            await _turn_away(connection, str(error))
            return
        except (ConnectionClosed, TimeoutError):
            await connection.close()
            return
        self.strangers.known(connection)
        visitor = Visitor(connection, pairing, self.hub.address)
        if includes(pairing.role, "stop"):
            visitor.stop_line = StopLine(self.hub.address, pairing.recorded)
            visitor.stop_line.open()
        visitor.outbox.reply(greeting)
        self.hub.enter(visitor)
        self.changed()
        sending = asyncio.create_task(self._send(visitor))
        bucket = Bucket()
        try:
            async for text in connection:
                if (wait_s := bucket.spend(len(text))) > 0.0:
                    await asyncio.wait({sending}, timeout=wait_s)  # read nothing more from this page meanwhile
                self._obey(visitor, text)
        except ConnectionClosed:
            pass  # a page may disconnect at any time
        finally:
            sending.cancel()
            self.hub.leave(visitor)
            await visitor.close()
            self.changed()

    def _entered(self, text: str | bytes) -> tuple[Pairing, bytes]:
        message = first_of(text)
        if isinstance(message, PairPage):
            pairing, secret = self.pairings.pair(message.code, message.name)
            return pairing, to_front(
                "paired", secret=secret, role=pairing.role, expires_utc=pairing.expires_utc, name=pairing.name
            )
        pairing = self.pairings.of(message.secret)
        return pairing, to_front("entered", role=pairing.role, expires_utc=pairing.expires_utc, name=pairing.name)

    async def _send(self, visitor: Visitor) -> None:
        """Send waiting messages; while a page does not read, only its own queue waits."""
        with suppress(ConnectionClosed):
            while True:
                await visitor.connection.send(await visitor.outbox.next(), text=True)

    def dismiss(self, visitor: Visitor, reason: str) -> None:
        """Send the reason and close a page whose pairing has ended."""
        if visitor.leaving is None:
            visitor.leaving = asyncio.create_task(self._bye(visitor, reason))

    async def _bye(self, visitor: Visitor, reason: str) -> None:
        self.hub.leave(visitor)
        with suppress(ConnectionClosed, TimeoutError):
            async with asyncio.timeout(1.0):  # a frozen page does not read it
                await visitor.connection.send(to_front("bye", reason=reason), text=True)
        await visitor.connection.close(NOT_PAIRED, reason[:100])

    def tidy(self) -> None:
        """Dismiss pages whose pairing has ended, and those that do not read; forget old tickets."""
        for visitor in list(self.hub.visitors):
            if not self.pairings.good(visitor.pairing):
                self.dismiss(visitor, "this pairing has expired or was revoked: pair the page again")
            elif visitor.outbox.behind and visitor.leaving is None:
                visitor.leaving = asyncio.create_task(visitor.connection.close(FELL_BEHIND, "too far behind"))
        self.tickets.tidy()

    # -- its messages -----------------------------------------------------------------------------------------

    def _obey(self, visitor: Visitor, text: str | bytes) -> None:
        """Carry out a message, without waiting. STOP first, whatever else the message holds."""
        if not self.pairings.good(visitor.pairing):
            self.dismiss(visitor, "this pairing has expired or was revoked: pair the page again")
            return
        if (stop := stop_of(text)) is not None:
            number, fast = stop
            visitor.start(asyncio.create_task(self._stop(visitor, number, fast=fast)))
            return
        try:
            message = message_of(text)
        except BadFrontError as error:
            visitor.outbox.reply(refused(error.number, str(error)))
            return
        if visitor.busy:
            visitor.outbox.reply(refused(message.id, "too many at once: wait for the answers"))
        else:
            if isinstance(message, PageCommand):
                work = self._command(visitor, message)
            else:
                work = self._ask(visitor, message)
            visitor.start(asyncio.create_task(self._answered(visitor, message.id, work)))

    async def _stop(self, visitor: Visitor, number: int, *, fast: bool) -> None:
        reason = await visitor.stop(fast=fast)
        visitor.outbox.reply(refused(number, reason) if reason else accepted(number))

    async def _answered(self, visitor: Visitor, number: int, work: Awaitable[bytes]) -> None:
        try:
            result = await work
        except (AskError, PairingError, NotAllowedError, NoServiceError, RefusedError, LostError) as error:
            visitor.outbox.reply(refused(number, str(error)))
        except TimeoutError:
            visitor.outbox.reply(refused(number, "no answer in time"))
        else:
            visitor.outbox.reply(accepted(number, result))

    async def _command(self, visitor: Visitor, message: PageCommand) -> bytes:
        try:
            action = ACTION.validate_python(message.action)
        except ValidationError as error:
            raise AskError(in_one_line(error)) from None
        rule = rule_of(action, visitor.pairing.role)
        if reason := outside(action, await self._recipes(action)):
            raise NotAllowedError(reason)
        if rule.code(action):
            try:
                self.pairings.confirm(
                    visitor.pairing, ACTION.dump_json(action).decode(), in_words(action), message.code
                )
            finally:
                self.changed()
        if includes(rule.role, "control"):
            result: JsonValue = await visitor.command(action)
        else:
            result = await self.hub.link.command(action)
        return to_json(result)

    async def _recipes(self, action: object) -> set[str]:
        """Return the recipes of the service's list, if the action names one."""
        if not getattr(action, "recipe", ""):
            return set()
        answer = await self.hub.link.command(ListRecipes())
        listed = answer.get("recipes") if isinstance(answer, dict) else None
        return {str(one["path"]) for one in listed if isinstance(one, dict)} if isinstance(listed, list) else set()

    async def _ask(self, visitor: Visitor, message: PageQuestion) -> bytes:
        action = edit_of(message)
        if action is None or action.run != self.hub.running:
            return await self.answering(visitor.pairing, message)
        rule_of(action, visitor.pairing.role)
        return to_json(await visitor.once(action))  # the run's own writer has the record


async def _turn_away(connection: ServerConnection, reason: str) -> None:
    """Refuse a page that is not paired, and close its socket."""
    with suppress(ConnectionClosed):
        await connection.send(refused(0, reason), text=True)
        await connection.close(NOT_PAIRED, reason[:100])
