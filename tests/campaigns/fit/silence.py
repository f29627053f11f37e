"""Are wrong laws refused, is the right one accepted, and do intervals contain the truth of records?"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from math import comb, exp, floor
from multiprocessing import get_context
from typing import Final, NamedTuple

import numpy as np

from sim.physics import laws
from tester.analysis.fit.fit_law import FitError
from tester.analysis.fit.joint import fit_group
from tester.analysis.fit.resample import resample
from tester.analysis.fit.solve import FitProblem, solve
from tests.campaigns.fit import twins
from tests.campaigns.fit.power import power_of
from tests.campaigns.fit.records import Record, on_track, on_wheel, truth_on_track, truth_on_wheel

SEEDS, RIGHT_SEEDS, SETS = 10, 40, 400
SAMPLE_SEEDS, SAMPLE_RIGHT, SAMPLE_SETS = 1, 4, 24
RESAMPLES: Final = 399
WRONG_REFUSED, RIGHT_REFUSED = 38 / 40, 2
"""Minimum share of refused records of a wrong law, and maximum share of the right one."""
COVERED: Final = (0.93, 0.97)
"""Required share of fits whose interval contains a parameter's truth."""
DOUBT: Final = 0.01
"""A count of fits misses if it is less likely than this, either way, at the nearer end of the required range [A]."""
CAN_SHOW: Final = 0.95
"""The data cannot show a departure that is detected with less power than this."""
Figure = tuple[str, bool]


class Kind(NamedTuple):
    """A recipe, the draw of its records, its right law with its truth, and wrong laws."""

    name: str
    draw: Callable[[laws.PlainMaker, int], Record]
    right: laws.PlainMaker
    truth: Callable[[Record], tuple[float, ...]]
    wrong: Mapping[str, laws.PlainMaker]


KINDS: Final = (
    Kind("grosch", on_track, twins.right_on_track, truth_on_track, {
        "a steeper shift": twins.steeper_shift,
        "two merged bells": twins.two_bells,
        "an amplitude that falls by 0.3 %/K": twins.falling,
        "a power law": twins.power_of_speed,
    }),
    Kind("table2", on_wheel, twins.right_on_wheel, truth_on_wheel, {
        "a steeper shift": twins.steeper_shift_on_wheel,
        "two merged bells": twins.two_bells_on_wheel,
        "an amplitude that falls by 0.3 %/K": twins.falling_on_wheel,
        "a power law": twins.power_on_wheel,
    }),
)  # fmt: skip


def silent(record: Record) -> str:
    """Return why a record has no intervals, "" if it has some."""
    try:
        found = fit_group(record.law, record.points[0].group, record.points, record.cells, count=RESAMPLES)
    except FitError as error:
        return str(error)
    return found.silent


def power(record: Record) -> float:
    """Return the share of records like this one in which the departure of the twin's law from the fitted one is
    refused, computed as in the fit; 1 if the law cannot be fitted at all.
    """
    exact = np.array(record.free_of_error)
    points = [replace(one, value=exp(y)) for one, y in zip(record.points, record.free_of_error, strict=True)]
    problem = FitProblem(record.law, points, {})
    try:
        starts = [*record.law.published.values(), [one.start for one in record.law.parameters]]
        fitted = solve(problem, starts)
    except FitError:
        return 1.0
    return power_of(problem, fitted, exact - problem.logarithms(fitted), 1999)


def _wrong(kind: str, name: str, seed: int) -> tuple[bool, float]:
    own = next(one for one in KINDS if one.name == kind)
    record = own.draw(own.wrong[name], seed)
    return bool(silent(record)), power(record)


def _right(kind: str, seed: int) -> bool:
    own = next(one for one in KINDS if one.name == kind)
    return bool(silent(own.draw(own.right, seed)))


def _held(kind: str, seed: int) -> dict[str, bool]:
    own = next(one for one in KINDS if one.name == kind)
    record = own.draw(own.right, seed)
    truth = own.truth(record)
    problem = FitProblem(record.law, record.points, {})
    found = resample(problem, solve(problem, [truth]), RESAMPLES, seed)
    ends = (found.interval(found.parameters[:, i]) for i in range(len(truth)))
    return {n: low <= at <= high for n, at, (low, high) in zip(record.law.names, truth, ends, strict=True)}


def refused(kind: Kind, pool: ProcessPoolExecutor, seeds: int) -> Iterator[Figure]:
    """Yield how many records of wrong laws are refused, with the power of the tests.

    A parameter's band may still refuse a law against which the tests have little power. If not, the data cannot show
    that law; its count agrees with the power, and it has no limit.
    """
    asked, met = 0, 0
    for name in kind.wrong:
        found = [*pool.map(partial(_wrong, kind.name, name), range(seeds))]
        count, seen = sum(one for one, _ in found), float(np.mean([share for _, share in found]))
        shows = seen >= CAN_SHOW or count >= WRONG_REFUSED * seeds
        asked, met = asked + shows * seeds, met + shows * count
        text = f"{kind.name}, {name}: {count} of {seeds} refused or without intervals, power of the tests {seen:.2f}"
        least = 3.0 * float(np.sqrt(seeds * seen * (1.0 - seen))) + 1.0
        yield (text if shows else f"{text}: the data cannot show it"), shows or count >= seeds * seen - least
    text = f"{kind.name}, laws that the data can show: {met} of {asked} refused or without intervals"
    yield f"{text} (asked: {floor(WRONG_REFUSED * asked)})", met >= floor(WRONG_REFUSED * asked)


def right(kind: Kind, pool: ProcessPoolExecutor, seeds: int) -> Figure:
    """Return how many records of the right law are refused."""
    count = sum(pool.map(partial(_right, kind.name), range(1000, 1000 + seeds)))
    return f"{kind.name}, the right law: {count} of {seeds} refused (asked: at most {RIGHT_REFUSED})", (
        count <= RIGHT_REFUSED
    )


def covered(kind: Kind, pool: ProcessPoolExecutor, sets: int) -> Figure:
    """Return how often intervals contain the truth, for each parameter."""
    found = [*pool.map(partial(_held, kind.name), range(2000, 2000 + sets), chunksize=8)]
    counts = {name: sum(one[name] for one in found) for name in found[0]}
    low, high = COVERED
    met = all(tail(count, sets, low, below=True) and tail(count, sets, high, below=False) for count in counts.values())
    shares = ", ".join(f"{name} {100.0 * count / sets:.1f}" for name, count in counts.items())
    return f"{kind.name}, % of {sets} records in their interval: {shares} (asked: 93 to 97, by the count)", met


def tail(count: int, sets: int, share: float, *, below: bool) -> bool:
    """Return whether a count of sets, or a more extreme one, is at least as likely as ``DOUBT`` at a share."""
    places = range(count + 1) if below else range(count, sets + 1)
    return sum(comb(sets, k) * share**k * (1.0 - share) ** (sets - k) for k in places) >= DOUBT


def figures(*, sample: bool, jobs: int) -> Iterator[Figure]:
    """Yield every figure in words, and whether it passes."""
    seeds, right_seeds, sets = (
        (SAMPLE_SEEDS, SAMPLE_RIGHT, SAMPLE_SETS) if sample else (SEEDS, RIGHT_SEEDS, SETS)
    )
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for kind in KINDS:
            yield from refused(kind, pool, seeds)
            yield right(kind, pool, right_seeds)
            yield covered(kind, pool, sets)
