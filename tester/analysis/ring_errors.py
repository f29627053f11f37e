"""Whether the errors of a line through a slip ring gather at an angle of the wheel, and at which.

The angle comes from the wheel's speed, whose scale is off by up to a per cent: over a thousand turns the angle's error
exceeds a whole circle. So the search varies the scale and maximises the length R of the mean of the unit vectors at the
errors' angles (the vector strength, 1 = all at one angle). For n errors spread evenly the chance of a length of R or
more is exp(-n R^2) (Rayleigh's test), times the number of scales tried.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import exp, nan
from typing import Final

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
