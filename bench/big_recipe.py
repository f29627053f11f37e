"""A recipe of 100,000 conditions: read, expanded and checked, planned; in an interpreter of its own for the memory."""

from __future__ import annotations

import json
import sys
from itertools import pairwise

from bench.child import peak_memory_mb, run
from bench.effort import Effort, TopicFailedError
from bench.figures import Figure, at_most, unavailable
from bench.stopwatch import cpu_ns

CONDITIONS = 100_000
CHECK_LIMIT_S = 1.0
PLAN_LIMIT_S = 5.0
MEMORY_LIMIT_MB = 300.0


def measure(effort: Effort) -> list[Figure]:
    """Return the CPU time of the parts and the peak memory of the process."""
    size = effort.pick(CONDITIONS, CONDITIONS // 10)
    share = size / CONDITIONS
    found: list[dict[str, float | None]] = []
    for _ in range(effort.runs):
        found.append(json.loads(run(["-m", "bench.big_recipe", str(size)])))
        if found[-1]["conditions"] != size:
            raise TopicFailedError(f"{found[-1]['conditions']} conditions instead of {size}")

    def column(name: str) -> tuple[float, ...]:
        return tuple(value for one in found if (value := one[name]) is not None)

    parsed, checked, expanded, planned = (column(name) for name in ("parse", "check", "expand", "plan"))
    both = tuple(a + b for a, b in zip(checked, expanded, strict=True))
    memory = column("memory")
    name = f"{size:,} conditions"
    figures = [
        Figure(f"{name}: parsed", "s CPU", parsed),
        Figure(f"{name}: checked against the rig", "s CPU", checked, note="parsing not included"),
        Figure(f"{name}: expanded", "s CPU", expanded),
        Figure(f"{name}: checked and expanded", "s CPU", both, at_most(CHECK_LIMIT_S * share)),
        Figure(f"{name}: planned with estimate", "s CPU", planned, at_most(PLAN_LIMIT_S * share)),
    ]
    if memory:
        return [*figures, Figure(f"{name}: peak memory", "MB", memory, at_most(MEMORY_LIMIT_MB))]
    return [*figures, unavailable(f"{name}: peak memory", "MB", "this system does not tell")]


def recipe_text(conditions: int) -> str:
    """Return a recipe of that many conditions (a multiple of 2000): slips, loads and temperatures that a rig can do."""
    slips = ", ".join(f"{50 + i} mm/s" for i in range(conditions // 2000))
    loads = ", ".join(f"{100 + i} N" for i in range(100))
    temperatures = ", ".join(f"{30 + 2 * i} degC" for i in range(20))
    return f"""\
recipe: many conditions
specimens:
  - compound: "1#"
pre_grind: {{wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 min}}
rest: {{at_least: 20 min, until: 25 degC, within: 2 degC}}
measure:
  wheel_speed: 0.8 m/s
  repeats: 5
grids:
  - name: all
    slip_velocity: [{slips}]
    load: [{loads}]
    temperature: [{temperatures}]
"""


def work(conditions: int) -> dict[str, float | None]:
    """Read, check, expand and plan; return CPU seconds of each, the conditions found and the peak memory in MB."""
    from tester.recipe.check import load_checked
    from tester.recipe.estimate import Estimator, estimate
    from tester.recipe.expand import conditions_of, expand
    from tester.recipe.loader import load_recipe
    from tester.rig import load_rig

    text = recipe_text(conditions)
    rig = load_rig("sim")
    marks = [cpu_ns()]
    load_recipe(text, "many.yaml")
    marks.append(cpu_ns())
    loaded = load_checked(text, rig, "many.yaml")
    marks.append(cpu_ns())
    found = len(conditions_of(loaded.recipe))
    marks.append(cpu_ns())
    estimator = Estimator(rig)
    estimate(expand(loaded.recipe, rig, estimator), rig, estimator)
    marks.append(cpu_ns())
    parse, both, expanding, planning = ((b - a) * 1e-9 for a, b in pairwise(marks))
    return {
        "conditions": found,
        "parse": parse,
        "check": max(0.0, both - parse),
        "expand": expanding,
        "plan": planning,
        "memory": peak_memory_mb(),
    }


if __name__ == "__main__":
    print(json.dumps(work(int(sys.argv[1]))))
