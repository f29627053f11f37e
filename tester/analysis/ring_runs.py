"""Statistics of a slip ring that carries a device's line to a turning part, from the records of runs, and the trend
between runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import inf, isfinite, nan, sqrt

from tester.analysis.ring_errors import SPEEDS_REV_S, RingSector, RingSegment, sector_of, speed_words
from tester.base.words import Json

GROWS_Z = 2.0
"""A slope of this many standard uncertainties or more is more than chance (95 %)."""


@dataclass(frozen=True, slots=True)
class RingRun:
    """The ring in one run."""

    name: str
    started: str
    """When the run began, UTC."""
    segments: list[RingSegment] = field(default_factory=list[RingSegment])

    @property
    def turns(self) -> float:
        """Return the turns of the wheel in this run."""
        return sum(segment.turns for segment in self.segments)

    @property
    def requests(self) -> int:
        """Return the requests to the device beyond the ring."""
        return sum(sum(segment.requests) for segment in self.segments)

    @property
    def errors(self) -> int:
        """Return the requests without a good reply."""
        return sum(sum(segment.errors) for segment in self.segments)

    @property
    def per_thousand(self) -> float:
        """Return errors per thousand requests; NaN without any."""
        return 1e3 * self.errors / self.requests if self.requests else nan

    def by_speed(self) -> list[tuple[str, int, int]]:
        """Return for each class of speed: words, requests, errors."""
        return [
            (
                speed_words(place),
                sum(segment.requests[place] for segment in self.segments),
                sum(segment.errors[place] for segment in self.segments),
            )
            for place in range(len(SPEEDS_REV_S) + 1)
        ]

    def sectors(self) -> list[RingSector]:
        """Return where errors gather, for each wheel that was mounted."""
        return [sector_of(segment.at_rev) for segment in self.segments]

    def as_json(self) -> dict[str, Json]:
        """Return the statistics as plain data."""
        return {
            "run": self.name,
            "started": self.started,
            "turns": self.turns,
            "requests": self.requests,
            "errors": self.errors,
            "by_speed": [
                {"speed": words, "requests": requests, "errors": errors} for words, requests, errors in self.by_speed()
            ],
            "wheels": [
                {
                    "errors": sector.errors,
                    "gather": sector.found,
                    "centre_deg": sector.centre_deg if sector.found else None,
                    "half_deg": sector.half_deg if sector.found else None,
                    "sectors": list(sector.sectors),
                }
                for sector in self.sectors()
            ],
        }


def ages_of(runs: Sequence[RingRun], before: float = 0.0) -> list[float]:
    """Return the turns of the ring until the end of each run, in order of time; ``before``: those before the first."""
    ages: list[float] = []
    for run in runs:
        before += run.turns
        ages.append(before)
    return ages


@dataclass(frozen=True, slots=True)
class RingTrend:
    """Trend of the share of failed requests with the age of the ring."""

    per_thousand_turns: float
    """Slope in errors per 1000 requests for every 1000 turns; NaN where unknown."""
    z: float
    """The slope over its standard uncertainty."""

    @property
    def grows(self) -> bool:
        """Return whether errors increase with age, beyond chance."""
        return self.z >= GROWS_Z

    @property
    def words(self) -> str:
        """Return the trend in words, "" where unknown."""
        if not isfinite(self.per_thousand_turns):
            return ""
        grows = "grows" if self.grows else "falls" if self.z <= -GROWS_Z else "no trend beyond chance"
        return f"{self.per_thousand_turns:+.3f} errors of 1000 for every 1000 turns (z {self.z:.1f}): {grows}"


def trend_of(runs: Sequence[tuple[float, int, int]]) -> RingTrend:
    """Return the trend of runs with (turns of the ring until then, requests, errors).

    A straight line by least squares, each share weighted by its binomial variance at the mean share of all.
    """
    counted = [(age, requests, errors) for age, requests, errors in runs if requests > 0]
    total = sum(requests for _, requests, _ in counted)
    share = sum(errors for _, _, errors in counted) / total if total else 0.0
    if len(counted) < 2 or not 0.0 < share < 1.0:
        return RingTrend(nan, 0.0)
    mean = sum(age * requests for age, requests, _ in counted) / total
    spread = sum(requests * (age - mean) ** 2 for age, requests, _ in counted)
    if spread <= 0.0:
        return RingTrend(nan, 0.0)
    slope = sum((errors - share * requests) * (age - mean) for age, requests, errors in counted) / spread
    uncertainty = sqrt(share * (1.0 - share) / spread)
    return RingTrend(1e6 * slope, slope / uncertainty if uncertainty > 0.0 else inf)
