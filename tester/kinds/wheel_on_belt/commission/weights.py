"""Calibrate the load cell with hung weights: points, fit, residuals, uncertainty, person, reference, expiry.

Nothing has power. Each weight loads one channel; a line through zero is fitted to each channel's readings less its
zero. Crossed wires, a wrong sign, a wrong gain and a mistyped weight show before anything presses:

- a typed weight that deviates from the channel's other points by more than ``TYPED_SHARE`` is requested once more;
- a channel is refused, with the remedy, if its weights show on another channel, with the wrong sign or another gain.

The readings are not corrected for the cell's error: the error enters the budget (``budget.calibrated``).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Generator
from dataclasses import dataclass, field
from datetime import date
from functools import partial
from itertools import pairwise
from math import hypot, inf, isfinite, sqrt
from statistics import fmean, median
from typing import Final

from tester.kinds.wheel_on_belt.commission.quiet import JogSeat
from tester.machine.commission.commission_step import Dialogue, Notes, StepRefused, Waits, line, measure
from tester.machine.commission.stages import ONCE_MORE, Stage, in_stages, judged, measured_twice

LEAST_READINGS: Final = 20
"""Fewest readings of the cell for judging whether they have settled [A]: five per quarter."""
QUARTERS: Final = 4
NOISES: Final = 4.0
"""Tolerance for noise, in standard deviations of the means: pure noise exceeds it in 2 % of cases [A]."""


def settled_cell(seat: JogSeat) -> Generator[Waits, str, list[float]]:
    """Yield until the cell's readings have settled; return the means of Fx, Fy, Fz, raw, N.

    Settled: the means of the quarters of the last ``AVERAGE_S`` of readings agree within ``STILL_N`` and their noise.
    The noise is estimated from successive readings, because a swing is slower. Raises StepRefused if the weight still
    swings after ``SWINGS_S``.
    """
    rows: deque[tuple[float, float, float, float]] = deque()
    began_s = inf

    def settled() -> bool:
        quarter = len(rows) // QUARTERS
        for i in range(1, 4):
            values = [row[i] for row in rows]
            noise = sqrt(0.5 * fmean((after - before) ** 2 for before, after in pairwise(values)))
            means = [fmean(values[place * quarter : (place + 1) * quarter]) for place in range(QUARTERS)]
            if max(means) - min(means) > STILL_N + NOISES * noise / sqrt(quarter):
                return False
        return True

    def enough(now_s: float) -> bool:
        nonlocal began_s
        began_s = min(began_s, now_s)
        cell = seat.devices.cell
        if cell.valid and (not rows or cell.stamp_s > rows[-1][0]) and all(map(isfinite, cell.raw[:3])):
            rows.append((cell.stamp_s, cell.raw[0], cell.raw[1], cell.raw[2]))
            while rows[-1][0] - rows[0][0] > AVERAGE_S:
                rows.popleft()
        if now_s - began_s > SWINGS_S:
            raise StepRefused(
                f"the load cell's readings have not settled within {STILL_N:g} N in {SWINGS_S:g} s: the weight swings,"
                " or the cell drifts"
            )
        return now_s - began_s >= AVERAGE_S and len(rows) >= LEAST_READINGS and settled()

    yield enough
    return [fmean(row[i] for row in rows) for i in range(1, 4)]


CHANNELS: Final = ("x", "y", "z")
PLAN: Final = {"z": (50.0, 100.0, 200.0, 300.0, 200.0), "x": (50.0, 100.0, 200.0, 100.0), "y": (50.0, 100.0, 200.0)}
"""Approximate weights, N, by the loaded channel: rising, and one while falling, for hysteresis [A]."""
CHANNELS_HUNG: Final = tuple(PLAN)
ASKED_AGAIN: Final = 1.2
"""A weight off what the cell shows by a greater factor is asked for once more, and no gain is advised from it [A]."""
AVERAGE_S: Final = 1.0
"""Averaging time of a settled point, s [A]: 0.25 N of noise at 100 readings a second leaves 0.025 N."""
STILL_N: Final = 0.1
"""Settled: the means of those quarters agree within this and their noise [A]: 0.2 % of the least weight."""
SWINGS_S: Final = 30.0
"""Longest swing of a weight, s [A]."""
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


@dataclass(slots=True)
class HungChannel:
    """The points of one channel: the hung force, N, and the readings of all channels above zero, N."""

    name: str
    hung_n: list[float] = field(default_factory=list[float])
    shown_n: list[tuple[float, float, float]] = field(default_factory=list[tuple[float, float, float]])

    def slopes(self) -> tuple[float, float, float]:
        """Return each channel's reading per newton on this channel, by least squares through zero."""
        square = sum(f * f for f in self.hung_n)
        x, y, z = (
            sum(f * s[i] for f, s in zip(self.hung_n, self.shown_n, strict=True)) / square for i in range(3)
        )
        return x, y, z

    @property
    def place(self) -> int:
        """The channel's place in ``CHANNELS``."""
        return CHANNELS.index(self.name)

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
        totals = [sum(abs(s[i]) for s in self.shown_n) for i in range(3)]
        return totals.index(max(totals))


def calibrate(seat: JogSeat, notes: Notes) -> Dialogue:
    """Calibrate every channel with hung weights; raises StepRefused."""
    hung = _Hung(seat, notes)
    stages: list[Stage] = [hung.ask_weights]
    for name, plan in PLAN.items():
        first = partial(hung.ask_zero, name)
        stages.append(first)
        channel = hung.channels[name]
        abouts = [about for about in plan if about <= seat.rig.limits.load_n]
        stages += [partial(hung.ask_point, channel, place, about) for place, about in enumerate(abouts)]
        stages += [partial(hung.ask_mistyped, channel), judged(first, partial(hung.judge, channel))]
    yield from in_stages(notes, *stages, hung.ask_off, hung.ask_due, hung.conclude)


class _Hung:
    """The stages of a calibration with hung weights."""

    def __init__(self, seat: JogSeat, notes: Notes) -> None:
        """Nothing hangs yet."""
        self.seat, self.notes = seat, notes
        self.channels = {name: HungChannel(name) for name in PLAN}
        self.zero: list[float] = []
        self.weights = self.due = ""

    def ask_weights(self) -> Dialogue:
        """Ask for the weights' certificate."""
        self.weights = yield from line(
            "weights certificate",
            "which weights, with which certificate? Force = mass times local gravity (9.78 to 9.83)",
        )

    def _off(self, name: str) -> str:
        before = CHANNELS_HUNG[CHANNELS_HUNG.index(name) - 1] if name != CHANNELS_HUNG[0] else ""
        return f"F{before}: take the weights off. " if before else ""

    def ask_zero(self, name: str) -> Dialogue:
        """Read the cell without a weight."""
        text = f"{self._off(name)}F{name}: hang up hook and wire, no weight yet; type 0"
        yield from measured_twice(f"hang {name} 0.0", text, "N", _not_zero)
        self.zero = yield from settled_cell(self.seat)

    def ask_point(self, channel: HungChannel, place: int, about: float) -> Dialogue:
        """Ask for a hung force, and read the cell; a force far from what the cell shows is asked for once more."""
        key = f"hang {channel.name} {about}"
        what = f"F{channel.name}: hang about {about:g} N, wait until it is still, and type the force of all that hangs"
        hung = yield from measured_twice(key, what, "N", lambda force: "" if force > 0.0 else "no weight has it")
        if not hung > 0.0:
            raise StepRefused(f"a weight of {hung:g} N cannot be hung")
        mean = yield from settled_cell(self.seat)
        shown = (mean[0] - self.zero[0], mean[1] - self.zero[1], mean[2] - self.zero[2])
        most = max(abs(force) for force in shown)
        if not 1.0 / ASKED_AGAIN <= most / hung <= ASKED_AGAIN:
            text = (
                f"{hung:g} N was typed, the cell shows {most:.4g} N. Once more: the force of all that hangs, in newtons"
                " (kilograms times gravity)?"
            )
            hung = yield from measure(f"{ONCE_MORE}{key}", text, "N")
        del channel.hung_n[place:], channel.shown_n[place:]
        channel.hung_n.append(hung)
        channel.shown_n.append(shown)
        self.notes.read(f"F{channel.name} {about:g} N", {"hung_n": hung, "shown_n": list(shown)})

    def ask_mistyped(self, channel: HungChannel) -> Dialogue:
        """Ask once more for a weight that does not fit the others."""
        wrong = channel.typed_wrongly()
        if wrong >= 0:
            yield from _again(self.notes, channel, wrong)

    def judge(self, channel: HungChannel) -> None:
        """Raise StepRefused for a channel that is not as the rig file has it, or a weight that does not fit."""
        wrong = channel.typed_wrongly()
        if wrong >= 0:
            answer = channel.answering()
            raise StepRefused(
                f"F{channel.name}: the weight typed as {channel.hung_n[wrong]:g} N does not fit the others (it was"
                f" about {_seems_n(channel, wrong, answer):.1f} N): a weight was typed wrongly, or something bears on"
                " the cell"
            )
        _judge(channel)

    def ask_off(self) -> Dialogue:
        """Let the person take everything off."""
        last = CHANNELS_HUNG[-1]
        text = f"F{last}: take the weights off. Take off hook and wire as well; type 0"
        yield from measured_twice(f"hang {last} 0.0", text, "N", _not_zero)

    def ask_due(self) -> Dialogue:
        """Ask for the last day on which the calibration is valid."""
        self.due = yield from _due()

    def conclude(self) -> Dialogue:
        """Report what was found."""
        _conclude(self.notes, list(self.channels.values()), self.zero, self.weights, self.due)
        yield from ()


def _not_zero(typed: float) -> str:
    return "" if typed == 0.0 else "nothing is to hang: 0 is expected"


def _seems_n(channel: HungChannel, wrong: int, answer: int) -> float:
    """Return the force of a point by the channel's other points, N."""
    pairs = zip(channel.hung_n, channel.shown_n, strict=True)
    others = [shown[answer] / force for place, (force, shown) in enumerate(pairs) if place != wrong]
    return abs(channel.shown_n[wrong][answer] / median(others))


def _again(notes: Notes, channel: HungChannel, wrong: int) -> Dialogue:
    """Ask once more for a weight that does not fit the others."""
    typed, seems = channel.hung_n[wrong], _seems_n(channel, wrong, channel.answering())
    text = f"F{channel.name}: {typed:g} N was typed, by the other points it was about {seems:.1f} N; what was it?"
    notes.tell(text)
    channel.hung_n[wrong] = yield from measure(f"retype {channel.name} {seems:.6g}", text, "N")
    notes.read(f"F{channel.name} typed again", {"before_n": typed, "hung_n": channel.hung_n[wrong]})


def _judge(channel: HungChannel) -> None:
    """Raise StepRefused for a channel whose wiring, scale or mounting differs from the rig file."""
    slopes, place, name = channel.slopes(), channel.place, channel.name
    answer = channel.answering()
    if answer != place and abs(slopes[answer]) > CROSSED_SHARE:
        raise StepRefused(
            f"load cell channels are swapped: a weight on F{name} shows on F{CHANNELS[answer]}"
            f" ({slopes[answer]:+.2f} N/N). Change the wires at the transmitter, or the profile's addresses"
        )
    gain = slopes[place]
    if gain < 0.0:
        raise StepRefused(
            f"the sign of the load cell's F{name} is reversed: a weight shows {gain:+.3f} N/N."
            " Swap its signal wires, or its sign at the transmitter"
        )
    if not 1.0 / ASKED_AGAIN <= gain <= ASKED_AGAIN:
        raise StepRefused(
            f"gain of the load cell's F{name}: {gain:.4g} N shown for each N hung. No setting of a sound cell explains"
            " that: look at the unit of the weights, at pulley and wire, at the transmitter's full load; the profile"
            " stays as it is"
        )
    if not abs(gain - 1.0) <= GAIN_SHARE:
        raise StepRefused(
            f"gain of the load cell's F{name}: {gain:.4f} N shown for each N hung, beyond {100 * GAIN_SHARE:g} %."
            f" Multiply the channel's sensitivity at the transmitter (mV/V at full load) by {gain:.5f}, or the scale of"
            f" its signal in the profile by {1 / gain:.5f}"
        )
    for other, slope in enumerate(slopes):
        if other != place and abs(slope) > COUPLING_SHARE:
            raise StepRefused(
                f"F{CHANNELS[other]} shows {100 * slope:+.1f} % of a force on F{name}, more than"
                f" {100 * COUPLING_SHARE:g} %: crosstalk, or the cell is mounted {57.3 * abs(slope):.1f} degrees off"
            )


def _due() -> Generator[Waits, str, str]:
    """Ask for the last day on which the calibration is valid, and return it."""
    text = "until which day does this calibration count (2027-01-31)? A year is usual for a cell in daily use [A]"
    while True:
        answer = yield from line("due", text)
        try:
            return date.fromisoformat(answer).isoformat()
        except ValueError:
            text = f'"{answer}" is no date such as 2027-01-31; until which day does it count?'


def _conclude(notes: Notes, channels: list[HungChannel], zero: list[float], weights: str, due: str) -> None:
    """Report and record the results, and print the lines for the rig file."""
    by_name = {channel.name: channel for channel in channels}
    gains = {name: channel.slopes()[channel.place] for name, channel in by_name.items()}
    standards = {name: channel.standard() for name, channel in by_name.items()}
    ratio = gains["x"] / gains["z"] - 1.0
    sensitivity = hypot(ratio, standards["x"], standards["z"])
    residual = max(abs(r) for channel in channels for r in channel.residuals())
    notes.values = {
        "weights": weights,
        "due": due,
        "zero_n": zero,
        "points": {name: {"hung_n": c.hung_n, "shown_n": [list(s) for s in c.shown_n]} for name, c in by_name.items()},
        "gains": gains,
        "standard_uncertainties": standards,
        "matrix": {name: list(channel.slopes()) for name, channel in by_name.items()},
        "residuals_n": {name: channel.residuals() for name, channel in by_name.items()},
        "cell_sensitivity": sensitivity,
    }
    notes.text = (
        ", ".join(f"F{name} {gains[name]:.5f} +- {standards[name]:.5f}" for name in CHANNELS)
        + f" N/N (standard uncertainty); largest residual {residual:.2f} N; weights: {weights}; counts until {due}"
    )
    notes.tell("  for the rig file, section calibration:")
    notes.tell(f'    load_cell: "{due}"')
    notes.tell("    overdue: refuse               # or warn")
    notes.tell("    record: ...                   # the hash after \"on record\", below")
    notes.tell(f"    cell_sensitivity: {100 * sensitivity:.3f} %     # Fx/Fz off by {100 * ratio:+.3f} %, with U")
