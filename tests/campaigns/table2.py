"""`python -m tests.campaigns.table2 [--sample] [--seeds N] [--jobs N]`: the uncertainty of the whole Table 2.

The packaged recipe, on the simulated rig. Every row with a value and without a doubt has a U of this wheel of at most 8
%, and few rows have a doubt. Also prints how many intervals contain the rig's truth (model x condition x wheel,
``sim.record_truth``): rows of a seed share the errors of a session's sensors, so that count is not binomial. Prints a
line a figure and exits 1 where one misses. A seed takes five minutes of processor time, compiled.
"""

from __future__ import annotations

import argparse
import re
import sqlite3
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing
from functools import partial
from math import isfinite
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final, NamedTuple

import recipes
from tester.base.axes import condition_words
from tester.results.run_results import results_of
from tester.results.table_rows import TableRow
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.run_reader import RunReader
from tests.campaigns.acceptance.figure import Figure, at_least, at_most, equal
from tests.campaigns.compiled.worker import Silent

SEEDS, SAMPLE_SEEDS = 5, 2
WIDEST_PERCENT, DOUBTS_PERCENT, COVERED_PERCENT = 8.0, 5.0, 85.0
SLOW_M_S: Final = 0.1
"""Slip at which a diameter matters most."""
WORN: Final = ("sim.wear=3",)
"""Of the sample: a wheel that wears three times as fast as believed represents a whole table's wear."""
SAMPLE: Final = (
    (r"( +slip_velocity): \[.*\]", r"\1: [300 mm/s, 100 mm/s]"),
    (r"( +temperature): \[.*\]", r"\1: [40 degC, 55 degC]"),
    (r"(?m)^  - compound: \"[23]#\"\n", ""),
)
"""Reduces the recipe to the grid of slips: four conditions of one compound."""


class Row(NamedTuple):
    """The result of a row: U of this wheel and the error, per cent of the coefficient; NaN if unknown."""

    seed: int
    words: str
    slow: bool
    ok: bool
    doubts: tuple[str, ...]
    u_percent: float
    off_percent: float
    largest: str

    @property
    def trusted(self) -> bool:
        """Return whether it has a value and no doubt."""
        return self.ok and not self.doubts


def recipe_text(*, sample: bool) -> str:
    """Return the packaged recipe, or the sample's part of it; raises ValueError if a text to cut is missing."""
    text = recipes.find("table2").read_text(encoding="utf-8")
    if not sample:
        return text
    for pattern, replacement in SAMPLE:
        text, count = re.subn(pattern, replacement, text)
        if not count:
            raise ValueError(f"recipes/table2.yaml has nothing like {pattern}")
    head, grids = text.split("grids:\n")
    slips = next(one for one in grids.split("  - ") if "[300 mm/s, 100 mm/s]" in one)
    return f"{head}grids:\n  - {slips}{grids[grids.index('order:'):]}"


def rows_of(seed: int, text: str, overrides: tuple[str, ...]) -> list[Row]:
    """Run a recipe; return its rows."""
    with TemporaryDirectory(prefix="table2-") as name:
        recipe = Path(name) / "recipe.yaml"
        recipe.write_text(text, encoding="utf-8")
        screen = Silent()
        beliefs = ("sim.record_truth=true", *overrides)
        session = Session(
            SessionOptions(str(recipe), "sim", beliefs, out=Path(name) / "runs", seed=seed, samples=False), screen
        )
        session.run()
        if session.folder is None:
            raise RuntimeError(" ".join(screen.messages))
        with RunReader(session.folder) as reader:
            rows = results_of(reader).rows
        with closing(sqlite3.connect(session.folder / "run.db")) as database:
            return [_row(seed, one, database) for one in rows]


def _row(seed: int, one: TableRow, database: sqlite3.Connection) -> Row:
    result, setpoint = one.result, one.info.setpoint
    mu, slow = result.mu, setpoint.number("slip_velocity") == SLOW_M_S
    if not (result.ok and isfinite(mu)):
        return Row(seed, condition_words(setpoint), slow, False, tuple(result.doubts), *2 * [float("nan")], "")
    query = "SELECT name, value FROM truth WHERE condition = ?"
    true = dict(database.execute(query, [one.info.condition]))
    this = true["model"] * true["condition"] * true["wheel"] if {"model", "condition", "wheel"} <= true.keys() else 0.0
    worst = max(result.budget.contributions, key=lambda term: term.standard).name
    off = 100.0 * (mu / this - 1.0) if this else float("nan")
    u = 100.0 * result.budget.expanded / mu
    return Row(seed, condition_words(setpoint), slow, True, tuple(result.doubts), u, off, worst)


def figures(rows: Sequence[Row]) -> Iterator[Figure]:
    """Yield the figures of all rows."""
    trusted = [one for one in rows if one.trusted]
    slow = [one.u_percent for one in trusted if one.slow]
    wide = [f"seed {one.seed} {one.words} {one.u_percent:.1f} %" for one in trusted if one.u_percent > WIDEST_PERCENT]
    yield at_least("rows with a value and without a doubt", len(trusted), 0.9 * len(rows))
    yield equal(f"of them with U of this wheel above {WIDEST_PERCENT:g} %", wide, [])
    name = "greatest U of this wheel"
    yield at_most(name, max((one.u_percent for one in trusted), default=float("nan")), WIDEST_PERCENT, "%", 2)
    yield at_most(f"{name} at 100 mm/s", max(slow, default=float("nan")), WIDEST_PERCENT, "%", 2)
    doubts = 100.0 * sum(bool(one.doubts) for one in rows) / len(rows)
    words = ", ".join(f"{name} {count}" for name, count in Counter(d for one in rows for d in one.doubts).items())
    yield at_most("rows with a doubt", doubts, DOUBTS_PERCENT, "%", 2, note=f" ({words or 'none'})")
    known = [one for one in trusted if isfinite(one.off_percent)]
    held = 100.0 * sum(abs(one.off_percent) <= one.u_percent for one in known) / max(len(known), 1)
    yield at_least(f"of {len(known)} rows, U of this wheel holds the rig's truth", held, COVERED_PERCENT, "%", 1)


def main(arguments: list[str] | None = None) -> int:
    """Run everything; return 1 if a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.table2", description=(__doc__ or "").partition("\n")[2])
    parser.add_argument("--sample", action="store_true", help="four conditions on a wheel that wears fast")
    parser.add_argument("--seeds", type=int, metavar="N", help=f"seeds 1 to N (default {SEEDS})")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="runs side by side (default 1)")
    given = parser.parse_args(arguments)
    sample: bool = given.sample
    seeds = range(1, 1 + (given.seeds or (SAMPLE_SEEDS if sample else SEEDS)))
    one_seed = partial(rows_of, text=recipe_text(sample=sample), overrides=WORN if sample else ())
    rows: list[Row] = []
    with ProcessPoolExecutor(given.jobs, mp_context=get_context("spawn")) as pool:
        for found in pool.map(one_seed, seeds):
            rows += found
            for one in found:
                if one.slow or not one.trusted:
                    text = f"U {one.u_percent:.1f} %, off by {one.off_percent:+.1f} %, largest {one.largest}"
                    print(f"     seed {one.seed} {one.words}: {text} {' '.join(one.doubts)}".rstrip(), flush=True)
    missed = 0
    for figure in figures(rows):
        print(figure, flush=True)
        missed += not figure.ok
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
