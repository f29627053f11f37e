"""What a run's references show together: a control chart for each compound, and the drift of each counterface.

A reference outside the limits of its chart makes the conditions since the last good one doubtful.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import exp, hypot, isfinite, sqrt
from statistics import median
from typing import Final

from tester.analysis.quantiles import t_quantile
from tester.analysis.reference import CounterfaceDrift, KnownScatter, Reference
from tester.analysis.uncertainty import CONFIDENCE
from tester.base.words import coefficient

SIGMAS: Final = 3.0
"""Half the width of the chart of a mean of n with known s: A = 3 / sqrt(n) times s (ISO 7870-2, standard values known).
The centre is itself a mean of n: the limits are sqrt(2) times as wide."""


@dataclass(frozen=True, slots=True)
class ControlPoint:
    """One reference on a control chart; ``within``: it lies inside the limits.

    The coefficient is at the nominal temperature, with its expanded repeatability (95 %); NaN without a value.
    """

    number: int
    condition: int
    t_s: float
    mu: float
    expanded: float
    within: bool


@dataclass(frozen=True, slots=True)
class ControlChart:
    """References of one compound on one counterface in order. The centre is the first; ``low`` and ``high`` limit the
    coefficient."""

    compound: str
    centre: float
    low: float
    high: float
    points: tuple[ControlPoint, ...]
    surface: str = ""

    @property
    def name(self) -> str:
        """Return compound and counterface, for people."""
        return f"{self.compound} on {self.surface}" if self.surface else self.compound

    @property
    def kept(self) -> bool:
        """Return whether all with a value lie inside the limits."""
        return all(point.within for point in self.points if isfinite(point.mu))


def control_charts(references: Sequence[Reference], known: KnownScatter) -> tuple[ControlChart, ...]:
    """Return a chart for each compound and counterface with a reference that has a value.

    The known deviation is that of the repeats, and where pieces were changed, that from piece to piece as well.
    """
    coverage = t_quantile(0.5 + 0.5 * CONFIDENCE, known.repeats_df)
    charts: list[ControlChart] = []
    for compound, surface in dict.fromkeys((reference.compound, reference.surface) for reference in references):
        listed = [one for one in references if (one.compound, one.surface) == (compound, surface)]
        used = [reference for reference in listed if reference.mu > 0.0 and isfinite(reference.u_share)]
        if not used:
            continue  # a chart needs a first value as its centre
        pieces = len({reference.piece for reference in used})
        sigma = hypot(median(reference.u_share for reference in used), known.between if pieces > 1 else 0.0)
        half, centre = SIGMAS * sqrt(2.0) * sigma, used[0].mu
        low, high = centre * exp(-half), centre * exp(half)
        points = [
            ControlPoint(
                reference.number,
                reference.condition,
                reference.t_s,
                reference.mu,
                coverage * reference.u_share * reference.mu,
                low <= reference.mu <= high,
            )
            for reference in listed
        ]
        charts.append(ControlChart(compound, centre, low, high, tuple(points), surface))
    return tuple(charts)


@dataclass(frozen=True, slots=True)
class ReferenceWatch:
    """Result of a run's references: themselves, the drift of each counterface by its name (None: fewer than two of its
    references have a value), a control chart for each compound on each counterface."""

    references: tuple[Reference, ...]
    drifts: Mapping[str, CounterfaceDrift | None]
    charts: tuple[ControlChart, ...]

    def lines(self, worn: str) -> Iterator[str]:
        """Yield lines of text: each counterface's drift, each compound's control limits and the references outside.

        ``worn``: the kind's word for the part that wears.
        """
        for surface, drift in self.drifts.items():
            on = f"on {surface}: " if surface else ""
            if drift is not None:
                yield f"{on}{drift.sentence(worn)}"
            else:
                yield f"{on}counterface: fewer than two references have a value, nothing is known of it"
        for chart in self.charts:
            outside = [f"{point.number}" for point in chart.points if isfinite(point.mu) and not point.within]
            limits = f"references of {chart.name}: limits {coefficient(chart.low)} to {coefficient(chart.high)}"
            yield f"{limits}; outside: {', '.join(outside)}" if outside else f"{limits}; all inside"


def doubted(charts: Sequence[ControlChart], conditions: Sequence[int]) -> frozenset[int]:
    """Return the conditions between a reference out of its limits and the last good one before it.

    Charts and conditions are those of one counterface.
    """
    points = sorted((point for chart in charts for point in chart.points), key=lambda reference: reference.condition)
    doubtful: set[int] = set()
    good = 0
    for point in points:
        if point.within:
            good = point.condition
        elif isfinite(point.mu):
            doubtful.update(condition for condition in conditions if good < condition < point.condition)
    return frozenset(doubtful)
