"""Decides what goes where and when: one notice a key and 10 minutes, repeated questions, the morning's message, and
attempts with growing delays, in order.

The caller passes the time (s since 1970) and may use threads: one that tends, and one for each channel.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta, tzinfo
from threading import Lock
from typing import Final

from pydantic import JsonValue

from tester.base.words import listed_some
from tester.notices.channels.letter import NotDeliveredError, NoticeChannel, letter_of, local_text
from tester.notices.mailing import Mailing, Waiting, kept
from tester.notices.notice import AGAIN_S, NOTE, WINDOW_S, NextNeeded, Notice, NoticeCause, NoticeOver
from tester.notices.notice_settings import NoticeSettings
from tester.notices.outbox_file import LARGE, Entry, OutboxFile, read_entries
from tester.notices.secrets_file import NoticeSecrets

DELAYS_S: Final = (30.0, 60.0, 120.0, 300.0, 600.0, 900.0)
"""Time from a failed attempt to the next one, s [A]; the last one from then on."""
REFUSALS: Final = 4
"""Number of final refusals after which a notice is given up, so that it does not block the ones behind it [A]."""
OLD_S: Final = 3.0 * 86400.0
"""Age at which a waiting notice is given up, s [A]: by then a person has been at the machine."""
LATE_S: Final = 600.0
"""Latest time after its hour at which a sender that has just started sends the morning's message, s [A]."""
IDLE_S: Final = 60.0
"""Longest time until the next look, s: settings may have changed."""


def reached(due_s: float, now_s: float, most_s: float) -> bool:
    """Return whether a time is reached; one further away than it can be shows that the wall clock was set back."""
    return not now_s < due_s <= now_s + most_s


def seconds_of(utc: str) -> float:
    """Return a time in ISO 8601 text as s since 1970."""
    return datetime.fromisoformat(utc).timestamp()


@dataclass(slots=True)
class LanePause:
    """The wait of an address after failed attempts."""

    failures: int = 0
    until_s: float = 0.0


@dataclass(slots=True)
class NoticeDispatch:
    """One outbox at work. ``service``: id of the service's life; ``zone``: of local times, by default the machine's."""

    file: OutboxFile
    service: str
    settings: NoticeSettings
    channels: Mapping[str, NoticeChannel]
    began_s: float
    secrets: NoticeSecrets = field(default_factory=NoticeSecrets)
    zone: tzinfo | None = None
    rig: str = ""
    mailing: Mailing = field(init=False)
    unsaved: list[Entry] = field(default_factory=list[Entry])
    """Records that the disk has refused so far."""
    next: NextNeeded = field(default_factory=lambda: NextNeeded(""))
    _pauses: dict[str, LanePause] = field(default_factory=dict[str, LanePause])
    _lock: Lock = field(default_factory=Lock)

    def __post_init__(self) -> None:
        """Read the outbox; leave out old records if it has grown large. Raises OSError."""
        entries: list[Mapping[str, JsonValue]] = list(read_entries(self.file.path))
        if self.file.size > LARGE:
            entries = kept(entries, self.began_s)
            self.file.replace(entries)
        self.mailing = Mailing.of(entries)
        if key := self.mailing.foreign_question(self.service):
            self._record("over", self.began_s, n=_plain(NoticeOver(f"{self.service}-begins", key)))

    # -- what comes in ----------------------------------------------------------------------------------------

    def take(self, note: Notice | NoticeOver | NextNeeded, now_s: float) -> None:
        """Take a note of the service: it is on the disk when this returns. A note that is known changes nothing."""
        with self._lock:
            if isinstance(note, NextNeeded):
                self.next = note
            elif note.number in self.mailing.known:
                return
            elif isinstance(note, NoticeOver):
                self._record("over", now_s, n=_plain(note))
            else:
                self._put(note, now_s)

    def _put(self, notice: Notice, now_s: float) -> None:
        if not reached(self.mailing.may_at(notice.key), now_s, WINDOW_S):
            self._record("held" if notice.again else "merged", now_s, n=_plain(notice))
        else:
            self._note(notice, now_s)

    def _note(self, notice: Notice, now_s: float, *, asked: int = 0, more: int = 0) -> None:
        lanes: list[JsonValue] = list(self.settings.lanes(notice.cause, second=asked >= len(AGAIN_S)))
        self._record("note", now_s, n=_plain(notice), to=lanes, asked=asked, more=more)

    def _record(self, kind: str, now_s: float, **further: JsonValue) -> None:
        """Append a record, and count it even where the disk refuses it; call with the lock held."""
        entry: Entry = {"k": kind, "t": now_s, **further}
        self.mailing.apply(entry)
        self.unsaved.append(entry)
        self._save()

    def _save(self) -> None:
        try:
            while self.unsaved:
                self.file.append(self.unsaved[0])
                del self.unsaved[0]
        except OSError as error:
            sys.stderr.write(f"notices: the outbox cannot be written: {error}\n")

    # -- what time brings -------------------------------------------------------------------------------------

    def tend(self, now_s: float) -> float:
        """Do what is due; return when to look again, s, at the latest ``IDLE_S`` from now."""
        with self._lock:
            self._save()
            mailing = self.mailing
            for key, due_s in mailing.held_due().items():
                state = mailing.keys[key]
                if state.held is not None and reached(due_s, now_s, WINDOW_S):
                    self._note(state.held, now_s, more=state.more)
            due_s, question = mailing.question_due(), mailing.question
            if due_s is not None and question is not None and reached(due_s, now_s, AGAIN_S[-1] + WINDOW_S):
                self._note(question.notice, now_s, asked=question.asked + 1)
            if self._morning_due(now_s):
                self._note(self._morning(now_s), now_s)
            for one in mailing.waiting():
                if one.at_s < now_s - OLD_S:
                    why = one.why or "its address is no longer in the settings"
                    self._record("failed", now_s, m=one.message, lane=one.lane, why=f"older than 3 days: {why}")
            return min([now_s + IDLE_S, *self._dues(now_s)])

    def _dues(self, now_s: float) -> list[float]:
        dues = [*self.mailing.held_due().values(), self.mailing.question_due(), self._morning_at(now_s) + 86400.0]
        return [due_s for due_s in dues if due_s is not None and due_s > now_s]

    def _morning_at(self, now_s: float) -> float:
        """Return the newest hour of the morning's message up to now, s."""
        now = datetime.fromtimestamp(now_s, UTC).astimezone(self.zone)
        at = datetime.combine(now.date(), self.settings.morning_at)
        for day in (at, at - timedelta(days=1)):
            due_s = (day.replace(tzinfo=self.zone) if self.zone else day).timestamp()
            if due_s <= now_s:
                return due_s
        raise AssertionError("yesterday's morning is over")

    def _morning_due(self, now_s: float) -> bool:
        due_s = self._morning_at(now_s)
        return due_s > self.mailing.morning_s and due_s > self.began_s - LATE_S

    def _morning(self, now_s: float) -> Notice:
        since_s = max(self.mailing.morning_s, now_s - 2.0 * 86400.0)
        by_outcome: dict[str, list[str]] = {"done": [], "short": []}
        for at_s, end in self.mailing.ends:
            if at_s > since_s:
                by_outcome.setdefault(end.outcome, []).append(end.run)
        counted = [
            f"{outcome}: {len(runs)}" + (f" ({listed_some(runs, 6)})" if runs else "")
            for outcome, runs in by_outcome.items()
        ]
        today = datetime.fromtimestamp(now_s, UTC).astimezone(self.zone).date().isoformat()
        question, expected = self.mailing.question, self.next
        if question is not None:
            todo, by = question.notice.what, f"now: it waits since {local_text(question.notice.since_utc, self.zone)}"
        elif expected.next_utc:
            at, waits = local_text(expected.next_utc, self.zone), seconds_of(expected.next_utc) <= now_s
            todo, by = expected.question, f"now: it waits since {at}" if waits else f"about {at}"
        else:
            todo, by = expected.question or "no question is expected", ""
        waiting = [one for one in self.mailing.waiting() if one.tries]
        late = f"; {len(waiting)} notices could not be sent yet" if waiting else ""
        return Notice(
            f"{self.service}-morning-{today}", NoticeCause.MORNING, f"morning {today}", "; ".join(counted) + late,
            datetime.fromtimestamp(since_s, UTC).isoformat(timespec="seconds"), expected.doing or "no run is under way",
            todo, by, self.rig,
        )  # fmt: skip

    # -- what goes out ----------------------------------------------------------------------------------------

    def attempt(self, channel: str, now_s: float) -> bool:
        """Try the oldest due notice of a channel's addresses; return whether there was one. This may block."""
        with self._lock:
            found = self._due(channel, now_s)
            if found is None:
                return False
            one, place = found
            sender, letter = self.channels[channel], letter_of(one, self.zone)
        try:
            sender.send(letter, place)
        except NotDeliveredError as error:
            with self._lock:
                self._failed(one, self.secrets.hidden(str(error)), error.final, now_s)
        else:
            with self._lock:
                self._pauses.pop(one.lane, None)
                self._record("sent", now_s, m=one.message, lane=one.lane)
        return True

    def _due(self, channel: str, now_s: float) -> tuple[Waiting, str] | None:
        """Return the oldest notice that may be tried now, with its address. An address gets its notices in order."""
        if channel not in self.channels:
            return None
        places = self.settings.every_lane
        due = [
            queue[0]
            for lane, queue in self.mailing.lanes.items()
            if queue
            and lane in places
            and lane.startswith(f"{channel}:")
            and reached(self._pauses.get(lane, LanePause()).until_s, now_s, DELAYS_S[-1])
        ]
        first = min(due, key=lambda one: one.at_s, default=None)
        return (first, places[first.lane]) if first is not None else None

    def _failed(self, one: Waiting, why: str, final: bool, now_s: float) -> None:
        pause = self._pauses.setdefault(one.lane, LanePause())
        pause.until_s = now_s + DELAYS_S[min(pause.failures, len(DELAYS_S) - 1)]
        pause.failures += 1
        if final and one.refusals + 1 >= REFUSALS:
            self._record("failed", now_s, m=one.message, lane=one.lane, why=why)
            self._pauses.pop(one.lane)
        else:
            self._record("tried", now_s, m=one.message, lane=one.lane, why=why, final=final)

    def next_attempt_s(self, channel: str, now_s: float) -> float:
        """Return when a channel should look again, s."""
        with self._lock:
            untils = [pause.until_s for lane, pause in self._pauses.items() if lane.startswith(f"{channel}:")]
        return min([now_s + IDLE_S, *(until_s for until_s in untils if until_s > now_s)])

    @property
    def idle(self) -> bool:
        """Whether nothing waits that has not been tried since this dispatch began."""
        with self._lock:
            places = self.settings.every_lane
            waiting = [queue[0] for lane, queue in self.mailing.lanes.items() if queue and lane in places]
        return not self.unsaved and all(one.tried_s >= self.began_s and one.tries for one in waiting)

    def change(
        self, settings: NoticeSettings, channels: Mapping[str, NoticeChannel], secrets: NoticeSecrets
    ) -> None:
        """Use other settings from now on; an address that is new in them is tried at once."""
        with self._lock:
            self.settings, self.channels, self.secrets = settings, channels, secrets
            self._pauses.clear()


def _plain(note: Notice | NoticeOver) -> dict[str, JsonValue]:
    plain: dict[str, JsonValue] = NOTE.dump_python(note, mode="json")
    return plain
