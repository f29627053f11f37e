"""`python -m tests.repeats [--sample]`: how often the rule for repeats errs, one line a figure.

Exit status 0 when every figure is what is asked for, 1 when one misses it.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory

from tester.export.results import results_of
from tester.store.reader import RunReader
from tests.acceptance.figure import Figure, at_least, at_most, holds
from tests.repeats.rig import run
from tests.repeats.series import Case, Drift, Pattern, condition, pattern, settling, steady

CONDITIONS, SAMPLE_CONDITIONS = 200, 40
SEEDS, SAMPLE_SEEDS = 20, 1
LOADS_N = (100, 200, 300, 400)

UNGROUND = """recipe: not ground in
specimens: [{{compound: "1#"}}]
measure: {{wheel_speed: 0.8 m/s, repeats: 3, window: 30 rev, temperature_band: 2 degC}}
grids:
  - {{name: skipped, slip_velocity: 300 mm/s, load: {load} N, temperature: 40 degC}}
"""

EXPECTED = {0.0: (100, 100), 0.01: (98, 100), 0.02: (6, 20), 0.04: (0, 0)}
"""Stable conditions, per cent, that a Monte Carlo of the rule gave when it was designed: 100 N, 3# at 55 degC."""


def cases(of: Pattern, count: int, drift: Drift) -> list[Case]:
    """Return so many conditions."""
    return [condition(of, seed, drift) for seed in range(count)]


def synthetic(count: int) -> Iterator[Figure]:
    """Yield the figures of the rule on synthetic series."""
    share = count / CONDITIONS
    patterns = (
        pattern("100 N", "1#", 100, 40, 0.008, run),
        pattern("3# at 55 degC", "3#", 200, 55, 0.024, run),
    )
    for number, of in enumerate(patterns):
        good = cases(of, count, steady(0.0))
        yield at_most(f"{of.name}: good repeats refused", _refused(good), 2.0, "%")
        yield from _stable(of, number, 0.0, good)
        for drift in (0.01, 0.02):
            yield from _stable(of, number, drift, cases(of, count, steady(drift)))
        all_drift = cases(of, count, steady(0.04))
        yield at_most(f"{of.name}: 4 % a window in all repeats, stable", sum(c.stable for c in all_drift), 0, digits=0)
        one = cases(of, count, steady(0.04, only=1))
        kept = sum(not case.refused(1) for case in one)
        yield at_most(f"{of.name}: 4 % a window in one repeat, kept, of {count}", kept, 5 * share, digits=0)
        for size, blocks in ((0.10, 94.0), (0.06, 150.0), (0.15, 60.0)):
            laundered = [c for c in cases(of, count, settling(size, blocks)) if any(r.drifts for r in c.results)]
            carried = 100.0 * sum(c.carries for c in laundered) / max(len(laundered), 1)
            name = f"{of.name}: run-in of {100 * size:g} % in {blocks:g} revolutions, {len(laundered)} with make-ups"
            yield at_least(f"{name}, carry-over", carried, 95.0, "%", digits=1)
        flagged = 100.0 * sum(c.carries for c in good) / count
        yield at_most(f"{of.name}: no drift, carry-over", flagged, 5.0, "%", digits=1)


def _refused(found: Sequence[Case]) -> float:
    made = sum(len(case.results) for case in found)
    return 100.0 * sum(r.drifts for case in found for r in case.results) / made


def _stable(of: Pattern, number: int, drift: float, found: Sequence[Case]) -> Iterator[Figure]:
    """Yield what the design's Monte Carlo told: beside it for drifts between good and bad, asked for of none."""
    percent = 100.0 * sum(case.stable for case in found) / len(found)
    repeats = sum(len(case.results) for case in found) / len(found)
    expected = EXPECTED[drift][number]
    value = f"{percent:.1f} %, {repeats:.2f} repeats, {_refused(found):.1f} % refused"
    limit = f"expected {expected} %, " + ("at least 95 %" if drift < 0.02 else "at most half")
    ok = percent >= 95.0 if drift < 0.02 else percent <= 50.0
    yield holds(f"{of.name}: {100 * drift:g} % a window, stable", ok, value, limit)


def unground(seeds: int) -> Iterator[Figure]:
    """Yield in how many runs of the simulated rig a skipped pre-grind is seen on the condition."""
    for load in LOADS_N:
        seen = 0
        for seed in range(seeds):
            with TemporaryDirectory() as name, RunReader(run(UNGROUND.format(load=load), seed, Path(name))) as reader:
                (row,) = results_of(reader).rows
            seen += bool(row.result.doubts) or not row.result.ok
        least = (19 * seeds + 19) // 20
        yield at_least(f"{load} N without pre-grinding: the condition carries a flag, of {seeds} seeds", seen, least)


def main(arguments: list[str] | None = None) -> int:
    """Measure what is asked for; return the exit status."""
    parser = argparse.ArgumentParser("python -m tests.repeats", description=__doc__)
    parser.add_argument("--sample", action="store_true", help="the short form, for every change")
    sample = parser.parse_args(arguments).sample
    count, seeds = (SAMPLE_CONDITIONS, SAMPLE_SEEDS) if sample else (CONDITIONS, SEEDS)
    missed = 0
    for figure in chain(synthetic(count), unground(seeds)):
        print(figure, flush=True)
        missed += not figure.ok
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
