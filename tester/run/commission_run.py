"""Runs a recipe within commissioning: an ordinary run, whose results are returned as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from tester.analysis.schemes import misalignment
from tester.base.words import finite
from tester.machine.commission.commission_step import StepRefused
from tester.machine.commission.person import Person
from tester.machine.context import Progress
from tester.machine.prompts import Prompts
from tester.machine.time_left import RunPosition
from tester.results.run_results import results_of
from tester.run.reporter import ReportScreen
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.run_reader import RunReader


class PersonScreen(ReportScreen):
    """Shows a run to the person who commissions."""

    def __init__(self, person: Person, *, answer_yes: bool) -> None:
        """``answer_yes``: the simulated person does what each prompt asks."""
        self.person = person
        self.answer_yes = answer_yes
        self.can_ask = not answer_yes
        self._title = ""

    def begin(self, name: str) -> None:
        """Report that the run begins."""
        self.person.message(f"  run {name}")

    def show(self, now_s: float, run: Progress, at: RunPosition) -> None:
        """Report each step as it begins."""
        if run.title != self._title:
            self._title = run.title
            self.person.message(f"  {100 * at.share:3.0f} %  {run.title}")

    def attend(self, prompts: Prompts) -> None:
        """Let the person answer the prompts."""
        self.person.attend(prompts)

    def commands(self) -> list[str]:
        """Return the person's commands."""
        return self.person.commands()

    def message(self, text: str) -> None:
        """Show the message."""
        self.person.message(f"  {text}")


def run_recipe(options: SessionOptions, folder: Path, person: Person, name: str, text: str) -> Mapping[str, Any]:
    """Run a recipe and return its results; ``options`` name the rig. Raises StepRefused if it did not complete,
    CannotStartError.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}.yaml"
    path.write_text(text, encoding="utf-8")
    screen = PersonScreen(person, answer_yes=person.scripted)
    session = Session(replace(options, recipe=str(path)), screen)
    code = session.run()
    ending, where = session.ending, session.folder
    if ending is None or where is None:
        raise StepRefused(f"the recipe {name} was not run (exit code {code})")
    with RunReader(where) as reader:
        results = results_of(reader)
        measured = [row.result for row in results.rows]
        rig_s = results.run.rig_seconds
    if code:
        why = ending.reason or "a condition is without a value"
        raise StepRefused(f"the run {where.name} ended with {ending.outcome.value}: {why}")
    angle = misalignment(measured)
    conditions = [
        {
            "mu": row.mu, "s": finite(row.s), "n": row.n_valid, "expanded": finite(row.budget.expanded),
            "difference_percent": finite(row.both_ways.difference_percent) if row.both_ways is not None else None,
        }
        for row in measured
    ]  # fmt: skip
    return {
        "run": where.name, "rig_s": rig_s, "conditions": conditions, "angle_deg": finite(angle.deg),
        "angle_expanded_deg": finite(angle.expanded_deg),
    }  # fmt: skip
