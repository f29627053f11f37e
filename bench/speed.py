"""Rig seconds per CPU second, everything on: plant, nodes, wires, drivers, control, executor, recorder, tables."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import yaml

from bench.effort import Effort, TopicFailedError
from bench.figures import Figure, at_least
from bench.live import SLIDING_RECIPE, live_run
from bench.stopwatch import cpu_seconds_of
from recipes import find
from tester.machine.run import Outcome
from tester.machine.tickers import collector_at_rest
from tester.run.reporter import ReportScreen
from tester.run.session import Session
from tester.run.session_options import SessionOptions

COMPOUND_LIMIT = 800.0
"""Limit for one compound of Table 2, rig s per CPU s; 1,500 is the stretch goal."""
FLAT_LIMIT = 300.0
"""Limit for the flat 100 Hz tick while sliding, rig s per CPU s."""


class QuietScreen(ReportScreen):
    """A session's screen that shows nothing: prompts are answered with yes."""

    answer_yes = True


def measure(effort: Effort) -> list[Figure]:
    """Return the speed of whole runs, from recipe to tables, and of a sliding phase."""
    compound = one_compound(effort.quick)
    short = "shortened: a load, a temperature, two repeats" if effort.quick else "stretch 1,500"
    quickstart = find("quickstart").read_text(encoding="utf-8")
    return [
        Figure("quickstart", "rig s/CPU s", tuple(session_speed(quickstart) for _ in range(effort.runs))),
        Figure(
            "one compound of Table 2",
            "rig s/CPU s",
            tuple(session_speed(compound) for _ in range(effort.runs)),
            at_least(COMPOUND_LIMIT),
            short,
        ),
        Figure(
            "flat 100 Hz tick while sliding",
            "rig s/CPU s",
            tuple(sliding_speeds(effort.pick(60.0, 15.0), effort.runs)),
            at_least(FLAT_LIMIT),
        ),
    ]


def one_compound(shortened: bool) -> str:
    """Return the recipe of Table 2 with its first specimen alone; ``shortened``: also two repeats of one condition."""
    recipe = yaml.safe_load(find("table2").read_text(encoding="utf-8"))
    recipe["specimens"] = recipe["specimens"][:1]
    if shortened:
        recipe["grids"] = [{**recipe["grids"][0], "load": "200 N", "temperature": "40 degC"}]
        recipe["measure"] |= {"repeats": 2, "min_valid": 2}
    return yaml.safe_dump(recipe, sort_keys=False, allow_unicode=True)


def session_speed(text: str) -> float:
    """Run a recipe like ``tester run --yes --seed 1`` and return rig seconds per CPU second."""
    with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as folder:
        recipe = Path(folder) / "recipe.yaml"
        recipe.write_text(text, encoding="utf-8")
        session = Session(SessionOptions(recipe=str(recipe), out=Path(folder) / "runs", seed=1), QuietScreen())
        cpu_s = cpu_seconds_of(session.run)
    run = session.run_
    if run is None or run.outcome is not Outcome.DONE:
        raise TopicFailedError("the run did not begin" if run is None else f"{run.outcome.value}: {run.reason}")
    return run.engine.ctx.now / cpu_s


def sliding_speeds(seconds: float, runs: int) -> list[float]:
    """Return rig seconds per CPU second of stretches of one long slip pulse."""
    speeds: list[float] = []
    with live_run(SLIDING_RECIPE) as live:
        for _ in range(runs):
            live.slide(seconds)
            before, scans = live.now, live.engine.scans
            with collector_at_rest():
                cpu_s = cpu_seconds_of(lambda: live.advance(seconds))
            elapsed = live.now - before
            rate = (live.engine.scans - scans) / elapsed
            if not live.sliding or rate < 95.0:
                raise TopicFailedError(f"not sliding throughout: {rate:.0f} scans a second")
            speeds.append(elapsed / cpu_s)
    return speeds
