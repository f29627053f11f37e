"""Trends stated by the paper on GrETA (doi 10.1177/0954407014521402), and the runs' result for each.

Each statement is the paper's own, with its place; ``sign`` is the stated change of friction. Where the paper
contradicts itself, or its model differs from its words, an erratum gives the model's sign, and the page of errata must
contain it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import exp, log
from pathlib import Path
from statistics import fmean
from typing import Final, TypeAlias

from tests.campaigns.greta.disc import BASE, COLD, ROUGH, DiscRun, Row

ERRATA: Final = Path(__file__).parents[3] / "docs" / "explanation" / "errata-of-the-two-papers.md"
SLOW_M_S, FAST_M_S = 0.05, 2.0
LIGHT_N, HEAVY_N = 10.0, 20.0

SeedRuns: TypeAlias = dict[str, DiscRun]
"""The runs of a seed by name."""
Ratios: TypeAlias = Callable[[SeedRuns, "Value"], Iterator[float]]
Value: TypeAlias = Callable[[Row], float]


def dry(row: Row) -> float:
    """Return the coefficient of the dry track."""
    return row.dry


def wet(row: Row) -> float:
    """Return the coefficient of the wet track, which is hysteresis."""
    return row.wet


def adhesion(row: Row) -> float:
    """Return the adhesion."""
    return next(part.value for part in row.parts if part.name == "adhesion")


def over_speed(runs: SeedRuns, value: Value) -> Iterator[float]:
    """Yield friction at 2 m/s over that at 0.05 m/s."""
    slow, fast = ([row for row in runs[BASE].rows if row.speed_m_s == speed] for speed in (SLOW_M_S, FAST_M_S))
    yield from _ratios(slow, fast, value)


def over_load(runs: SeedRuns, value: Value) -> Iterator[float]:
    """Yield friction under 20 N over that under 10 N."""
    light, heavy = ([row for row in runs[BASE].rows if row.load_n == load] for load in (LIGHT_N, HEAVY_N))
    yield from _ratios(light, heavy, value)


def over_temperature(runs: SeedRuns, value: Value) -> Iterator[float]:
    """Yield friction at 40 degC over that at 10 degC."""
    yield from _ratios(runs[COLD].rows, runs[BASE].rows, value)


def over_smoothness(runs: SeedRuns, value: Value) -> Iterator[float]:
    """Yield friction on the seed's tape over that on one of 1.7 times its Ra."""
    yield from _ratios(runs[ROUGH].rows, runs[BASE].rows, value)


def _ratios(below: Sequence[Row], above: Sequence[Row], value: Value) -> Iterator[float]:
    for low, high in zip(below, above, strict=True):
        yield value(high) / value(low)


@dataclass(frozen=True, slots=True)
class Statement:
    """A trend that the paper states. ``sign``: of the stated change, or of the model's if the statement is wrong."""

    words: str
    place: str
    ratios: Ratios
    value: Value
    sign: int
    least: float = 0.0
    """Minimum absolute change of its logarithm."""
    erratum: str = ""
    """Words that the page of errata must contain."""

    def change(self, runs: SeedRuns) -> float:
        """Return the change of friction in a seed: the mean of the logarithms of its ratios."""
        return fmean(log(ratio) for ratio in self.ratios(runs, self.value))

    def shown(self, change: float) -> bool:
        """Return whether a change is as stated."""
        return self.sign * change > self.least

    @property
    def explained(self) -> bool:
        """Return whether the errata contain the required words."""
        return not self.erratum or self.erratum in " ".join(ERRATA.read_text(encoding="utf-8").split())


DRASTIC: Final = log(1.1)
"""Change that counts as drastic: a tenth of the friction [A]."""
STATEMENTS: Final = (
    Statement("dry friction rises with speed", "Eq 12, Fig 16", over_speed, dry, 1),
    Statement("hysteresis rises with speed", "Fig 21", over_speed, wet, 1),
    Statement("a deeper indentation has more hysteresis: it rises with load", "Fig 18's text", over_load, wet, 1),
    Statement("dry friction falls with a falling pressure", "text to Fig 8; its reason has it rise", over_load, dry, 1,
              erratum="hysteresis rises, and mu rises with the load"),
    Statement("30 K change dry friction drastically; up, as E' falls (Fig 17b)", "Fig 17a", over_temperature, dry, 1,
              DRASTIC),
    Statement("a warmer rubber has a smaller tan d: hysteresis falls", "Figs 5, 7", over_temperature, wet, -1),
    Statement("a smoother track has more adhesion", "Fig 18", over_smoothness, adhesion, 1),
    Statement("... less hysteresis", "Fig 18", over_smoothness, wet, -1),
    Statement("... and more friction in all", "Fig 18", over_smoothness, dry, 1),
)  # fmt: skip
"""In the order of the printed figures."""


def percent(change: float) -> float:
    """Return a change of a logarithm in per cent."""
    return 100.0 * (exp(change) - 1.0)
