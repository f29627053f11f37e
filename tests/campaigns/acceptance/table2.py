"""Table 2 through the product, one compound a run: 55 conditions of five repeats, or a sample of them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import recipes
from tester.analysis import reference
from tests.campaigns.acceptance.bench import Bench, ProductError, Run, RunSpec
from tests.campaigns.acceptance.figure import Figure, at_most, equal, holds
from tests.campaigns.acceptance.topic import Topic

ROWS = {"1#": 55, "2#": 55, "3#": 50}
"""Minimum number of rows of the paper's table for each compound."""
SAMPLE_ROWS = 3
SURFACE_K = 0.7
ESTIMATE_PERCENT = 15.0
EXIT_DONE, EXIT_INCOMPLETE = 0, 6

SAMPLE = (
    (r"repeats: \d+", "repeats: 3"),
    (r"( +temperature): \[.*\]", r"\1: [40 degC]"),
    (r"( +load): \[.*\]", r"\1: [200 N, 400 N]"),
    (r"( +slip_velocity): \[.*\]", r"\1: [300 mm/s]"),
    (r"( +sideslip): \[.*\]", r"\1: [0 deg, 20 deg]"),
)
"""Reduces the 55 conditions to three: 200 N, 400 N, and 200 N at 20 deg of sideslip, all at 300 mm/s and 40 degC."""


def recipe_text(compound: str, full: bool) -> str:
    """Return the shipped recipe with one specimen only, shortened unless ``full``."""
    text = (recipes.FOLDER / "table2.yaml").read_text(encoding="utf-8")
    head, body, tail = re.split(r"(?<=^specimens:\n)((?:  .*\n)+)", text, maxsplit=1, flags=re.MULTILINE)
    specimens = re.findall(r"^  - (?:.*\n)(?:    .*\n)*", body, flags=re.MULTILINE)
    (kept,) = [one for one in specimens if f'compound: "{compound}"' in one]
    text = head + kept + tail
    for pattern, replacement in () if full else SAMPLE:
        text, count = re.subn(pattern, replacement, text)
        if not count:
            raise ProductError(f"recipes/table2.yaml has nothing like {pattern}")
    return text


class Campaign:
    """The recipe files and runs of the three compounds, written once for a bench."""

    def __init__(self) -> None:
        """Nothing is written yet."""
        self._specs: dict[Bench, dict[str, RunSpec]] = {}

    def specs(self, bench: Bench) -> dict[str, RunSpec]:
        """Return the run of each compound."""
        if bench not in self._specs:
            self._specs[bench] = {compound: self._spec(bench, compound) for compound in ROWS}
        return self._specs[bench]

    def _spec(self, bench: Bench, compound: str) -> RunSpec:
        path = bench.write(f"table2-{compound.rstrip('#')}.yaml", recipe_text(compound, bench.full))
        return RunSpec(str(path), 1)

    def runs(self, bench: Bench) -> list[RunSpec]:
        """Name the runs."""
        return list(self.specs(bench).values())

    def figures(self, bench: Bench) -> Iterator[Figure]:
        """Measure."""
        for compound, spec in self.specs(bench).items():
            plan = bench.json("plan", spec.recipe)
            run = bench.run(spec)
            yield from _figures(bench, compound, run, float(plan["rig_seconds"]), plan)


def _figures(bench: Bench, compound: str, run: Run, estimate_s: float, plan: dict[str, Any]) -> Iterator[Figure]:
    """Yield the figures of one compound's run."""
    planned = int(plan["conditions"]) - int(plan.get("references", 0))
    shown: dict[str, Any] = bench.json("show", str(run.folder))
    status = f"exit {run.outcome.code}, {shown['status']} {shown['reason']}".rstrip()
    ended = run.outcome.code in (EXIT_DONE, EXIT_INCOMPLETE)
    ended = ended and shown["status"] == "done"
    yield holds(f"{compound}: runs to its end, no trip", ended, status, "exit 0 or 6, done")
    rows = run.rows("appendix.csv")
    conditions = [one for one in run.rows("conditions.csv") if one["grid"] != reference.NAME]
    yield equal(f"{compound}: conditions", len(conditions), planned)
    least = ROWS[compound] if bench.full else SAMPLE_ROWS
    enough = len(rows) >= least
    yield holds(f"{compound}: rows of the paper's table", enough, f"{len(rows)} of {planned}", f"at least {least}")
    yield from _missing(compound, run, conditions)
    off = sorted((_surface_off(row), _setpoints(row)) for row in conditions if row["status"] == "ok")
    for worst, where in off[-1:]:
        name = f"{compound}: worst mean surface temperature of a row, off its setpoint"
        yield at_most(name, worst, SURFACE_K, "K", 2, note=f" ({where})")
    for beyond, where in (one for one in off if not one[0] <= SURFACE_K):
        yield at_most(f"{compound}: surface of {where}, off its setpoint", beyond, SURFACE_K, "K", 2)
    actual = float(shown["rig_seconds"])
    error = 100.0 * (actual / estimate_s - 1.0)
    words = f"{actual:.0f} s against {estimate_s:.0f} s planned: {error:+.1f} %"
    limit = f"differs by less than {ESTIMATE_PERCENT:g} %"
    yield holds(f"{compound}: rig time", abs(error) < ESTIMATE_PERCENT, words, limit)
    cpu_s = run.outcome.cpu_s
    words = f"{cpu_s:.0f} s, {actual / cpu_s:.0f} rig seconds in each"
    yield holds(f"{compound}: CPU time", True, words, "no limit here")


def _missing(compound: str, run: Run, conditions: list[dict[str, str]]) -> Iterator[Figure]:
    """Yield whether the output names each condition without a row, and its reason."""
    messages = run.outcome.stderr.splitlines()
    missing = [row for row in conditions if row["status"] != "ok"]
    named = 0
    for row in missing:
        where = _setpoints(row)
        line = next((text for text in messages if text.startswith(f"{where}: ")), "")
        reason = line.removeprefix(f"{where}: ")
        complete = row["status"] in reason and row["reason"] in reason and len(reason) > len(row["status"])
        named += complete
        yield holds(f"{compound}: missing {where}", complete, reason or "not on stderr", "is named with its reason")
    yield equal(f"{compound}: missing conditions that are named on stderr", named, len(missing))


def _setpoints(row: dict[str, str]) -> str:
    """Return a condition as `tester run` names it."""
    quantities = [f"{row['slip_velocity_mm_s']} mm/s", f"{row['load_n']} N", f"{row['sideslip_deg']}°"]
    return ", ".join([row["compound"], *quantities, f"{row['temperature_c']} °C"])


def _surface_off(row: dict[str, str]) -> float:
    return abs(float(row["measured_surface_c"] or "nan") - float(row["temperature_c"]))


_CAMPAIGN = Campaign()
TITLE = "each compound of Table 2 through `tester run`; three conditions a compound unless --full"
TOPIC = Topic("table2", TITLE, _CAMPAIGN.figures, _CAMPAIGN.runs)
