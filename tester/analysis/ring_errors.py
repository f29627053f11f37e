"""The errors of a line through a slip ring: whether they gather at an angle of the wheel, in each run and over runs.

The angle comes from the wheel's speed, whose scale is off by up to a per cent: over a thousand turns the angle's error
exceeds a whole circle. So the search varies the scale and maximises the length R of the mean of the unit vectors at the
errors' angles (the vector strength, 1 = all at one angle). For n errors spread evenly the chance of a length of R or
more is exp(-n R^2) (Rayleigh's test), times the number of scales tried.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import exp, inf, isfinite, nan, sqrt
from typing import Final

from tester.base.words import Json

SCALE_OFF: Final = 0.01
"""Greatest error of the scale of the wheel's speed that is searched [A]."""
STEP_REV: Final = 0.1
"""Step between the scales tried: each turns the last error by this much, rev; nearer ones have nearly the same R
[A]."""
LEAST_ERRORS: Final = 8
"""Fewer errors carry no information about an angle [A]."""
CHANCE: Final = 0.001
"""Errors gather where chance alone produces such a strength in at most this share of cases [A]."""
SPEEDS_REV_S: Final = (0.02, 1.0, 2.0, 4.0)
"""Lower ends of the classes of wheel speed, below the first the wheel is at rest, rev/s [A]; 0.8 m/s are 3.2 rev/s."""


@dataclass(slots=True)
class RingSegment:
    """Requests and errors of one wheel, since it was mounted."""

    turns: float = 0.0
    requests: list[int] = field(default_factory=lambda: [0] * (len(SPEEDS_REV_S) + 1))
    """By class of speed, as ``errors``."""
    errors: list[int] = field(default_factory=lambda: [0] * (len(SPEEDS_REV_S) + 1))
    at_rev: list[float] = field(default_factory=list[float])
    """Turns of the wheel at each failed request, while it turned."""


@dataclass(frozen=True, slots=True)
class RingSector:
    """Angle at which errors gather on the ring, counted from the wheel's position when it was mounted."""

    errors: int
    centre_deg: float
    """0 to 360; NaN for too few errors."""
    half_deg: float
    """Half of the errors lie within this angle of the centre."""
    strength: float
    """The vector strength R, 0 to 1."""
    chance: float
    """Probability of such a strength for errors at random angles."""
    off: float
    """Share by which the wheel's speed was underestimated."""
    sectors: tuple[int, ...]
    """Errors in twelve sectors of 30 degrees, the first from 0."""

    @property
    def found(self) -> bool:
        """Return whether they gather."""
        return self.errors >= LEAST_ERRORS and self.chance <= CHANCE


def sector_of(at_rev: Sequence[float]) -> RingSector:
    """Return the angle at which errors gather; ``at_rev``: turns of the wheel at each."""
    import numpy as np

    if not at_rev:
        return RingSector(0, nan, nan, 0.0, 1.0, 0.0, (0,) * 12)
    turns = np.asarray(at_rev, dtype=float)
    span = float(turns.max() - turns.min())
    tried = max(1, round(SCALE_OFF * span / STEP_REV))
    scales = np.linspace(-SCALE_OFF, SCALE_OFF, 2 * tried + 1) if span > 0.0 else np.zeros(1)
    strength, off = max(_strongest(turns, block) for block in np.array_split(scales, 1 + len(scales) // 500))
    angles = (turns * (1.0 + off)) % 1.0
    mean = complex(np.exp(2j * np.pi * angles).mean())
    centre = float(np.angle(mean) / (2.0 * np.pi)) % 1.0
    away = np.abs((angles - centre + 0.5) % 1.0 - 0.5)
    counts = np.histogram(angles, bins=12, range=(0.0, 1.0))[0]
    return RingSector(
        errors=len(turns),
        centre_deg=360.0 * centre if len(turns) >= LEAST_ERRORS else nan,
        half_deg=360.0 * float(np.median(away)),
        strength=strength,
        chance=min(1.0, len(scales) * exp(-len(turns) * strength * strength)),
        off=off,
        sectors=tuple(int(count) for count in counts),
    )


def _strongest(turns: object, scales: object) -> tuple[float, float]:
    """Return the greatest vector strength of some scales, and its scale."""
    import numpy

    at, tried = numpy.asarray(turns), numpy.asarray(scales)
    lengths = numpy.abs(numpy.exp(2j * numpy.pi * numpy.outer(1.0 + tried, at)).mean(axis=1))
    best = int(lengths.argmax())
    return float(lengths[best]), float(tried[best])


def speed_class(rev_s: float) -> int:
    """Return the class of a speed of the wheel, rev/s: 0 = at rest."""
    return sum(rev_s >= least for least in SPEEDS_REV_S)


def speed_words(place: int) -> str:
    """Return a class of speed in words."""
    if place == 0:
        return "standing"
    if place == len(SPEEDS_REV_S):
        return f"from {SPEEDS_REV_S[-1]:g} rev/s"
    low = 0.0 if place == 1 else SPEEDS_REV_S[place - 1]
    return f"{low:g} to {SPEEDS_REV_S[place]:g} rev/s"


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
        """Return a row for each class of speed: its name, requests, errors."""
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
