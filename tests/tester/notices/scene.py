"""An outbox in virtual time, with a real relay or a channel played by a test."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime, tzinfo
from pathlib import Path

from tester.notices.channels.every_channel import channels_of
from tester.notices.channels.letter import Letter, NotDeliveredError, NoticeChannel
from tester.notices.dispatch import NoticeDispatch
from tester.notices.notice import NextNeeded, Notice, NoticeCause, NoticeOver
from tester.notices.notice_settings import MailSection, NoticeSettings
from tester.notices.outbox_file import OutboxFile
from tester.notices.secrets_file import NoticeSecrets

NOON_S = datetime(2026, 3, 3, 12, 0, tzinfo=UTC).timestamp()
ANNA, HEAD = "anna@lab.example", "head@lab.example"
NOTICE = Notice("s1-1", NoticeCause.TRIP, "trip overload", "overload: 900 N above 800 N", "2026-03-03T12:00:00Z",
                "it is at rest", "look, then acknowledge", "no deadline", "rig 2", "run-1", "/runs/run-1")  # fmt: skip


def notice(number: int, cause: NoticeCause = NoticeCause.TRIP, key: str = "", **fields: object) -> Notice:
    """Return a notice, by default with a key of its own."""
    made = replace(NOTICE, number=f"s1-{number}", cause=cause, key=key or f"key {number}", what=f"text {number}")
    return replace(made, **fields)  # type: ignore[arg-type]


def mail_settings(port: int, **fields: object) -> NoticeSettings:
    """Return settings with mail over loopback."""
    mail = {"relay": "127.0.0.1", "port": port, "security": "none", "from": "rig@lab.example", "to": [ANNA],
            "second": [HEAD]}  # fmt: skip
    return NoticeSettings(mail=MailSection.model_validate(mail | fields))


class PlayedChannel:
    """Keeps what it takes; ``fails`` returns the error of the next attempt, or None."""

    def __init__(self, fails: Callable[[], NotDeliveredError | None] = lambda: None) -> None:
        self.fails = fails
        self.taken: list[tuple[str, Letter]] = []
        self.attempts = 0

    def send(self, letter: Letter, place: str) -> None:
        self.attempts += 1
        error = self.fails()
        if error is not None:
            raise error
        self.taken.append((place, letter))

    @property
    def subjects(self) -> list[str]:
        return [letter.subject for _, letter in self.taken]


class OutboxScene:
    """One outbox; ``pass_time`` advances the clock and does everything due."""

    def __init__(
        self, folder: Path, settings: NoticeSettings, *, channel: NoticeChannel | None = None,
        secrets: NoticeSecrets | None = None, now_s: float = NOON_S, service: str = "s1", zone: tzinfo = UTC,
        file: OutboxFile | None = None,
    ) -> None:  # fmt: skip
        self.now_s = now_s
        self.file = file or OutboxFile(folder / "outbox")
        channels = {"mail": channel} if channel is not None else channels_of(settings, secrets or NoticeSecrets())
        self.dispatch = NoticeDispatch(
            self.file, service, settings, channels, now_s, secrets or NoticeSecrets(), zone, "rig 2"
        )

    def take(self, note: Notice | NoticeOver | NextNeeded) -> None:
        self.dispatch.take(note, self.now_s)
        self.work()

    def work(self) -> None:
        """Try everything due now."""
        for channel in tuple(self.dispatch.channels):
            while self.dispatch.attempt(channel, self.now_s):
                pass

    def pass_time(self, seconds: float) -> None:
        """Go from one due time to the next."""
        until_s = self.now_s + seconds
        while self.now_s < until_s:
            due_s = self.dispatch.tend(self.now_s)
            self.work()
            dues = [self.dispatch.next_attempt_s(channel, self.now_s) for channel in self.dispatch.channels]
            self.now_s = min(until_s, max(min([due_s, *dues]), self.now_s + 0.001))
        self.dispatch.tend(self.now_s)
        self.work()

    def close(self) -> None:
        self.file.close()
