"""Runs of cases on the simulated rigs, and what their records say."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Final

from tester.analysis.flags import CHANGED, STICK_SLIP, THERMOMETER
from tester.results import results_of
from tester.run.session import Session, SessionOptions
from tester.store.reader import RunReader
from tests.campaigns.compiled.worker import Silent
from tests.campaigns.doubts.cases import STEP_PERCENT, WHEEL, Case

TRIES: Final = 8
"""So often a time is drawn until it lies inside the repeat that it is to lie in."""
LONGEST_S: Final = {WHEEL: 45.0, "pin-on-disc": 16.0}
"""Of a repeat, from its tare to its last sample, s."""
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
    """What a run said. ``inside``: friction changed while samples of the repeat in question counted."""

    case: Case
    code: int
    inside: bool
    conditions: tuple[Seen, ...] = field(default=())

    @property
    def told(self) -> bool:
        """Tell whether the run says of what was done to friction that its coefficients are in doubt."""
        case = self.case
        if case.hz:
            return bool(self.conditions) and all(STICK_SLIP in one.doubts for one in self.conditions)
        if case.repeat:
            return any(one.doubts for one in self.conditions if one.condition == case.condition)
        return any(one.doubts for one in self.conditions)

    @property
    def false(self) -> int:
        """Return in how many conditions of a steady run friction is said not to be."""
        return sum(any(doubt in OURS for doubt in one.doubts) for one in self.conditions)


def carry_out(case: Case) -> Found:
    """Run a case; one whose step is to lie within a repeat until it does."""
    random = Random(f"{case.topic} {case.rig} {case.seed}")
    for _ in range(TRIES):
        faults: tuple[str, ...] = ()
        if case.condition:
            after_s = f" + {random.uniform(3.0, LONGEST_S[case.rig]):.2f} s" if case.repeat else ""
            where = f"{case.condition}/{case.repeat}" if case.repeat else f"{case.condition}"
            faults = (f"condition {where}{after_s}: friction {100.0 + STEP_PERCENT:g} %",)
        found = _run(case, faults)
        if found.inside or not case.repeat:
            break
    return found


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
            begun = [one.t_s for one in reader.events() if one.kind == "injected"]
            inside = any(
                one.result.started_s < at_s < one.result.ended_s
                for one in reader.repeats()
                for at_s in begun
                if (one.condition, one.repeat) == (case.condition, case.repeat)
            )
            seen = [
                Seen(one.info.condition, one.result.ok, one.result.doubts, one.result.change_percent,
                     one.result.swing_percent, one.result.swing_hz)
                for one in results_of(reader).conditions()
            ]  # fmt: skip
    return Found(case, code, inside, tuple(seen))
