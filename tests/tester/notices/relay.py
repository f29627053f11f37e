"""A mail relay for tests: SMTP (RFC 5321) over loopback, in a thread. It can be down, slow, refuse, or take a mail and
lose its answer.
"""

from __future__ import annotations

import asyncio
import base64
import ssl
from dataclasses import dataclass, field
from email import message_from_bytes
from email.message import EmailMessage
from email.policy import default
from threading import Condition, Event, Thread
from types import TracebackType
from typing import cast


@dataclass(slots=True)
class TakenMail:
    """A mail that the relay has taken."""

    sender: str
    to: list[str]
    raw: bytes
    security: str

    @property
    def message(self) -> EmailMessage:
        return cast("EmailMessage", message_from_bytes(self.raw, policy=default))

    @property
    def ident(self) -> str:
        return str(self.message["Message-ID"])


@dataclass(slots=True)
class MailRelay:
    """``with MailRelay() as relay``: it listens on ``relay.port``. Set its fields between two mails."""

    user: str = ""
    password: str = ""
    tls: ssl.SSLContext | None = None
    starttls: bool = False
    down: bool = False
    """Every connection ends before the greeting."""
    loses: int = 0
    """Number of mails that it takes without an answer."""
    drops: int = 0
    """Number of mails whose connection ends before it has taken them."""
    refuses: dict[str, int] = field(default_factory=dict[str, int])
    """Reply code by recipient."""
    hangs: Event | None = None
    """Delay of its greeting."""
    taken: list[TakenMail] = field(default_factory=list[TakenMail])
    connections: int = 0
    port: int = 0
    _news: Condition = field(default_factory=Condition)
    _loop: asyncio.AbstractEventLoop = field(default_factory=asyncio.new_event_loop)
    _thread: Thread | None = None

    def __enter__(self) -> MailRelay:
        up = Event()
        self._thread = Thread(target=self._serve, args=(up,), daemon=True)
        self._thread.start()
        assert up.wait(10.0)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.hangs is not None:
            self.hangs.set()
        self._loop.call_soon_threadsafe(self._loop.stop)
        assert self._thread is not None
        self._thread.join(10.0)

    def wait_for(self, mails: int, within_s: float = 30.0) -> None:
        """Return once the relay has taken so many mails."""
        with self._news:
            assert self._news.wait_for(lambda: len(self.taken) >= mails, within_s), f"{len(self.taken)} of {mails}"

    def _serve(self, up: Event) -> None:
        implicit = self.tls if not self.starttls else None
        server = self._loop.run_until_complete(asyncio.start_server(self._session, "127.0.0.1", 0, ssl=implicit))
        self.port = server.sockets[0].getsockname()[1]
        up.set()
        self._loop.run_forever()
        server.close()
        for task in asyncio.all_tasks(self._loop):
            task.cancel()
        self._loop.run_until_complete(asyncio.sleep(0))
        self._loop.close()

    async def _session(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.connections += 1
        try:
            if not self.down:
                if self.hangs is not None:
                    await asyncio.to_thread(self.hangs.wait)
                await self._talk(reader, writer)
        except (ConnectionError, asyncio.IncompleteReadError, ssl.SSLError):
            pass
        finally:
            writer.close()

    async def _talk(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        def say(*lines: str) -> None:
            for place, line in enumerate(lines, 1):
                writer.write(f"{line[:3]}{'-' if place < len(lines) else ' '}{line[4:]}\r\n".encode())

        sender, to = "", list[str]()
        trusted, security = not self.user, "tls" if self.tls and not self.starttls else ""
        say("220 relay.test ESMTP")
        while line := (await reader.readline()).decode("ascii", "replace").rstrip("\r\n"):
            verb, _, rest = line.partition(" ")
            match verb.upper():
                case "EHLO" | "HELO":
                    offers = ["250 STARTTLS"] if self.starttls and not security else []
                    say("250 relay.test", *offers, *(["250 AUTH PLAIN"] if self.user else []), "250 8BITMIME")
                case "STARTTLS" if self.starttls and self.tls:
                    say("220 go ahead")
                    await writer.start_tls(self.tls)
                    security = "starttls"
                case "AUTH":
                    _, name, password = base64.b64decode(rest.split()[-1]).decode().split("\0")
                    trusted = (name, password) == (self.user, self.password)
                    say("235 ok" if trusted else f"535 not with the password {password}")
                case "MAIL":
                    sender, to = rest[rest.index("<") + 1 : rest.index(">")], []
                    say("250 ok" if trusted else "530 authenticate first")
                case "RCPT":
                    place = rest[rest.index("<") + 1 : rest.index(">")]
                    code = self.refuses.get(place, 250)
                    if code == 250:
                        to.append(place)
                    say(f"{code} {place}")
                case "DATA":
                    say("354 go ahead")
                    raw = await reader.readuntil(b"\r\n.\r\n")
                    if self.drops:
                        self.drops -= 1
                        return
                    with self._news:
                        self.taken.append(TakenMail(sender, to, _unstuffed(raw), security))
                        self._news.notify_all()
                    if self.loses:
                        self.loses -= 1
                        return
                    say("250 taken")
                case "RSET":
                    say("250 ok")
                case "QUIT":
                    say("221 bye")
                    return
                case _:
                    say("500 unknown")
            await writer.drain()


def _unstuffed(raw: bytes) -> bytes:
    lines = raw.removesuffix(b".\r\n").split(b"\r\n")
    return b"\r\n".join(line[1:] if line.startswith(b".") else line for line in lines)
