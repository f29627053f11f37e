"""A recipe of 100,000 conditions: read, checked, expanded, planned; in interpreters of their own for the memory."""

from __future__ import annotations

import json
import sys
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

from bench.child import peak_memory_mb, run
from bench.effort import Effort, TopicFailedError
from bench.figures import Figure, Limit, at_most, unavailable
from bench.stopwatch import cpu_ns
from tester.kinds.wheel_on_belt.recipe.part import PART

CONDITIONS = 100_000
CHECK_LIMIT_S = 1.0
PLAN_LIMIT_S = 5.0
MEMORY_LIMIT_MB = 300.0

PLAN = """\
import os, sys
from contextlib import redirect_stdout
from bench.child import peak_memory_mb
from bench.stopwatch import cpu_ns
from tester.cli.main import invoke
with open(os.devnull, "w", encoding="utf-8") as sink, redirect_stdout(sink):
    code = invoke(["plan", *sys.argv[1:]])
print(cpu_ns() * 1e-9, peak_memory_mb() or 0.0)
sys.exit(code)
"""
"""``tester plan`` that ends with its CPU seconds, the interpreter's start included, and its peak memory in MB."""


def measure(effort: Effort) -> list[Figure]:
    """Return the CPU time of the parts and of the whole command, and its peak memory."""
    size = effort.pick(CONDITIONS, CONDITIONS // 10)
    share = size / CONDITIONS
    name = f"{size:,} conditions"
    figures: list[Figure] = []
    for kind, text in (("axes", recipe_text(size)), ("a long list", long_list_text(size))):
        parts = _parts(kind, size, effort.runs)
        both = tuple(a + b for a, b in zip(parts["check"], parts["conditions"], strict=True))
        figures += [
            Figure(f"{name}, {kind}: read and checked", "s CPU", parts["check"], note=f"{len(text) / 1000:.0f} kB"),
            Figure(f"{name}, {kind}: expanded", "s CPU", parts["conditions"]),
            Figure(f"{name}, {kind}: both", "s CPU", both, at_most(CHECK_LIMIT_S * share)),
            Figure(f"{name}, {kind}: steps, with wear and wheels", "s CPU", parts["steps"]),
        ]
    # The start of the interpreter does not shrink with the recipe: a short measurement has no limit.
    limit = None if effort.quick else at_most(PLAN_LIMIT_S)
    for option in ("", "--json"):
        figures += _command(option, size, effort.runs, limit)
    return figures


def recipe_text(conditions: int) -> str:
    """Return a recipe of that many conditions (a multiple of 2000): slips, loads and temperatures within a rig's
    range."""
    slips = ", ".join(f"{50 + i} mm/s" for i in range(conditions // 2000))
    loads = ", ".join(f"{100 + i} N" for i in range(100))
    temperatures = ", ".join(f"{30 + 2 * i} degC" for i in range(20))
    return _recipe(slips, loads, temperatures)


def long_list_text(conditions: int) -> str:
    """Return a recipe of that many conditions (a multiple of 5), mostly one list of loads."""
    slips = ", ".join(f"{50 + i} mm/s" for i in range(5))
    loads = ", ".join(f"{100 + i / 100} N" for i in range(conditions // 5))
    return _recipe(slips, loads, "40 degC")


def _recipe(slips: str, loads: str, temperatures: str) -> str:
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


def work(text: str) -> dict[str, float]:
    """Read, check and expand a recipe; return CPU seconds of each, and the number of conditions."""
    from tester.inputs.recipe.conditions import conditions_of
    from tester.inputs.recipe.loader import load_checked
    from tester.kinds import load_rig
    from tester.kinds.wheel_on_belt.recipe.expand import expand

    rig = load_rig("sim")
    load_checked(recipe_text(2000), rig, PART, "few.yaml")  # the first recipe creates the validator
    marks = [cpu_ns()]
    loaded = load_checked(text, rig, PART, "many.yaml")
    marks.append(cpu_ns())
    found = len(conditions_of(loaded.recipe, PART.settings))
    marks.append(cpu_ns())
    expand(loaded.recipe, rig)
    marks.append(cpu_ns())
    checking, expanding, steps = ((b - a) * 1e-9 for a, b in pairwise(marks))
    return {"found": found, "check": checking, "conditions": expanding, "steps": steps}


def _parts(kind: str, size: int, runs: int) -> dict[str, tuple[float, ...]]:
    """Return the measurement of ``work``, one value per run."""
    found: list[dict[str, float]] = []
    for _ in range(runs):
        found.append(json.loads(run(["-m", "bench.big_recipe", kind, str(size)])))
        if found[-1]["found"] != size:
            raise TopicFailedError(f"{found[-1]['found']} conditions instead of {size}")
    return {name: tuple(one[name] for one in found) for name in found[0]}


def _command(option: str, size: int, runs: int, limit: Limit | None) -> list[Figure]:
    """Return CPU seconds and peak memory of ``tester plan``."""
    with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as folder:
        path = Path(folder) / "many.yaml"
        path.write_text(recipe_text(size), encoding="utf-8")
        call = ["-c", PLAN, str(path), *([option] if option else [])]
        found = [[float(word) for word in run(call).split()] for _ in range(runs)]
    name = f"{size:,} conditions: {' '.join(['tester plan', option]).strip()}"
    figures = [Figure(name, "s CPU", tuple(seconds for seconds, _ in found), limit, "from the interpreter's start")]
    if peak_memory_mb() is None:
        return [*figures, unavailable(f"{name}, peak memory", "MB", "this system does not tell")]
    return [*figures, Figure(f"{name}, peak memory", "MB", tuple(mb for _, mb in found), at_most(MEMORY_LIMIT_MB))]


if __name__ == "__main__":
    make = long_list_text if sys.argv[1] == "a long list" else recipe_text
    print(json.dumps(work(make(int(sys.argv[2])))))
