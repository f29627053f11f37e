"""What a channel sends, and how it reports that it could not."""

from __future__ import annotations

import ssl
from dataclasses import dataclass
from datetime import UTC, datetime, tzinfo
from hashlib import sha256
from typing import Final, Protocol

from tester.base.trouble import TroubleError, in_words
from tester.base.words import rough_duration
from tester.notices.mailing import Waiting
from tester.notices.notice import AGAIN_S, Notice, NoticeCause, body_of, one_line, subject_of

WITHIN_S: Final = 20.0
"""Time limit of one step of a network exchange, s [A]."""
PRIORITIES: Final = {NoticeCause.TRIP: 5, NoticeCause.SERVICE: 5, NoticeCause.PROMPT: 4, NoticeCause.DISK: 4,
                     NoticeCause.MORNING: 2}  # fmt: skip
"""Urgency from 1 to 5 as ntfy counts it; 3 for any other cause [A]."""


class NotDeliveredError(TroubleError):
    """The other end did not confirm a notice. ``final``: it refuses this notice, and will do so again."""

    def __init__(self, why: str, *, final: bool = False) -> None:
        """``why``: for people, in one line."""
        super().__init__(one_line(why, 300))
        self.final = final


@dataclass(frozen=True, slots=True)
class Letter:
    """A notice to one address, the same in every attempt. ``name``: of letters, digits, ``-`` and ``.``."""

    name: str
    at_s: float
    subject: str
    text: str
    notice: Notice
    priority: int


class NoticeChannel(Protocol):
    """A way to send. It may block, at most for some minutes."""

    def send(self, letter: Letter, place: str) -> None:
        """Send a letter to a place; return once the other end has confirmed it. Raises NotDeliveredError."""
        ...


def letter_of(waiting: Waiting, zone: tzinfo | None = None) -> Letter:
    """Return what is sent for a waiting notice. ``zone``: of its times, by default this machine's."""
    notice = waiting.notice
    subject, text = subject_of(notice), body_of(notice, local_text(notice.since_utc, zone))
    if waiting.asked:
        waits = f"waits for {rough_duration(AGAIN_S[waiting.asked - 1])}"
        subject, text = one_line(f"{subject} ({waits})"), f"The question {waits}.\n{text}"
    if waiting.more:
        text += f"Like it: {waiting.more} more, not sent one by one\n"
    lane = sha256(waiting.lane.encode("utf-8", "replace")).hexdigest()[:12]
    name = "".join(c if c.isascii() and c.isalnum() else "-" for c in waiting.message)
    priority = min(PRIORITIES.get(notice.cause, 3) + (waiting.asked > 1), 5)
    return Letter(f"{name}.{lane}", waiting.at_s, subject, text, notice, priority)


def local_text(utc: str, zone: tzinfo | None = None) -> str:
    """Return a time (ISO 8601, UTC) for people: local, with its offset; an invalid text unchanged."""
    try:
        at = datetime.fromisoformat(utc)
    except ValueError:
        return utc
    return (at if at.tzinfo else at.replace(tzinfo=UTC)).astimezone(zone).strftime("%Y-%m-%d %H:%M (UTC%z)")


def network_words(error: BaseException) -> str:
    """Return a network's error in words. The number of a TLS error is not the operating system's."""
    if isinstance(error, ssl.SSLError):
        return f"no secure connection: {getattr(error, 'verify_message', '') or error.reason or error}"
    return in_words(error) or type(error).__name__
