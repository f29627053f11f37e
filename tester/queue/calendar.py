"""The queue as an iCalendar text (RFC 5545), and the keys with which a calendar reads it: times and names, no more."""

from __future__ import annotations

import hmac
import re
import secrets
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from typing import Final

from pydantic import TypeAdapter

from tester.base import clock
from tester.base.words import plain_text
from tester.queue.fold import QueueError
from tester.queue.places import FOLDER
from tester.queue.view import ItemView, QueueView
from tester.store.disk import write_whole

PRODUCT: Final = "-//friction-tester//queue//EN"
KEYS: Final = "calendar-keys.json"
KEY_BYTES: Final = 24
MOST_KEYS: Final = 100
LINE: Final = 75
"""Greatest length of a line in octets (RFC 5545, 3.1)."""


def calendar_text(view: QueueView) -> str:
    """Return the items that run or will run, with their predicted times, as a calendar.

    A UID belongs to an item for ever; SEQUENCE and DTSTAMP rise with each new prediction, so that a calendar replaces
    the times it has. Without a start and an end an item is left out.
    """
    lines = ["BEGIN:VCALENDAR", "VERSION:2.0", f"PRODID:{PRODUCT}", "CALSCALE:GREGORIAN", "METHOD:PUBLISH"]
    for item in view.listed:
        if item.start_utc and item.end_utc:
            lines += _event(item, view)
    lines.append("END:VCALENDAR")
    return "".join(f"{piece}\r\n" for line in lines for piece in _folded(line))


def _event(item: ItemView, view: QueueView) -> list[str]:
    made = datetime.fromisoformat(view.at_utc)
    identity = sha256(f"{item.id}\n{item.utc}\n{item.sha256}".encode()).hexdigest()[:24]
    return [
        "BEGIN:VEVENT",
        f"UID:{item.id}-{identity}@friction-tester",
        f"DTSTAMP:{_stamp(view.at_utc)}",
        f"SEQUENCE:{int(made.timestamp()) & 0x7FFFFFFF}",
        f"DTSTART:{_stamp(item.start_utc)}",
        f"DTEND:{_stamp(item.end_utc)}",
        f"SUMMARY:{_escaped(item.name)}",
        f"STATUS:{'CONFIRMED' if view.going or item.state.under_way else 'TENTATIVE'}",
        "TRANSP:TRANSPARENT",
        "END:VEVENT",
    ]


def _stamp(utc: str) -> str:
    return datetime.fromisoformat(utc).astimezone(UTC).strftime("%Y%m%dT%H%M%SZ")


def _escaped(text: str) -> str:
    """Return a text as a value of TEXT (RFC 5545, 3.3.11); line ends and control characters become spaces."""
    text = re.sub(r"[\x00-\x1f\x7f-\x9f\u2028\u2029]+", " ", text)
    return re.sub(r"([\\;,])", r"\\\1", text)


def _folded(line: str) -> Iterator[str]:
    """Yield a line in pieces of at most 75 octets, the later ones after a space (RFC 5545, 3.1)."""
    piece, size = "", 0
    for character in line:
        octets = len(character.encode(errors="replace"))
        if size + octets > LINE:
            yield piece
            piece, size = " ", 1
        piece, size = piece + character, size + octets
    yield piece


@dataclass(frozen=True, slots=True)
class CalendarKey:
    """A key that reads the calendar: only its hash is kept. ``number`` counts from 1; ``name``: for whom."""

    number: int
    name: str
    sha256: str
    made_utc: str
    revoked_utc: str = ""


_KEYS: Final[TypeAdapter[list[CalendarKey]]] = TypeAdapter(list[CalendarKey])


def _file(runs: Path) -> Path:
    return runs / FOLDER / KEYS


def calendar_keys(runs: Path) -> list[CalendarKey]:
    """Return the keys that were made, also revoked ones. Raises QueueError for a file that cannot be read."""
    try:
        return _KEYS.validate_json(_file(runs).read_bytes())
    except FileNotFoundError:
        return []
    except (OSError, ValueError) as error:
        raise QueueError(f"{_file(runs)} cannot be read: {error}") from error


def new_key(runs: Path, name: str) -> str:
    """Make a key and return it; it is shown this once. Raises QueueError, OSError."""
    known = calendar_keys(runs)
    if len(known) >= MOST_KEYS:
        raise QueueError(f"{MOST_KEYS} keys were made already: {_file(runs)}")
    try:
        plain_text(name, "the key's name")
    except ValueError as error:
        raise QueueError(str(error)) from error
    key = secrets.token_urlsafe(KEY_BYTES)
    number = 1 + max((one.number for one in known), default=0)
    _write(runs, [*known, CalendarKey(number, name, _hash(key), clock.utc_now())])
    return key


def revoke_key(runs: Path, number: int) -> None:
    """Revoke a key from now on. Raises QueueError, OSError."""
    known = calendar_keys(runs)
    if not any(one.number == number and not one.revoked_utc for one in known):
        raise QueueError(f"there is no key {number} that counts: `tester queue key --list` lists them")
    now = clock.utc_now()
    _write(runs, [replace(one, revoked_utc=now) if one.number == number else one for one in known])


def key_valid(runs: Path, key: str) -> bool:
    """Return whether a key reads the calendar now. An unreadable file makes no key valid. The comparison takes the same
    time for every wrong key.
    """
    try:
        known = calendar_keys(runs)
    except QueueError:
        return False
    given = _hash(key)
    matches = [hmac.compare_digest(given, one.sha256) and not one.revoked_utc for one in known]
    return bool(key) and any(matches)


def _hash(key: str) -> str:
    return sha256(key.encode(errors="replace")).hexdigest()


def _write(runs: Path, keys: list[CalendarKey]) -> None:
    path = _file(runs)
    path.parent.mkdir(parents=True, exist_ok=True)

    def fill(part: Path) -> None:
        part.touch(mode=0o600)
        part.chmod(0o600)
        part.write_bytes(_KEYS.dump_json(keys, indent=1))

    write_whole(path, fill)
