"""`python -m tests.campaigns.bias [--sample] [--seeds N] [--jobs N] [--hot]`: is a coefficient biased?

Each compound at 25, 55 and 85 degC and three loads, in both directions of slip, over 100 sessions: 50 seeds, each
repeated with mirrored sensor errors, so that symmetric effects cancel and the rest is bias. The truth includes the
realised factors of each repeat. One more condition has one direction only; where temperature hardly matters, its budget
must name the session's misalignment as the largest of the instruments' terms. Prints a line a figure and exits 1 where
one misses.

``--hot``: the rig that friction warms fast; cells whose temperature cannot be held there have no value; they are
printed.
"""

from __future__ import annotations

import argparse
import sys
from collections import defaultdict
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from math import isfinite, sqrt
from multiprocessing import get_context

from tests.campaigns.acceptance.figure import Figure, at_least, at_most, equal
from tests.campaigns.bias.runs import COMPOUNDS, LOADS_N, TEMPERATURES_C, Case, Cell, Off, run

SESSIONS = 100
CELL_PERCENT, MEAN_PERCENT = 0.5, 0.3
"""Maximum bias of a cell, and maximum mean of the cells' absolute bias."""
SURE = 2.5
"""Tolerance of a figure from fewer seeds, in its own standard errors."""
SAMPLE = (("1#", 25), ("3#", 55))
"""Runs of the sample, each with one seed and its mirror."""
MISALIGNMENT = "axis misalignment"
COLD_C = 25
"""At this temperature no compound's coefficient changes by more than 0.3 % a kelvin."""


def cases(seeds: int, *, hot: bool, only: Sequence[tuple[str, int]] = ()) -> Iterator[Case]:
    """Yield the runs, seed by seed: results stay balanced if the campaign ends early."""
    places = only or [(compound, at_c) for compound in COMPOUNDS for at_c in TEMPERATURES_C]
    for seed in range(seeds):
        for compound, at_c in places:
            for mirrored in (False, True):
                yield Case(compound, at_c, seed, mirrored, hot)


def _mean_and_error(found: Sequence[Off]) -> tuple[float, float]:
    """Return the bias and its standard error, per cent: a seed and its mirror are one value."""
    by_seed: dict[int, list[float]] = defaultdict(list)
    for one in found:
        by_seed[one.seed].append(one.percent)
    values = [sum(each) / len(each) for each in by_seed.values() if len(each) == 2]
    n = len(values)
    if not n:
        return float("nan"), float("nan")
    mean = sum(values) / n
    spread = sqrt(sum((value - mean) ** 2 for value in values) / (n - 1)) if n > 1 else NOISE_PERCENT
    return mean, spread / sqrt(n)


NOISE_PERCENT = 0.25
"""Standard deviation of a mirrored pair of sessions, for when one seed alone cannot give it: fluctuation of friction
within six repeats of 15 turns, twice, 1 % with a time constant of 0.3 s [A], and curvature over a kelvin of bias."""


def figures(found: Sequence[Off], cells: int, *, whole: bool) -> Iterator[Figure]:
    """Yield bias by cell, mean bias, and the error of one direction."""
    by_cell: dict[Cell, list[Off]] = defaultdict(list)
    for one in found:
        by_cell[one.cell].append(one)
    biases: list[float] = []
    rooms: list[float] = []
    for cell, each in sorted(by_cell.items()):
        valued = [one for one in each if isfinite(one.percent)]
        mean, error = _mean_and_error(valued)
        if not cell.both:
            continue
        if not isfinite(mean):
            print(f"     {cell}: no value: {each[0].status}", flush=True)
            continue
        biases.append(abs(mean))
        rooms.append(0.0 if whole else SURE * error)
        note = f" +- {error:.3f} % ({mean:+.3f}), {len(valued)} sessions"
        yield at_most(f"{cell}: bias", abs(mean), round(CELL_PERCENT + rooms[-1], 3), "%", note=note)
    yield at_least("cells with a value", len(biases), cells)
    if biases:
        mean, room = sum(biases) / len(biases), sum(rooms) / len(rooms)
        yield at_most("bias in the mean over the cells", mean, round(MEAN_PERCENT + room, 3), "%")
    yield from _one_way(by_cell)


def _one_way(by_cell: dict[Cell, list[Off]]) -> Iterator[Figure]:
    """Yield the sessions' errors, one way and both ways, and the largest term that the one-way budget names."""
    for cell, each in sorted(by_cell.items()):
        if cell.both:
            continue
        valued = [one for one in each if isfinite(one.percent)]
        both = [one.percent for one in by_cell[cell._replace(both=True)] if isfinite(one.percent)]
        if not (valued and both):
            continue
        rms = [sqrt(sum(p * p for p in values) / len(values)) for values in ([o.percent for o in valued], both)]
        print(f"     {cell}: a session is off by {rms[0]:.2f} % rms one way, {rms[1]:.2f} % both ways", flush=True)
        if cell.temperature_c == COLD_C:
            named = "; ".join(sorted({one.largest for one in valued}))
            yield equal(f"{cell}, one way: the instruments' largest term", named, MISALIGNMENT)


def main(arguments: list[str] | None = None) -> int:
    """Measure the requested figures; return the exit status."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.bias", description=__doc__)
    parser.add_argument("--sample", action="store_true", help="two runs and their mirrors")
    parser.add_argument("--seeds", type=int, default=SESSIONS // 2, metavar="N", help="seeds, each run twice")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="runs side by side (default 1)")
    parser.add_argument("--hot", action="store_true", help="on the rig that friction warms fast")
    given = parser.parse_args(arguments)
    only = SAMPLE if given.sample else ()
    seeds = 1 if given.sample else given.seeds
    made = list(cases(seeds, hot=given.hot, only=only))
    found: list[Off] = []
    with ProcessPoolExecutor(given.jobs, mp_context=get_context("spawn")) as pool:
        for case, each in pool.map(run, made):
            found += each
            text = ", ".join(f"{one.cell.load_n} N{'' if one.cell.both else ' one way'} {one.percent:+.2f} %"
                             for one in each)  # fmt: skip
            side = "mirrored" if case.mirrored else "as drawn"
            print(f"     seed {case.seed} {side}, {case.compound} {case.temperature_c} degC: {text}", flush=True)
    places = len(only) if only else len(COMPOUNDS) * len(TEMPERATURES_C)
    missed = 0
    for figure in figures(found, 0 if given.hot else places * len(LOADS_N), whole=2 * seeds >= SESSIONS):
        print(figure, flush=True)
        missed += not figure.ok
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
