"""The commissioning engine in a thread of its own, and what the screen shows of it."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from dataclasses import dataclass
from threading import Thread

from tester.base import clock
from tester.base.source import InvalidSource
from tester.base.trouble import in_words
from tester.inputs.rig import Rig
from tester.machine.commission.commission_step import CommissionStep
from tester.machine.commission.record import CommissionRecord, RecordError, StepStanding, record_path, standing_of
from tester.machine.commission.step_engine import CommissionOutcome
from tester.machine.prompts import Question
from tester.run.commissioning import CommissionOptions, commission, part_of
from tester.run.endings import CannotStartError
from tester.store.record_schema import StoreError
from tester.tui.guide.guide_person import Live, ScreenPerson

REFUSALS = (CannotStartError, InvalidSource, RecordError, StoreError, OSError, sqlite3.Error)
"""Errors that stop commissioning and that a person can correct."""


@dataclass(frozen=True, slots=True)
class GuideView:
    """The data of the screen. ``now``: the step under way, "" if there is none; ``next``: the next step."""

    rig: str
    simulated: bool
    steps: tuple[StepStanding, ...]
    now: str
    next: str
    rig_s: dict[str, float]
    """Rig time that each step took, s."""
    live: Live | None
    question: Question | None
    messages: tuple[str, ...]
    running: bool
    outcome: CommissionOutcome | None
    trouble: str

    @property
    def stand(self) -> int:
        """Number of steps that are done."""
        return sum(step.stands is not None for step in self.steps)


class Guide:
    """Runs the engine, as often as the person wishes; the record determines where it resumes."""

    def __init__(self, load: Callable[[], Rig], options: CommissionOptions) -> None:
        """``load`` reads the rig file and raises InvalidSource."""
        self.options = options
        self.rig = load()
        self.steps: tuple[CommissionStep, ...] = part_of(self.rig).steps
        self.path = record_path(options.out, self.rig.name)
        self.person = ScreenPerson(time_stands=self.rig.can.interface == "sim")
        self.outcome: CommissionOutcome | None = None
        self.trouble = ""
        self.crash: BaseException | None = None
        """An error of the program itself, which is raised again when the screen ends."""
        self._load = load
        self._thread: Thread | None = None
        self._standing: tuple[StepStanding, ...] = ()
        self._now = ""
        self._read()

    @property
    def running(self) -> bool:
        """Whether the engine is running."""
        return self._thread is not None and self._thread.is_alive()

    @property
    def recipe_runs(self) -> bool:
        """Whether the step under way is running a recipe, which can be held."""
        return any(step.name == self._now and step.alone is not None for step in self.steps)

    @property
    def moving(self) -> bool:
        """Whether something may move: a step is under way and asks no question."""
        return self.running and bool(self._now) and self.person.asked is None

    def begin(self) -> None:
        """Read the rig file and begin; put an error into ``trouble``."""
        if self.running:
            return
        self.outcome, self.trouble = None, ""
        self.person.begin()
        try:
            self.rig = self._load()
            self.steps = part_of(self.rig).steps
            self.path = record_path(self.options.out, self.rig.name)
            self._read()
        except REFUSALS as error:
            self.trouble = in_words(error)
            return
        self._thread = Thread(target=self._work, name="commissioning")
        self._thread.start()

    def _work(self) -> None:
        try:
            self.outcome = commission(self.rig, self.options, self.person)
        except REFUSALS as error:
            self.trouble = in_words(error)
        except BaseException as error:  # noqa: BLE001 - shown at once, and raised again when the screen closes
            self.crash = error
            self.trouble = f"the program has failed: {type(error).__name__}: {error}"
        finally:
            self.person.end()

    def close(self) -> None:
        """STOP, and wait until the rig is at rest; raise the program's own error, if there was one."""
        thread = self._thread
        if thread is not None:
            while thread.is_alive():
                self.person.press()
                thread.join(0.2)
        if self.crash is not None:
            raise self.crash

    def view(self) -> GuideView:
        """Return the data of the screen."""
        person, running = self.person, self.running
        question = person.asked  # first: the engine records a step before it asks about the next
        if person.entries:
            person.entries.clear()
            self._read()
        return GuideView(
            self.rig.name,
            self.rig.simulated,
            self._standing,
            self._now if running else "",
            next((s.step.name for s in self._standing if s.stands is None and s.step.name != self._now), ""),
            {s.step.name: float(s.stands.values.get("rig_s", 0.0)) for s in self._standing if s.stands},
            person.live,
            question,
            tuple(person.messages),
            running,
            None if running else self.outcome,
            "" if running else self.trouble,
        )

    def on_record(self, step: str) -> str:
        """Return every entry of a step, newest first, in paragraphs."""
        lines: list[str] = []
        for entry in reversed(self._record().entries):
            if entry.step == step:
                lines.append(f"{entry.at[:19].replace('T', ' ')}  {entry.what}, by {entry.by}. {entry.text}")
                lines += [f"{name}  {value}" for name, value in entry.values.items()]
                lines.append("")
        return "\n".join(lines) or "This step has no record yet."

    def _record(self) -> CommissionRecord:
        return CommissionRecord(self.path, clock.utc_now, "")

    def _read(self) -> None:
        """Read which steps are done; raises RecordError, OSError."""
        record = self._record()
        self._standing = standing_of(record, self.steps, self.rig)
        under_way = record.entries[-1] if record.entries else None
        open_step = under_way is not None and under_way.what in ("begun", "reading")
        self._now = under_way.step if under_way is not None and open_step else ""
