"""`python -m tests.campaigns.wear [--sample] [--lives] [--jobs N]`: is a wheel's wear found, whatever the belief?

Lives of wheels are drawn by seed (``tests.campaigns.lives``): no trip, the requested slip, the rate learnt. The recipe
``wear`` runs for several seeds at three rates. The software's belief of the rate is wrong by a factor of three or more
each time, and the tread's growth with heat is drawn, for every run, from the whole range that its stated uncertainty
covers. Prints a line a figure and exits 1 where one misses.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from random import Random
from statistics import median
from tempfile import TemporaryDirectory
from typing import NamedTuple

from tester.analysis.wear_rate import condition_wear, wear_rate
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.run_reader import RunReader
from tests.campaigns.compiled.worker import Silent
from tests.campaigns.lives import LIVES, RUBBER_EXPANSION, SAMPLE_LIVES, Lived, drawn, life_text, live
from tests.campaigns.lives import figures as figures_of_lives

RATES = {0.02: 0.08, 0.08: 0.24, 0.24: 0.08}
"""Rate put into the simulated rig, and the rate that the software believes, mm3/(N m)."""
SEEDS, SAMPLE = 20, 2
OF_EACH, OF_ALL = 0.8, 53 / 60
"""Required shares of seeds whose stated interval contains the rate: 16 of 20, 53 of 60."""
WIDEST, WIDEST_MM3_N_M = 0.25, 0.012
"""An interval wider than both, as a share of the rate and by itself, is useless [A]."""


class Case(NamedTuple):
    """One run to make."""

    rate: float
    seed: int


class Found(NamedTuple):
    """A run's result for the whole wheel, and in how many of its conditions the interval contained the rate."""

    case: Case
    exit_code: int
    rate: float
    expanded: float
    conditions: int
    held: int
    resolved: int

    @property
    def covered(self) -> bool:
        """Return whether the stated interval contains the true rate."""
        return abs(self.rate - self.case.rate) <= self.expanded


def carry_out(case: Case) -> Found:
    """Run the recipe on the simulated rig."""
    expansion = Random(f"growth {case.seed} {case.rate}").uniform(*RUBBER_EXPANSION)
    overrides = (
        f"sim.abrasion.wear_rate={case.rate}",
        f"sim.contact.rubber_expansion={expansion:.6f}",
        f"wear.rate={RATES[case.rate]}",
    )
    with TemporaryDirectory(prefix="wear-") as name:
        screen = Silent()
        session = Session(
            SessionOptions("wear", "sim", overrides, out=Path(name), seed=case.seed, samples=False), screen
        )
        code = session.run()
        if session.folder is None:
            raise RuntimeError(" ".join(screen.messages))
        with RunReader(session.folder) as reader:
            checks = reader.wear_checks()
            numbers = [one.info.condition for one in reader.conditions()]
    whole = wear_rate(checks)
    parts = [one.rate for number in numbers if (one := condition_wear(checks, number)) is not None]
    held = sum(abs(one.rate - case.rate) <= one.expanded for one in parts)
    return Found(case, code, whole.rate, whole.expanded, len(parts), held, sum(one.resolved for one in parts))


def figures(found: Sequence[Found], seeds: int) -> Iterator[tuple[str, bool]]:
    """Yield every figure in words, and whether it passes."""
    ended = sum(one.exit_code == 0 for one in found)
    yield f"runs that ended in order: {ended} of {len(found)} (asked: all)", ended == len(found)
    for rate, believed in RATES.items():
        ours = [one for one in found if one.case.rate == rate]
        covered, least = sum(one.covered for one in ours), int(OF_EACH * seeds)
        mean = sum(one.rate for one in ours) / len(ours)
        text = f"rate {rate:g} (believed {believed:g}): in the stated interval in {covered} of {len(ours)} seeds"
        yield f"{text} (asked: {least}); mean {mean:.4f} mm3/(N m)", covered >= least
        wide, most = median(one.expanded for one in ours), max(WIDEST * rate, WIDEST_MM3_N_M)
        yield f"rate {rate:g}: interval of the wheel +- {wide:.4f} (asked: at most {most:.4f})", wide <= most
        conditions, held = sum(one.conditions for one in ours), sum(one.held for one in ours)
        resolved = sum(one.resolved for one in ours)
        text = f"rate {rate:g}: single conditions in their interval {held} of {conditions}, {resolved} resolved from 0"
        yield f"{text} (asked: {int(OF_EACH * conditions)} held)", held >= int(OF_EACH * conditions)
    covered, least = sum(one.covered for one in found), int(OF_ALL * len(found))
    yield f"together: {covered} of {len(found)} (asked: {least})", covered >= least


def main(arguments: list[str] | None = None) -> int:
    """Run everything; return 1 if a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.wear", description=(__doc__ or "").partition("\n")[2])
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE} seeds a rate instead of {SEEDS}")
    parser.add_argument("--lives", action="store_true", help="the lives of wheels alone")
    parser.add_argument("--seed", type=int, default=1, help="of the first life (default 1)")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="runs side by side (default 1)")
    read = parser.parse_args(arguments)
    seeds = SAMPLE if read.sample else SEEDS
    cases = [] if read.lives else [Case(rate, seed) for seed in range(1, seeds + 1) for rate in RATES]
    lives = range(read.seed, read.seed + (SAMPLE_LIVES if read.sample else LIVES))
    lived: list[Lived] = []
    found: list[Found] = []
    with ProcessPoolExecutor(read.jobs, mp_context=get_context("spawn")) as pool:
        for one in pool.map(carry_out, cases):
            found.append(one)
            off = "" if one.covered else "  OUTSIDE"
            seed, rate = one.case.seed, one.case.rate
            print(f"   seed {seed:2} rate {rate:g}: {one.rate:.4f} +- {one.expanded:.4f}{off}", flush=True)
        for one in pool.map(live, [drawn(seed, short=read.sample) for seed in lives]):
            lived.append(one)
            print(f"   {life_text(one)}", flush=True)
    missed = 0
    for figure in figures_of_lives(lived):
        missed += not figure.ok
        print(figure, flush=True)
    for text, kept in figures(found, seeds) if found else ():
        missed += not kept
        print(f"{'ok  ' if kept else 'MISS'} {text}", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
