"""Synthetic conditions on the paper's design (40 of load, slip and temperature), from its laws with noise in ln mu."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from sim.physics.friction import COMPOUNDS, evaluate
from tester.analysis.fit.fit_law import FitPoint, Law, Source
from tester.analysis.fit.joint import fit_only, predict
from tester.kinds.wheel_on_belt.fit.laws import PAPER, joint_of, table_3_of
from tester.kinds.wheel_on_belt.fit.published import published_table

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

TEMPERATURES, LOADS = (25.0, 40.0, 55.0, 70.0, 85.0), (100.0, 200.0, 300.0, 400.0)
SLIPS: Final = (0.0, 0.1, 0.2, 0.4)
DESIGN: Final = tuple(
    (t, load, slip)
    for t in TEMPERATURES
    for load, slip in ((*((f, 0.3) for f in LOADS), *((200.0, v) for v in SLIPS)))
)
"""Conditions of both of the paper's appendices, a compound."""
NOISE: Final = 0.01
"""Standard deviation of ln mu."""
SETS, SAMPLE = 200, 24
EVERY: Final = 8
"""Number of conditions at each temperature; one in so many of a set's conditions is held out."""
HELD_OUT: Final = 0.03
CELLS: Final = 0.95
"""Required share of conditions this near, if nothing of their load and slip was fitted [A]."""
SAME: Final = 1e-12
SCALES: Final = (0.1, 0.5, 1.987, 10.0)
"""Numbers by which alpha and gamma are multiplied, a1 and a2 divided."""


Split = Callable[[Sequence[FitPoint], int], tuple[list[FitPoint], list[FitPoint]]]


def made(law: Law, seed: int, noise: float) -> tuple[tuple[float, ...], list[FitPoint]]:
    """Return the truth of a set, the three compounds in turn, and its conditions."""
    truth = [*law.published.values()][seed % len(law.published)]
    exact = law.value(np.array(truth), np.array(DESIGN))
    scatter = np.random.default_rng(seed).normal(0.0, noise, len(DESIGN))
    values = [float(value) for value in exact * np.exp(scatter)]
    source = Source("synthetic")
    return truth, [FitPoint("", "one", at, at, value, source) for at, value in zip(DESIGN, values, strict=True)]


def split(points: Sequence[FitPoint], seed: int) -> tuple[list[FitPoint], list[FitPoint]]:
    """Return conditions to be fitted and held out: one at each temperature, each with another load or slip."""
    out = [(i + i // EVERY + seed) % EVERY == 0 for i in range(len(points))]
    pairs = [*zip(points, out, strict=True)]
    return [one for one, left in pairs if not left], [one for one, left in pairs if left]


def split_cell(points: Sequence[FitPoint], seed: int) -> tuple[list[FitPoint], list[FitPoint]]:
    """Return conditions to be fitted and held out: one load and slip at all temperatures: extrapolated."""
    of = [i % EVERY == seed % EVERY for i in range(len(points))]
    pairs = [*zip(points, of, strict=True)]
    return [one for one, left in pairs if not left], [one for one, left in pairs if left]


def held_out(sets: int, split: Split = split) -> tuple[float, int, int]:
    """Return the largest prediction error of a held-out condition without its noise, the number of misses, and of
    all."""
    largest, over, count = 0.0, 0, 0
    for seed in range(sets):
        truth, points = made(PAPER, seed, NOISE)
        kept, out = split(points, seed)
        found = fit_only(PAPER, "one", kept)
        for value, exact in zip(predict(PAPER, found, out), predict(PAPER, truth, out), strict=True):
            off = abs(value / exact - 1.0)
            largest, over, count = max(largest, off), over + (off > HELD_OUT), count + 1
    return largest, over, count


def redundant() -> float:
    """Return the difference of predictions between equivalent sets of Table 3's parameters, and their form."""
    t, load, slip = np.array(DESIGN).T
    largest = 0.0
    for given in COMPOUNDS.values():
        exact = evaluate(given, t, load, slip)
        normal = PAPER.value(np.array(joint_of(given)), np.array(DESIGN))
        for scale in SCALES:
            scaled = replace(given, alpha=scale * given.alpha, gamma=scale * given.gamma, a1=given.a1 / scale,
                             a2=given.a2 / scale)  # fmt: skip
            again = table_3_of(joint_of(scaled))
            for values in (evaluate(scaled, t, load, slip), evaluate(again, t, load, slip), normal):
                largest = max(largest, float(np.max(np.abs(values / exact - 1.0))))
    return largest


def figures(sets: int) -> Iterator[tuple[str, bool]]:
    """Yield every figure in words, and whether it passes."""
    largest, over, count = held_out(sets)
    text = f"held-out conditions, Eq 6 with {100.0 * NOISE:g} % noise: {count - over} of {count} within"
    yield f"{text} {100.0 * HELD_OUT:g} % (asked: all), largest {100.0 * largest:.2f} %", over == 0
    largest, over, count = held_out(sets, split_cell)
    text = f"whole cells of load and slip held out: {count - over} of {count} within {100.0 * HELD_OUT:g} %"
    yield f"{text} (asked: {100.0 * CELLS:g} %), largest {100.0 * largest:.2f} %", count - over >= CELLS * count
    off = redundant()
    yield f"predictions of redundant parameters differ by {off:.1e} (asked: at most {SAME:.0e})", off <= SAME
    for line in published_table().lines:
        if line.asked:
            yield f"{line.way}: {line.asked}", line.met
