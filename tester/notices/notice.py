"""What a notice is: a cause in words for a person who is elsewhere, without results and without secrets.

The process that owns the rig makes these small messages and never waits for them; another process sends them.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, Final, Literal, TypeAlias

from pydantic import Field, TypeAdapter

from tester.base.words import harmless

WINDOW_S: Final = 600.0
"""Notices with one key are at least this far apart, s."""
AGAIN_S: Final = (900.0, 2700.0)
"""A question that waits this long is asked again, s; the last time at the second addresses, too."""
MOST_SUBJECT, MOST_LINE = 120, 600
"""Longest subject, and longest line of a text, in characters [A]: a line of a mail has at most 998 bytes (RFC 5322)."""


MOST_KEPT: Final = 500
"""Number of notes that the service repeats to a sender that starts anew [A]: it makes fewer in a month."""


@dataclass(frozen=True, slots=True)
class SenderSettings:
    """What the service tells its sender. ``service``: id of its life; ``command``: of ``tester serve --notify``."""

    service: str
    runs: str
    rig: str
    command: str = ""


SENDER: Final[TypeAdapter[SenderSettings]] = TypeAdapter(SenderSettings)


class NoticeCause(StrEnum):
    """Why a person gets a notice; the value is a command's ``TESTER_EVENT``."""

    TRIP = "trip"
    PROMPT = "prompt"
    HOLD = "hold"
    FINISHED = "finished"
    ITEM = "item"
    CONDITION = "condition"
    DISK = "disk"
    SERVICE = "service"
    MORNING = "morning"
    TEST = "test"


MEANINGS: Final = {
    NoticeCause.TRIP: "an interlock has stopped the rig",
    NoticeCause.PROMPT: "a question waits (again after 15 and 45 min)",
    NoticeCause.HOLD: "a hold begins",
    NoticeCause.FINISHED: "a run has ended",
    NoticeCause.ITEM: "an item of the queue has ended",
    NoticeCause.CONDITION: "a condition has no value",
    NoticeCause.DISK: "the disk is nearly full",
    NoticeCause.SERVICE: "the service has died",
    NoticeCause.MORNING: "every morning",
}
"""The causes for people, in the order of ``tester notices check``."""


@dataclass(frozen=True, slots=True)
class Notice:
    """One notice. ``number``: unique among all services; times are ISO 8601 in UTC.

    ``key``: of notices with one key only the first within ``WINDOW_S`` is sent at once. Where ``again``, the newest
    later one is sent when that time is over; without it, none.
    """

    number: str
    cause: NoticeCause
    key: str
    what: str
    since_utc: str
    itself: str
    """What the machine does by itself."""
    todo: str
    """What a person should do ..."""
    by: str
    """... and by when."""
    rig: str = ""
    run: str = ""
    folder: str = ""
    again: bool = True
    outcome: str = ""
    """How a run has ended: done, short, failed, tripped, stopped; "" for any other cause."""
    type: Literal["notice"] = "notice"


@dataclass(frozen=True, slots=True)
class NoticeOver:
    """The cause of the notices with this key is gone: a question is answered, a trip acknowledged."""

    number: str
    key: str
    type: Literal["over"] = "over"


@dataclass(frozen=True, slots=True)
class NextNeeded:
    """What the service does at present and when it will need a person; only the newest counts."""

    doing: str
    next_utc: str = ""
    """Expected time of the next question; "" if none is expected."""
    question: str = ""
    type: Literal["next"] = "next"


Note: TypeAlias = Annotated[Notice | NoticeOver | NextNeeded, Field(discriminator="type")]
NOTE: Final[TypeAdapter[Notice | NoticeOver | NextNeeded]] = TypeAdapter(Note)


def one_line(text: str, most: int = MOST_LINE) -> str:
    """Return a text as one line of at most ``most`` characters: it can neither end a line nor turn its direction.

    Control, bidirectional and invisible characters become question marks; every kind of blank becomes a space. A text
    that looks like an encoded word (RFC 2047) no longer does: ``email`` would decode it, line ends included.
    """
    line = " ".join(harmless(text).split())
    line = line if len(line) <= most else line[: most - 1].rstrip() + "…"
    return line.replace("=?", "= ?")


def subject_of(notice: Notice) -> str:
    """Return the subject of a notice: the rig, the cause, the beginning of the text."""
    rig = f"[{one_line(notice.rig, 40)}] " if notice.rig else ""
    return one_line(f"{rig}{notice.cause.value}: {notice.what}", MOST_SUBJECT)


def body_of(notice: Notice, since: str) -> str:
    """Return the text of a notice, lines ended by a line feed. ``since``: when it began, for people."""
    rows = (
        ("What", notice.what), ("Since", since), ("The machine", notice.itself), ("To do", notice.todo),
        ("By when", notice.by), ("Rig", notice.rig), ("Run", notice.run),
    )  # fmt: skip
    return "".join(f"{name}: {one_line(text)}\n" for name, text in rows if text)
