"""Runs of cases on the simulated rigs, and the content of their records."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import nan
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Final

from tester.analysis.flags import CHANGED, STICK_SLIP, THERMOMETER
from tester.results.run_results import results_of
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.run_reader import RunReader
from tests.campaigns.compiled.worker import Silent
from tests.campaigns.doubts.cases import STEP_PERCENT, Case

OURS: Final = (CHANGED, STICK_SLIP, THERMOMETER)


@dataclass(frozen=True, slots=True)
class Seen:
    """A condition: its number, its doubts, the greatest change and swing."""

    condition: int
    valued: bool
    doubts: tuple[str, ...]
    change_percent: float
    swing_percent: float
    swing_hz: float


@dataclass(frozen=True, slots=True)
class Found:
    """What a run reported. ``span_s``: rig times of the first and the last sample of the case's repeat; NaN without
    one."""

    case: Case
    code: int
    span_s: tuple[float, float]
    conditions: tuple[Seen, ...] = field(default=())

    @property
    def reported(self) -> bool:
        """Return whether the run doubts the coefficients affected by the change of friction."""
        case = self.case
        if case.hz:
            return bool(self.conditions) and all(STICK_SLIP in one.doubts for one in self.conditions)
        if case.repeat:
            return any(one.doubts for one in self.conditions if one.condition == case.condition)
        return any(one.doubts for one in self.conditions)

    @property
    def false(self) -> int:
        """Return how many conditions of a steady run are reported as unsteady."""
        return sum(any(doubt in OURS for doubt in one.doubts) for one in self.conditions)


def carry_out(case: Case) -> Found:
    """Run a case. If its step lies within a repeat, a run without the step first gives the times of that repeat's
    samples."""
    if not case.condition:
        return _run(case, ())
    when = f"condition {case.condition}"
    if case.repeat:
        begins_s, ends_s = _run(case, ()).span_s
        when = f"t={Random(f'{case.topic} {case.rig} {case.seed}').uniform(begins_s, ends_s):.2f} s"
    return _run(case, (f"{when}: friction {100.0 + STEP_PERCENT:g} %",))


def _run(case: Case, faults: tuple[str, ...]) -> Found:
    with TemporaryDirectory(prefix="doubts-") as name:
        recipe = Path(name) / "doubts.yaml"
        recipe.write_text(case.recipe, encoding="utf-8")
        screen = Silent()
        options = SessionOptions(
            str(recipe), case.rig, case.overrides, out=Path(name), seed=case.seed, faults=faults, samples=False
        )
        session = Session(options, screen)
        code = session.run()
        if session.folder is None:
            raise RuntimeError(" ".join(screen.messages))
        with RunReader(session.folder) as reader:
            spans = [
                (one.result.started_s, one.result.ended_s)
                for one in reader.repeats()
                if (one.condition, one.repeat) == (case.condition, case.repeat)
            ]
            seen = [
                Seen(one.info.condition, one.result.ok, one.result.doubts, one.result.change_percent,
                     one.result.swing_percent, one.result.swing_hz)
                for one in results_of(reader).conditions()
            ]  # fmt: skip
    return Found(case, code, spans[0] if spans else (nan, nan), tuple(seen))
