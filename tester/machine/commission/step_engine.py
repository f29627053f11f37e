"""Runs the steps of a commissioning: skips those already done, runs the others, and records the results."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from enum import Enum
from typing import Any

from drivers.ports import BusLost
from tester.base import clock
from tester.base.keys import FAST_STOP, STOP
from tester.inputs.rig import Rig
from tester.machine.commission.commission_step import CommissionStep, Notes, RunRecipe, StepRefused, sections_sha256
from tester.machine.commission.person import Person, Walk
from tester.machine.commission.record import BEGUN, DONE, READING, REFUSED, CommissionRecord, RecordEntry
from tester.machine.prompts import Asks, Prompts, Question
from tester.machine.rig_ports import Ports
from tester.machine.tickers import POLL_S, TickedWorld, TickStatistics, run_real_time, run_simulated

STOPPED = "stopped by the operator"
STOPS = {STOP.command, FAST_STOP.command}


class Ended(Enum):
    """How commissioning ended."""

    DONE = "every step is done: the rig is commissioned"
    LEFT = "left before the end: it resumes at the first open step"
    REFUSED = "refused"
    FAILED = "failed"
    STOPPED = "stopped"


@dataclass(frozen=True, slots=True)
class CommissionOutcome:
    """The end of a commissioning: its way, its step and its message; ``took_s``: rig time of each step, s."""

    ended: Ended
    step: str = ""
    text: str = ""
    took_s: tuple[tuple[str, float], ...] = ()

    @property
    def rig_s(self) -> float:
        """Rig time of all steps, s."""
        return sum(seconds for _, seconds in self.took_s)


class Commissioning:
    """The commissioning of a rig, with its steps, person and record."""

    def __init__(
        self,
        steps: Sequence[CommissionStep],
        rig: Rig,
        person: Person,
        record: CommissionRecord,
        connect: Callable[[], tuple[Ports, TickedWorld | None, Any]],
        run_recipe: RunRecipe,
        lapse: float | None = None,
        given: Mapping[str, str] | None = None,
    ) -> None:
        """Store the parts; connect nothing yet.

        ``connect`` opens the wires once for each step (and starts the simulated rig with its attendant); it raises
        BusLost. ``lapse``: of simulated time, None for as fast as possible. ``given``: answers from the command line,
        by the question's key.
        """
        self.steps = tuple(steps)
        self.rig = rig
        self.person = person
        self.record = record
        self._took_s: list[tuple[str, float]] = []
        self._connect = connect
        self._run_recipe = run_recipe
        self._lapse = lapse
        self._given = dict(given or {})
        self._hashes: dict[tuple[str, ...], str] = {}
        """Of the sections that steps depend on: the rig's file does not change meanwhile."""
        self._rig_sha256 = hashlib.sha256(rig.text.encode()).hexdigest()
        self._walk: Walk | None = None
        self._stopped = False

    def stop(self, *, fast: bool = False) -> None:
        """Stop, also from a signal handler: abort the present step, and begin no other."""
        self._stopped = True
        if self._walk is not None:
            self._walk.stop(STOPPED, fast=fast)

    def run(self) -> CommissionOutcome:
        """Run the steps that are not done. Raises OSError if the record cannot be written."""
        for number, step in enumerate(self.steps, 1):
            label = f"{number}/{len(self.steps)} {step.title}"
            done = self.record.standing(step.name, self._sections(step))
            if done is not None:
                self.person.message(f"{label}: done ({done.at[:10]}, {done.by}): {done.text}")
                continue
            before = self.record.last(step.name)
            if before is not None and before.what == BEGUN:
                self.person.message(f"{label}: was cut off; it starts again")
            elif before is not None and before.what == DONE:
                self.person.message(f"{label}: the rig file has changed under it since {before.at[:10]}; done again")
            answer = self._ask(Question(f"begin {step.name}", f"{label}: begin?", Asks.CHOICE, ("yes", "no")))
            if self._stopped or answer != "yes":
                return self._outcome(Ended.STOPPED if self._stopped else Ended.LEFT, step)
            outcome = self._do(step)
            if outcome is not None:
                return outcome
        return CommissionOutcome(Ended.DONE, took_s=tuple(self._took_s))

    def _outcome(self, ended: Ended, step: CommissionStep, text: str = "") -> CommissionOutcome:
        return CommissionOutcome(ended, step.name, text, tuple(self._took_s))

    def _do(self, step: CommissionStep) -> CommissionOutcome | None:
        """Run a step; return the outcome if the step ends commissioning, None if the next step follows."""
        self._add(step, BEGUN)
        notes = Notes(
            self.person.message, lambda text, values: self._add(step, READING, text, values), self._done(), self._given
        )
        self._took_s.append((step.name, 0.0))
        try:
            failed = self._alone(step, notes) if step.seat is None else self._seated(step, notes)
        except StepRefused as refused:
            self._add(step, REFUSED, str(refused))
            self.person.message(f"REFUSED: {refused}")
            return self._outcome(Ended.REFUSED, step, str(refused))
        if failed:
            self._add(step, REFUSED, failed)
            self.person.message(f"FAILED: {failed}")
            return self._outcome(Ended.STOPPED if self._stopped else Ended.FAILED, step, failed)
        entry = self._add(step, DONE, notes.text, {**notes.values, "rig_s": round(self._took_s[-1][1], 1)})
        self.person.message(f"passed: {notes.text}")
        self.person.message(f"  on record: {entry.sha256}")
        return None

    def _alone(self, step: CommissionStep, notes: Notes) -> str:
        assert step.alone is not None
        step.alone(self.rig, self._run_recipe, notes)
        self._took_s[-1] = (step.name, float(notes.values.get("rig_s", 0.0)))
        return ""

    def _seated(self, step: CommissionStep, notes: Notes) -> str:
        """Run a step on the rig; return why it failed. Raises StepRefused."""
        assert step.seat is not None and step.procedure is not None
        with ExitStack() as opened:
            try:
                ports, world, hands = self._connect()
            except BusLost as lost:
                return str(lost)
            opened.callback(ports.close)
            seat = step.seat(self.rig, ports, hands)
            walk = self._walk = Walk(seat, step.procedure(seat, notes), self.person)
            try:
                self._tick(step, walk, world, ports)
            finally:
                self._walk = None
                self._took_s[-1] = (step.name, walk.now_s)
                if not walk.finished:
                    seat.abandon()
        if walk.error is not None:
            raise walk.error
        if self._stopped:
            return STOPPED
        reason = walk.lost or seat.reason
        return reason if reason or walk.ended else "the rig ended before the step did"

    def _tick(self, step: CommissionStep, walk: Walk, world: TickedWorld | None, ports: Ports) -> None:
        def poll(_now_s: float) -> None:
            self.person.look(step, walk)
            for command in self.person.commands():
                if command in STOPS:
                    self.stop(fast=command == FAST_STOP.command)

        if world is not None:
            run_simulated(walk, world, lapse=self._lapse, poll=poll)
        else:
            run_real_time(walk, None, poll=poll, statistics=TickStatistics(), pace=ports.pace)

    def _ask(self, question: Question) -> str:
        """Ask a question while no rig is running."""
        prompts = Prompts()
        prompt = prompts.put(question)
        while True:
            self.person.attend(prompts)
            self._stopped = self._stopped or not STOPS.isdisjoint(self.person.commands())
            if self._stopped or prompt.answer is not None:
                return prompt.answer or ""
            clock.sleep_until(clock.monotonic() + POLL_S)

    def _sections(self, step: CommissionStep) -> str:
        found = self._hashes.get(step.sections)
        if found is None:
            found = self._hashes[step.sections] = sections_sha256(self.rig, step.sections)
        return found

    def _done(self) -> dict[str, Mapping[str, Any]]:
        entries = {step.name: self.record.standing(step.name, self._sections(step)) for step in self.steps}
        return {name: entry.values for name, entry in entries.items() if entry is not None}

    def _add(
        self, step: CommissionStep, what: str, text: str = "", values: Mapping[str, Any] | None = None
    ) -> RecordEntry:
        sections = self._sections(step)
        entry = self.record.add(self.rig.name, self._rig_sha256, sections, step.name, what, text, values)
        self.person.entered(entry)
        return entry
