"""The fold of the outbox's records: which notices there are, which addresses still wait for them, and why.

Plain data, without files and clocks; times are seconds since 1970 (``tester.base.clock.wall_s``).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Final, cast

from pydantic import JsonValue

from tester.notices.notice import AGAIN_S, NOTE, WINDOW_S, Notice, NoticeCause, NoticeOver

KEPT_S: Final = 8.0 * 86400.0
"""How long a settled notice is remembered, s [A]: the service repeats its notes to a sender that starts anew."""


@dataclass(slots=True)
class Waiting:
    """One notice to one address. ``asked``: 0, or the how-many-th repetition of a question."""

    message: str
    """Name of the message, the same in every attempt."""
    lane: str
    notice: Notice
    asked: int
    more: int
    """Number of later notices of the same key that this one stands for."""
    at_s: float
    """When it was put into the outbox."""
    tries: int = 0
    refusals: int = 0
    """Number of attempts that the other end refused for good."""
    tried_s: float = 0.0
    why: str = ""
    """Why the newest attempt failed."""


@dataclass(slots=True)
class KeyState:
    """What is known of a key: when its newest notice went into the outbox, and the one that has to wait."""

    last_s: float
    held: Notice | None = None
    more: int = 0


@dataclass(slots=True)
class OpenQuestion:
    """A question that waits for a person. ``since_s``: when it was put."""

    notice: Notice
    since_s: float
    asked: int = 0
    """Number of repetitions so far."""


@dataclass(slots=True)
class Mailing:
    """The present content of an outbox."""

    known: dict[str, float] = field(default_factory=dict[str, float])
    """Numbers of all notes seen, with their time."""
    messages: set[str] = field(default_factory=set[str])
    """Names of all messages ever put in; a record that is there twice counts once."""
    keys: dict[str, KeyState] = field(default_factory=dict[str, KeyState])
    question: OpenQuestion | None = None
    lanes: dict[str, list[Waiting]] = field(default_factory=dict[str, list[Waiting]])
    """Waiting notices by address, the oldest first."""
    failed: list[Waiting] = field(default_factory=list[Waiting])
    """Notices that were given up."""
    ends: list[tuple[float, Notice]] = field(default_factory=list[tuple[float, Notice]])
    """Ends of runs and items, with their times."""
    morning_s: float = 0.0
    """When the newest morning's message was put into the outbox."""

    @classmethod
    def of(cls, entries: Iterable[Mapping[str, JsonValue]]) -> Mailing:
        """Return the fold of all records."""
        mailing = cls()
        for entry in entries:
            mailing.apply(entry)
        return mailing

    def apply(self, entry: Mapping[str, JsonValue]) -> None:
        """Take one record into account; an unknown kind is skipped (a newer version's)."""
        kind, at_s = entry.get("k"), float(cast("float", entry.get("t", 0.0)))
        if kind in ("note", "held", "merged"):
            notice = NOTE.validate_python(entry["n"])
            assert isinstance(notice, Notice)
            self._take(str(kind), at_s, notice, entry)
        elif kind == "over":
            over = NOTE.validate_python(entry["n"])
            assert isinstance(over, NoticeOver)
            self.known[over.number] = at_s
            self._over(over.key)
        elif kind in ("sent", "tried", "failed"):
            self._attempt(str(kind), at_s, entry)

    def _take(self, kind: str, at_s: float, notice: Notice, entry: Mapping[str, JsonValue]) -> None:
        asked = int(cast("int", entry.get("asked", 0)))
        if notice.number not in self.known:
            self.known[notice.number] = at_s
            if notice.outcome:
                self.ends.append((at_s, notice))
            if notice.cause is NoticeCause.PROMPT:
                self.question = OpenQuestion(notice, at_s)
        if kind == "held":
            state = self.keys.setdefault(notice.key, KeyState(at_s))
            state.held, state.more = notice, state.more + (state.held is not None)
        message = f"{notice.number}.{asked}"
        if kind != "note" or message in self.messages:
            return
        self.messages.add(message)
        self.keys[notice.key] = KeyState(at_s)
        if self.question is not None and self.question.notice.key == notice.key:
            self.question.asked = max(asked, self.question.asked)
        if notice.cause is NoticeCause.MORNING:
            self.morning_s = at_s
        more = int(cast("int", entry.get("more", 0)))
        for lane in cast("list[str]", entry["to"]):
            self.lanes.setdefault(lane, []).append(Waiting(message, lane, notice, asked, more, at_s))

    def _over(self, key: str) -> None:
        if (state := self.keys.get(key)) is not None:
            state.held, state.more = None, 0
        if self.question is not None and self.question.notice.key == key:
            self.question = None

    def _attempt(self, kind: str, at_s: float, entry: Mapping[str, JsonValue]) -> None:
        queue = self.lanes.get(str(entry["lane"]), [])
        one = next((waiting for waiting in queue if waiting.message == entry["m"]), None)
        if one is None:
            return
        one.why, one.tried_s = str(entry.get("why", "")), at_s
        one.tries += 1
        if kind == "tried":
            one.refusals += bool(entry.get("final"))
            return
        queue.remove(one)
        if kind == "failed":
            self.failed.append(one)

    # -- what is due ------------------------------------------------------------------------------------------

    def may_at(self, key: str) -> float:
        """Return from when on a notice of this key may go, s."""
        state = self.keys.get(key)
        return state.last_s + WINDOW_S if state is not None else 0.0

    def held_due(self) -> dict[str, float]:
        """Return the keys with a notice that waits for its window's end, and when that is, s."""
        return {key: state.last_s + WINDOW_S for key, state in self.keys.items() if state.held is not None}

    def question_due(self) -> float | None:
        """Return when the open question is repeated next, s; None if it is not."""
        question = self.question
        if question is None or question.asked >= len(AGAIN_S):
            return None
        return max(question.since_s + AGAIN_S[question.asked], self.may_at(question.notice.key))

    def waiting(self) -> list[Waiting]:
        """Return all that waits, the oldest first."""
        return sorted((one for queue in self.lanes.values() for one in queue), key=lambda one: one.at_s)

    def foreign_question(self, service: str) -> str:
        """Return the key of a question that another life of the service has put, "" if there is none: it is over."""
        question = self.question
        return question.notice.key if question and not question.notice.number.startswith(f"{service}-") else ""


def kept(entries: Iterable[Mapping[str, JsonValue]], now_s: float) -> list[Mapping[str, JsonValue]]:
    """Return the records without those of settled notices older than ``KEPT_S``; the fold's waiting notices stay."""
    listed = list(entries)
    needed = {one.message for one in Mailing.of(listed).waiting()}

    def stays(entry: Mapping[str, JsonValue]) -> bool:
        if float(cast("float", entry.get("t", 0.0))) >= now_s - KEPT_S:
            return True
        if entry.get("k") == "note":
            number = cast("Mapping[str, JsonValue]", entry["n"])["number"]
            return f"{number}.{entry.get('asked', 0)}" in needed
        return entry.get("m") in needed

    return [entry for entry in listed if stays(entry)]
