"""Notes and exclusions on the run under way: checked beside the scan, written by the run's own writer, on record."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Final, NamedTuple

from pydantic import JsonValue

from tester import __version__
from tester.base import clock
from tester.base.trouble import TroubleError
from tester.results.exclude import Word, targets_of
from tester.run.folder import PARTS
from tester.service.commands import AddNote, ExcludeRepeat, RunEdit
from tester.service.service_link import Order
from tester.service.state_publisher import Desk
from tester.store.journal_records import StoredExclusion
from tester.store.notes import NOTE, RunNote, checked, data_of, words_of
from tester.store.recorder import Recorder
from tester.store.sql import Ticket

MOST: Final = 8
"""Edits that wait; a further one is refused."""
Write = Callable[[], tuple[Ticket, JsonValue]]
"""Puts an edit into the record's queue; returns its ticket and the order's result."""


class _Writing(NamedTuple):
    """An edit that the writer has: it is accepted once it is on disk."""

    order: Order
    run: str
    ticket: Ticket
    result: JsonValue


@dataclass
class RunEdits:
    """One edit after the other: reading what it refers to takes a thread, so that no scan waits for the disk."""

    desk: Desk
    _waiting: deque[Order] = field(default_factory=deque[Order])
    _thread: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1, thread_name_prefix="edits"))
    _checked: tuple[Order, Future[Write]] | None = None
    _writing: _Writing | None = None

    def obey(self, order: Order) -> None:
        """Take an edit, or refuse it with the reason."""
        refusal = self._refusal(order.action.run if isinstance(order.action, RunEdit) else "")
        if not refusal and len(self._waiting) >= MOST:
            refusal = "too many notes and exclusions at once: wait for their answers"
        if refusal:
            self.desk.gateway.refuse(order, refusal)
        else:
            self._waiting.append(order)

    def look(self) -> None:
        """Carry on with what is waiting; call between two ticks."""
        if self._writing is not None:
            self._answer(self._writing)
        elif self._checked is not None:
            self._write(*self._checked)
        elif self._waiting:
            order = self._waiting.popleft()
            self._checked = order, self._thread.submit(self._check, order, self._folder())

    def _folder(self) -> Path:
        return Path(self.desk.run.folder) if self.desk.run is not None else Path()

    def _refusal(self, run: str) -> str:
        """Return why a run cannot be edited here; "" if it can."""
        desk = self.desk
        if desk.watch is None or desk.hand is not None or desk.run is None or desk.run.name != run:
            return f"{run} is not under way here"
        return ""

    def _check(self, order: Order, folder: Path) -> Write:
        """Return what writes an edit. Raises TroubleError, ValueError, OSError. In the thread."""
        action = order.action
        if isinstance(action, AddNote):
            note = checked(RunNote(clock.utc_now(), order.by, action.text.strip(), action.tags))
            return partial(self._note, note)
        assert isinstance(action, ExcludeRepeat)
        if (folder / PARTS).is_dir():
            raise TroubleError("this simulated run is recorded in parts: exclude the repeat after its end")
        word = Word(action.condition, action.repeat, not action.include, action.reason.strip(), order.by)
        return partial(self._exclude, word, targets_of(folder, word))

    def _write(self, order: Order, work: Future[Write]) -> None:
        """Hand a checked edit to the run's writer, or refuse it."""
        if not work.done():
            return
        self._checked = None
        action = order.action
        run = action.run if isinstance(action, RunEdit) else ""
        try:
            write = work.result()
        except (TroubleError, ValueError, OSError) as error:
            self.desk.gateway.refuse(order, str(error))
            return
        if refusal := self._refusal(run):
            self.desk.gateway.refuse(order, refusal)
        else:
            self._writing = _Writing(order, run, *write())

    def _answer(self, written: _Writing) -> None:
        """Answer an edit once it is on disk."""
        if written.ticket.done:
            self.desk.gateway.accept(written.order, written.result)
        elif (why := self._refusal(written.run)) or (why := self._journal().failed or ""):
            self.desk.gateway.refuse(written.order, f"it may not be on record: {why}")
        else:
            return
        self._writing = None

    def _journal(self) -> Recorder:
        assert self.desk.watch is not None
        return self.desk.watch.run.engine.ctx.journal

    def _note(self, note: RunNote) -> tuple[Ticket, JsonValue]:
        journal = self._journal()
        journal.event(self.desk.now_s, NOTE, words_of(note), data=data_of(note))
        return journal.flush(), None

    def _exclude(self, word: Word, targets: list[tuple[int, int, int]]) -> tuple[Ticket, JsonValue]:
        journal, verb = self._journal(), "excluded" if word.excluded else "included again"
        for condition, repeat, attempt in targets:
            journal.decision(
                StoredExclusion(0, condition, repeat, attempt, int(word.excluded), word.reason, word.operator,
                                clock.utc_now(), __version__, "")
            )  # fmt: skip
            what = f"condition {condition}, repeat {repeat} {verb} by {word.operator}: {word.reason}"
            journal.event(self.desk.now_s, "exclusion", what, "warning")
        return journal.flush(), {"repeats": len(targets)}
