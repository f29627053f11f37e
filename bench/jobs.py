"""Two jobs beside one: wall time of a run of four equal specimens, by `tester run` in a process of its own."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import yaml

from bench.child import run
from bench.effort import Effort, TopicFailedError
from bench.figures import Figure, at_least, ratio, unavailable
from bench.machine import usable_cpus
from bench.stopwatch import wall_ns
from recipes import find

SPECIMENS = 4
RATIO_LIMIT = 1.7
"""Limit for two jobs on four equal specimens: wall time of one job over that of two."""
RATIO = "one job over two jobs"
COMMAND = "import sys; from tester.cli.main import invoke; sys.exit(0 if invoke() in (0, 6) else 1)"
"""Every specimen ended, even if a condition has no value."""
TABLES = ("appendix.csv", "conditions.csv", "repeats.csv")


def measure(effort: Effort) -> list[Figure]:
    """Return both wall times and, run by run, their ratio. For an idle machine only: other work on its CPUs slows two
    jobs more than one.
    """
    if usable_cpus() < 2:
        return [unavailable(RATIO, "x", "a single CPU")]
    alone: list[float] = []
    together: list[float] = []
    with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        (folder / "recipe.yaml").write_text(four_specimens(effort.quick), encoding="utf-8")
        for number in range(effort.runs):
            alone.append(wall_s(folder, 1, number))
            together.append(wall_s(folder, 2, number))
            if tables(folder, 1, number) != tables(folder, 2, number):
                raise TopicFailedError("one job and two jobs gave different tables")
    short = "shortened: a load, two repeats, one minute of rest"
    note = short if effort.quick else "four loads, three temperatures, five repeats on each"
    return [
        Figure("four equal specimens, one job", "s", tuple(alone), note=note),
        Figure("four equal specimens, two jobs", "s", tuple(together)),
        ratio(RATIO, alone, together, at_least(RATIO_LIMIT)),
    ]


def four_specimens(shortened: bool) -> str:
    """Return a longer quickstart with its specimen four times; ``shortened``: fewer measurements."""
    recipe = yaml.safe_load(find("quickstart").read_text(encoding="utf-8"))
    recipe["specimens"] = [dict(recipe["specimens"][0]) for _ in range(SPECIMENS)]
    recipe["grids"][0]["load"] = ["100 N", "200 N", "300 N", "400 N"]
    recipe["grids"][0]["temperature"] = ["40 degC", "50 degC", "60 degC"]
    recipe["measure"] |= {"repeats": 5, "min_valid": 3}
    if shortened:
        recipe["grids"][0] |= {"load": "200 N", "temperature": "40 degC"}
        recipe["measure"] |= {"repeats": 2, "min_valid": 2}
        recipe["rest"]["at_least"] = "1 min"
    return yaml.safe_dump(recipe, sort_keys=False, allow_unicode=True)


def wall_s(folder: Path, jobs: int, number: int) -> float:
    """Run the recipe with so many jobs and return the wall time in s, including the start of the interpreter."""
    out = folder / f"{jobs}-{number}"
    begun = wall_ns()
    arguments = ["--yes", "--seed", "1", "--jobs", str(jobs), "--out", str(out)]
    run(["-c", COMMAND, "run", str(folder / "recipe.yaml"), *arguments])
    return (wall_ns() - begun) * 1e-9


def tables(folder: Path, jobs: int, number: int) -> list[bytes]:
    """Return the tables of a measured run."""
    (run_folder,) = (folder / f"{jobs}-{number}").iterdir()
    return [(run_folder / name).read_bytes() for name in TABLES]
