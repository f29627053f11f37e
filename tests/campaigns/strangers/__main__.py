"""`python -m tests.campaigns.strangers [--sample]`: unlisted defects, drawn by seed, at the limits.

Each case gives one or two quantities of a machine a defect of any size, sign and course, at any moment of a recipe at
the limits, of a resumed run, or of commissioning. Harm is judged in the plant. It may come only in rows of
docs/hardware-strangers.csv, which name the device that must prevent it. Exit code 1 if a figure misses.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

from tests.campaigns.acceptance.figure import at_least, equal
from tests.campaigns.strangers import commissioned, places, trial
from tests.campaigns.strangers.draw import Case, cases
from tests.campaigns.strangers.hardware import row_of
from tests.campaigns.strangers.scenes import TRACK, WHEEL, Setup, moments, setups, visit
from tests.campaigns.strangers.trial import Outcome

CASES = {WHEEL: 200, TRACK: 80}
COMMISSIONED = 20
RECIPES = {WHEEL: 6, TRACK: 2}
"""Recipes that a seed draws from those of a kind."""
SAMPLE = {WHEEL: 24, TRACK: 30}
SAMPLE_COMMISSIONED = 3
NOTICED = {WHEEL: 0.5, TRACK: 0.5, commissioned.NAME: 0.2}
"""Minimum share of detected cases: defects without effect prove nothing. A step of commissioning uses few parts, so
fewer defects show in it: the sample's three cases need not be detected."""


@dataclass(frozen=True, slots=True)
class Share:
    """Cases of one recipe, for one process."""

    setup: Setup
    count: int
    seed: str


def conduct(share: Share) -> list[tuple[Case, Outcome]]:
    """Draw the cases of a share and try them."""
    chooser = random.Random(share.seed)
    drawn = sorted(cases(chooser, moments(share.setup), places.of(share.setup.rig), share.count), key=_tick)
    outcomes = visit(share.setup, [case.moment.tick for case in drawn], partial(_tried, drawn))
    return list(zip(drawn, outcomes, strict=True))


def _tried(drawn: Sequence[Case], stage: trial.Stage, number: int) -> Outcome:
    return trial.tried(stage, drawn[number])


def _tick(case: Case) -> int:
    return case.moment.tick


def shares(kind: str, count: int, seed: int, *, short: bool) -> Iterator[Share]:
    """Yield the shares of a kind of machine: recipes drawn by seed."""
    every = list(setups(kind, short=short).values())
    chosen = random.Random(f"{seed} {kind}").sample(every, min(RECIPES[kind], len(every)))
    for place, setup in enumerate(chosen):
        yield Share(setup, count * (place + 1) // len(chosen) - count * place // len(chosen), f"{seed} {setup.name}")


def _results(every: Sequence[Share], jobs: int) -> Iterable[list[tuple[Case, Outcome]]]:
    if jobs == 1:
        yield from map(conduct, every)
        return
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(conduct, every)


def judged(kind: str, found: Sequence[tuple[Case, Outcome]], asked: int) -> bool:
    """Print the figures of a kind's cases; return whether all pass."""
    harmed = [(case, outcome) for case, outcome in found if outcome.harm]
    rows = Counter(row.device for case, _ in harmed if (row := row_of(kind, case)) is not None)
    outside = [(case, outcome) for case, outcome in harmed if row_of(kind, case) is None]
    broken = [(case, outcome) for case, outcome in found if outcome.broken]
    noticed = sum(bool(outcome.noticed) for _, outcome in found)
    figures = [
        at_least(f"{kind}: cases", len(found), asked),
        at_least(f"{kind}: noticed", noticed, int(NOTICED[kind] * asked)),
        equal(f"{kind}: harm that nothing noticed, outside the written table",
              sum(outcome.unseen for _, outcome in outside), 0),
        equal(f"{kind}: harm before the reaction, outside the written table",
              sum(not outcome.unseen for _, outcome in outside), 0),
        equal(f"{kind}: invariants of control broken", len(broken), 0),
    ]  # fmt: skip
    for figure in figures:
        print(figure, flush=True)
    held = ", ".join(f"{device} {count}" for device, count in rows.most_common())
    print(f"     {kind}: left to hardware: {held or 'none'}", flush=True)
    for case, outcome in [*outside, *broken]:
        print(f"       {case}: {outcome}", flush=True)
    return all(figure.ok for figure in figures)


def main(arguments: list[str] | None = None) -> int:
    """Draw cases and judge them; return the exit status."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.strangers", description=__doc__)
    parser.add_argument("--sample", action="store_true", help="few cases of few recipes")
    parser.add_argument("--seed", type=int, default=29, metavar="N")
    parser.add_argument("--cases", type=int, default=1, metavar="TIMES", help="so many times the usual cases")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processors")
    parser.add_argument("--kind", choices=(WHEEL, TRACK), help="of machine; without it both, and commissioning")
    options = parser.parse_args(arguments)
    met = True
    for kind in [options.kind] if options.kind else [WHEEL, TRACK]:
        count = options.cases * (SAMPLE if options.sample else CASES)[kind]
        every = list(shares(kind, count, options.seed, short=options.sample))
        found = [pair for pairs in _results(every, options.jobs) for pair in pairs]
        met = judged(kind, found, count) and met
    if not options.kind:
        count = options.cases * (SAMPLE_COMMISSIONED if options.sample else COMMISSIONED)
        met = judged(commissioned.NAME, commissioned.conduct(count, options.seed), count) and met
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
