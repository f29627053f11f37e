"""Answers over HTTP: the page's files by a list made at start, downloads by a ticket. Nothing else, and no datum."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from dataclasses import dataclass
from hashlib import sha256
from http import HTTPStatus
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path, PurePosixPath
from typing import Final
from urllib.parse import parse_qs, urlsplit

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from tester.base import clock
from tester.queue.calendar import calendar_text, key_valid
from tester.queue.view import QueueView

SOCKET: Final = "/socket"
DOWNLOAD: Final = "/download/"
CALENDAR: Final = "/queue.ics"
TICKET_S = 60.0
"""How long a ticket is good, s; it is good once."""
MOST_TICKETS = 16
"""Greatest number of tickets that wait; a further one replaces the oldest."""
TYPES: Final = {
    ".html": "text/html; charset=utf-8", ".css": "text/css; charset=utf-8", ".js": "text/javascript; charset=utf-8",
    ".json": "application/json", ".svg": "image/svg+xml", ".png": "image/png", ".ico": "image/x-icon",
    ".woff2": "font/woff2", ".txt": "text/plain; charset=utf-8", "/LICENSE": "text/plain; charset=utf-8",
}  # fmt: skip
"""Content types by a file's suffix, or its name where it has none; any other file is not served."""
POLICY: Final = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; font-src 'self'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
    "require-trusted-types-for 'script'"
)
"""Content-Security-Policy: own files only, no inline script or style; in scripts no text becomes markup."""
ALWAYS: Final = (
    ("Content-Security-Policy", POLICY),
    ("X-Content-Type-Options", "nosniff"),
    ("Referrer-Policy", "no-referrer"),
    ("X-Frame-Options", "DENY"),
    ("Cross-Origin-Opener-Policy", "same-origin"),
    ("Cross-Origin-Resource-Policy", "same-origin"),
    ("Permissions-Policy", "camera=(), microphone=(), geolocation=()"),
)
"""Headers of every answer."""


@dataclass(frozen=True, slots=True)
class File:
    """A file of the page in memory."""

    kind: str
    body: bytes
    etag: str


@dataclass(frozen=True, slots=True)
class Download:
    """A file for one page. ``name``: offered to the browser, ASCII letters, digits, dots, dashes."""

    name: str
    kind: str
    body: bytes


def answer(
    status: HTTPStatus, body: bytes = b"", kind: str = "text/plain; charset=utf-8", **further: str
) -> Response:
    """Return an answer with the headers of every answer."""
    headers = Headers([*ALWAYS, ("Content-Type", kind), ("Content-Length", str(len(body))), ("Connection", "close")])
    for name, value in further.items():
        headers[name.replace("_", "-")] = value
    return Response(status.value, status.phrase, headers, body)


def refused(status: HTTPStatus, reason: str) -> Response:
    """Return an answer that gives only a reason."""
    return answer(status, f"{reason}\n".encode())


def static_files(folder: Traversable | None = None) -> dict[str, File]:
    """Read the page's files once; return them by their path. A file that is added later is not served."""
    files: dict[str, File] = {}
    _gather(folder or resources.files("tester.page") / "static", "/static/", files)
    if "/static/index.html" in files:
        files["/"] = files["/static/index.html"]
    return files


def _gather(folder: Traversable, path: str, files: dict[str, File]) -> None:
    for entry in sorted(folder.iterdir(), key=lambda one: one.name) if folder.is_dir() else []:
        if entry.is_dir():
            _gather(entry, f"{path}{entry.name}/", files)
        elif (kind := TYPES.get(PurePosixPath(entry.name).suffix or f"/{entry.name}")) is not None:
            body = entry.read_bytes()
            files[f"{path}{entry.name}"] = File(kind, body, f'"{sha256(body).hexdigest()[:32]}"')


class Tickets:
    """Downloads that wait to be fetched, each by a random path, once."""

    def __init__(self, now: Callable[[], float] = clock.monotonic) -> None:
        """``now`` returns seconds."""
        self._now = now
        self._waiting: dict[str, tuple[float, Download]] = {}

    def issue(self, download: Download) -> str:
        """Return the path under which a download may be fetched once."""
        self.tidy()
        while len(self._waiting) >= MOST_TICKETS:
            del self._waiting[next(iter(self._waiting))]
        ticket = secrets.token_urlsafe(32)
        self._waiting[ticket] = self._now() + TICKET_S, download
        return DOWNLOAD + ticket

    def take(self, ticket: str) -> Download | None:
        """Return a download and forget it; None for an unknown, used or old ticket."""
        until_s, download = self._waiting.pop(ticket, (0.0, None))
        return download if until_s > self._now() else None

    def tidy(self) -> None:
        """Forget old tickets."""
        now_s = self._now()
        self._waiting = {ticket: kept for ticket, kept in self._waiting.items() if kept[0] > now_s}


def answer_calendar(request: Request, runs: Path, view: QueueView | None) -> Response:
    """Answer a calendar's request: times and names of the queue's items, for a key that was made for it.

    ``runs``: folder of the keys; ``view``: the queue, None where it is not known.
    """
    keys = parse_qs(urlsplit(request.path).query).get("key", [])
    if len(keys) != 1 or not key_valid(runs, keys[0]):
        return refused(HTTPStatus.FORBIDDEN, "this key reads no calendar: `tester queue key` makes one")
    if view is None:
        return refused(HTTPStatus.SERVICE_UNAVAILABLE, "the queue is not known: no service runs")
    return answer(HTTPStatus.OK, calendar_text(view).encode(), "text/calendar; charset=utf-8", Cache_Control="no-store")


def answer_file(request: Request, files: dict[str, File], tickets: Tickets) -> Response:
    """Answer a request for a file or a download."""
    path = request.path.partition("?")[0]
    if (file := files.get(path)) is not None:
        if request.headers.get_all("If-None-Match") == [file.etag]:
            return answer(HTTPStatus.NOT_MODIFIED, b"", file.kind, ETag=file.etag, Cache_Control="no-cache")
        return answer(HTTPStatus.OK, file.body, file.kind, ETag=file.etag, Cache_Control="no-cache")
    if path.startswith(DOWNLOAD) and (download := tickets.take(path.removeprefix(DOWNLOAD))) is not None:
        return answer(
            HTTPStatus.OK, download.body, download.kind, Cache_Control="no-store",
            Content_Disposition=f'attachment; filename="{download.name}"',
        )  # fmt: skip
    return refused(HTTPStatus.NOT_FOUND, "there is nothing here")
