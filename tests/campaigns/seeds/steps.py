"""Planned and actual seconds of every step, and where the time of a condition goes.

`python -m tests.campaigns.seeds.steps RUN ...` reads run folders of one recipe (several seeds). Its output calibrates
the constants of the estimate (tester/kinds/wheel_on_belt/recipe/constants.py).
"""

from __future__ import annotations

import sqlite3
import sys
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from tester.inputs.recipe.plan import Plan
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.recipe.plan_steps import Cool, Install, WheelCondition
from tests.tester.inputs.recipe.texts import load_recipe


@dataclass(frozen=True, slots=True)
class Took:
    """One step of a run: total seconds; for a condition, soaking, sliding, and the time between pulses."""

    title: str
    seconds: float
    soak_s: float = 0.0
    sliding_s: float = 0.0
    repeats: int = 0

    @property
    def between_s(self) -> float:
        """Taring, loading and waiting for the temperature, s."""
        return self.seconds - self.soak_s - self.sliding_s if self.repeats else 0.0


def took(run: Path) -> list[Took]:
    """Return the steps of a stored run in order. Raises sqlite3.Error if the record cannot be read."""
    with closing(sqlite3.connect(f"{(run / 'run.db').resolve().as_uri()}?mode=ro", uri=True)) as store:
        begun = list(store.execute("SELECT t_s, text FROM event WHERE kind = 'step' ORDER BY sequence"))
        ended = "SELECT t_s FROM event WHERE kind = 'mode' AND text LIKE 'run -> %' ORDER BY t_s"
        ends = [t_s for (t_s,) in store.execute(ended)]
        repeats = list(store.execute("SELECT id, begun_s FROM repeat WHERE begun_s IS NOT NULL ORDER BY begun_s"))
        slid = dict(store.execute("SELECT repeat_id, sum(ended_s - started_s) FROM burst GROUP BY repeat_id"))
    marks = [t_s for t_s, _ in begun] + ends[-1:]
    found: list[Took] = []
    for (began_s, title), until_s in zip(begun, marks[1:], strict=False):
        # A part's cool-down is between its last step and the next part's first.
        end_s = min([until_s, *(end for end in ends if end > began_s)])
        mine = [(key, at_s) for key, at_s in repeats if began_s <= at_s < end_s]
        soak_s = mine[0][1] - began_s if mine else 0.0
        sliding_s = sum(slid.get(key, 0.0) for key, _ in mine)
        found.append(Took(title, end_s - began_s, soak_s, sliding_s, len(mine)))
    return found


def carried_out(plan: Plan) -> list[int]:
    """Return the places of the steps that a simulated run carries out: each specimen has a rig of its own, cool."""
    return [
        place
        for place, step in enumerate(plan.steps)
        if not (isinstance(step, Cool) and place + 1 < len(plan.steps) and isinstance(plan.steps[place + 1], Install))
    ]


def table(runs: list[Path]) -> list[str]:
    """Return one line per step: planned, median and range of the runs, then the times of a condition's median run."""
    rig = load_rig(str(runs[0] / "rig.yaml"), [])
    plan = expand(load_recipe(runs[0] / "recipe.yaml", PART).recipe, rig)
    figures = PART.estimate(plan, rig)
    stored = [took(run) for run in runs]
    lines = [f"{'planned':>8} {'median':>8} {'least':>7} {'most':>7}   soak sliding between  repeats"]
    for number, place in enumerate(carried_out(plan)):
        seen = sorted((steps[number] for steps in stored if len(steps) > number), key=lambda one: one.seconds)
        if not seen:
            continue
        middle = seen[len(seen) // 2]
        line = f"{figures.steps[place].seconds:8.0f} {median(one.seconds for one in seen):8.0f} "
        line += f"{seen[0].seconds:7.0f} {seen[-1].seconds:7.0f} "
        if isinstance(plan.steps[place], WheelCondition):
            line += f"{middle.soak_s:6.0f} {middle.sliding_s:7.0f} {middle.between_s:7.0f} {middle.repeats:8}  "
        else:
            line += " " * 33
        lines.append(line + middle.title)
    return lines


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("python -m tests.campaigns.seeds.steps RUN ...: folders of runs of one recipe")
    print("\n".join(table([Path(name) for name in sys.argv[1:]])))
