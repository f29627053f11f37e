"""What runs have on record of their slip ring, and its trend from run to run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import inf, nan, sqrt
from pathlib import Path
from typing import TypeAlias

from tester.kinds.wheel_on_belt.ring_errors import BUS, SPEEDS_REV_S, RingSector, RingSegment, sector_of, speed_words
from tester.store.reader import RunReader

Json: TypeAlias = "bool | int | float | str | list[Json] | dict[str, Json] | None"

GROWS_Z = 2.0
"""A slope of this many standard uncertainties or more is no chance alone (95 %)."""


@dataclass(frozen=True, slots=True)
class RingRun:
    """The slip ring in one run."""

    name: str
    started: str
    """When the run began, UTC."""
    segments: list[RingSegment] = field(default_factory=list[RingSegment])

    @property
    def turns(self) -> float:
        """Of the wheel in this run."""
        return sum(one.turns for one in self.segments)

    @property
    def requests(self) -> int:
        """To the device beyond the ring."""
        return sum(sum(one.requests) for one in self.segments)

    @property
    def errors(self) -> int:
        """Of these requests: without a good reply."""
        return sum(sum(one.errors) for one in self.segments)

    @property
    def per_thousand(self) -> float:
        """Errors of a thousand requests; NaN without any."""
        return 1e3 * self.errors / self.requests if self.requests else nan

    def by_speed(self) -> list[tuple[str, int, int]]:
        """Return for each class of speed: words, requests, errors."""
        return [
            (
                speed_words(place),
                sum(one.requests[place] for one in self.segments),
                sum(one.errors[place] for one in self.segments),
            )
            for place in range(len(SPEEDS_REV_S) + 1)
        ]

    def sectors(self) -> list[RingSector]:
        """Return where errors gather, for each wheel that was on."""
        return [sector_of(one.at_rev) for one in self.segments]

    def as_json(self) -> dict[str, Json]:
        """Return what there is to tell."""
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
                    "errors": one.errors,
                    "gather": one.found,
                    "centre_deg": one.centre_deg if one.found else None,
                    "half_deg": one.half_deg if one.found else None,
                    "sectors": list(one.sectors),
                }
                for one in self.sectors()
            ],
        }


def ring_of(folder: Path, name: str) -> RingRun:
    """Return what a run has on record. Raises StoreError where it cannot be read."""
    with RunReader(folder) as reader:
        found = RingRun(name, reader.run().info.started_utc)
        for counter, value in reader.bus_statistics(BUS):
            if counter == "wheel":
                found.segments.append(RingSegment())
                continue
            segment = found.segments[-1]
            what, _, place = counter.partition(" ")
            if counter == "turns":
                segment.turns = value
            elif counter == "error at":
                segment.at_rev.append(value)
            elif what == "requests":
                segment.requests[int(place)] = round(value)
            elif what == "errors":
                segment.errors[int(place)] = round(value)
    return found


@dataclass(frozen=True, slots=True)
class RingTrend:
    """How the share of failed requests goes with the age of the ring."""

    per_thousand_turns: float
    """Errors of 1000 requests more for every 1000 turns; NaN where nothing can be said."""
    z: float
    """The slope over its standard uncertainty."""

    @property
    def grows(self) -> bool:
        """More errors with age, beyond chance."""
        return self.z >= GROWS_Z


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
