"""A channel of the load cell with the weights that hung on it: fit, residuals, uncertainty, and the verdict."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import hypot, sqrt
from statistics import median
from typing import Final

from tester.machine.commission.commission_step import StepRefused

ASKED_AGAIN: Final = 1.2
"""A weight off what the cell shows by a greater factor is asked for once more, and no gain is advised from it [A]."""
TYPED_SHARE: Final = 0.05
"""A point that deviates this much from its channel's others was mistyped [A]: the cell's linearity is 0.1 %."""
CROSSED_SHARE: Final = 0.5
"""A channel that shows more than this share of another channel's weight has that channel's wires [A]."""
GAIN_SHARE: Final = 0.02
"""A gain is refused beyond this [A]: a cell with a certificate has 0.5 % without adjustment."""
COUPLING_SHARE: Final = 0.04
"""Crosstalk and misalignment are refused beyond this [A]: 0.5 % and 0.5 degrees are 1.4 %."""
WEIGHT_SHARE: Final = 2e-4
"""Standard uncertainty of a hung force, share [A]: 5e-5 from weights of class M1 (OIML R 111-1), 1e-4 from the typed
gravity, 1.5e-4 from a wire's direction over a pulley within 1 degree."""
GRAVITY: Final = 9.81
UNITS: Final = {GRAVITY: "kilograms for newtons", GRAVITY / 1000.0: "grams for newtons"}
UNIT_SHARE: Final = 0.03
"""Gains that a unit explains, m/s2 and thousandths, within this share [A]."""


@dataclass(frozen=True, slots=True)
class HungWay:
    """A way in which weights hang. ``place``: of the loaded channel; ``sign``: -1 if the force should read below 0."""

    name: str
    label: str
    place: int
    plan: tuple[float, ...]
    """Approximate weights, N: rising, and one while falling, for hysteresis [A]."""
    sign: float = 1.0
    how: str = ""
    """What else to do with hook and wire, for people."""
    optional: bool = False
    """Whether a rig may have no place for its pulley."""


@dataclass(slots=True)
class HungChannel:
    """The points of one way: the hung force, N, and the readings of all channels above zero, N, in its direction."""

    way: HungWay
    hung_n: list[float] = field(default_factory=list[float])
    shown_n: list[tuple[float, ...]] = field(default_factory=list[tuple[float, ...]])

    @property
    def name(self) -> str:
        """The way's name."""
        return self.way.name

    @property
    def place(self) -> int:
        """The place of the loaded channel."""
        return self.way.place

    def slopes(self) -> tuple[float, ...]:
        """Return each channel's reading per newton, by least squares through zero."""
        square = sum(f * f for f in self.hung_n)
        return tuple(
            sum(f * s for f, s in zip(self.hung_n, shown, strict=True)) / square
            for shown in zip(*self.shown_n, strict=True)
        )

    def residuals(self) -> list[float]:
        """Return the deviations of the channel's readings from its line, N."""
        slope = self.slopes()[self.place]
        return [s[self.place] - slope * f for f, s in zip(self.hung_n, self.shown_n, strict=True)]

    def standard(self) -> float:
        """Return the standard uncertainty of the slope: scatter about the line, and the weights."""
        left = self.residuals()
        scatter = sqrt(sum(r * r for r in left) / max(1, len(left) - 1))
        return hypot(scatter / sqrt(sum(f * f for f in self.hung_n)), WEIGHT_SHARE)

    def typed_wrongly(self) -> int:
        """Return the index of the point farthest off the median sensitivity, -1 if none is too far."""
        answer = self.answering()
        shares = [s[answer] / f for f, s in zip(self.hung_n, self.shown_n, strict=True)]
        middle = median(shares)
        off = [abs(share / middle - 1.0) if middle else 0.0 for share in shares]
        worst = max(range(len(off)), key=off.__getitem__)
        return worst if off[worst] > TYPED_SHARE else -1

    def answering(self) -> int:
        """Return the index of the channel that shows most of these weights."""
        totals = [sum(map(abs, shown)) for shown in zip(*self.shown_n, strict=True)]
        return totals.index(max(totals))


def judge_channel(channel: HungChannel, labels: tuple[str, ...]) -> None:
    """Raise StepRefused for a channel whose wiring, scale or mounting differs from the rig file."""
    slopes, place, label = channel.slopes(), channel.place, channel.way.label
    answer = channel.answering()
    if answer != place and abs(slopes[answer]) > CROSSED_SHARE:
        raise StepRefused(
            f"load cell channels are swapped: a weight on {label} shows on {labels[answer]}"
            f" ({slopes[answer]:+.2f} N/N). Change the wires at the transmitter, or the profile's addresses"
        )
    gain = slopes[place]
    if gain < 0.0:
        raise StepRefused(
            f"the sign of the load cell's {label} is reversed: a weight shows {gain:+.3f} N/N."
            " Swap its signal wires, or its sign at the transmitter"
        )
    for factor, unit in UNITS.items():
        for off in (factor, 1.0 / factor):
            if abs(gain / off - 1.0) <= UNIT_SHARE:
                raise StepRefused(
                    f"gain of the load cell's {label}: {gain:.4g} N shown for each N hung is {unit}: either the weights"
                    " were typed in another unit than newtons, or the transmitter is set to one"
                )
    if not 1.0 / ASKED_AGAIN <= gain <= ASKED_AGAIN:
        raise StepRefused(
            f"gain of the load cell's {label}: {gain:.4g} N shown for each N hung. No setting of a sound cell explains"
            " that: look at the unit of the weights, at pulley and wire, at the transmitter's full load; the profile"
            " stays as it is"
        )
    if not abs(gain - 1.0) <= GAIN_SHARE:
        raise StepRefused(
            f"gain of the load cell's {label}: {gain:.4f} N shown for each N hung, beyond {100 * GAIN_SHARE:g} %."
            f" Multiply the channel's sensitivity at the transmitter (mV/V at full load) by {gain:.5f}, or the scale of"
            f" its signal in the profile by {1 / gain:.5f}"
        )
    for other, slope in enumerate(slopes):
        if other != place and abs(slope) > COUPLING_SHARE:
            raise StepRefused(
                f"{labels[other]} shows {100 * slope:+.1f} % of a force on {label}, more than"
                f" {100 * COUPLING_SHARE:g} %: crosstalk, or the cell is mounted {57.3 * abs(slope):.1f} degrees off"
            )
