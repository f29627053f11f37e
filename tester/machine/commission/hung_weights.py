"""Calibrate the load cell with hung weights: points, fit, residuals, uncertainty, person, reference, expiry.

Nothing has power. Each weight loads one channel; a line through zero is fitted to each channel's readings less its
zero. Crossed wires, a wrong sign, a wrong gain and a mistyped weight show before anything presses:

- a typed weight that deviates from the channel's other points by more than ``TYPED_SHARE`` is requested once more;
- a channel is refused, with the remedy, if its weights show on another channel, with the wrong sign or another gain.

A kind supplies the ways in which weights hang (``CellPlan``). The readings are not corrected for the cell's error.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator
from dataclasses import dataclass
from datetime import date
from functools import partial
from itertools import pairwise
from math import inf, isfinite, sqrt
from statistics import fmean, median
from typing import Final

from tester.inputs.rig import Rig
from tester.machine.commission.commission_step import Dialogue, Notes, StepRefused, Waits, choose, line, measure
from tester.machine.commission.hung_channel import ASKED_AGAIN, HungChannel, HungWay, judge_channel
from tester.machine.commission.quiet_seat import QuietSeat
from tester.machine.commission.stages import ONCE_MORE, Stage, in_stages, judged, measured_twice

LEAST_READINGS: Final = 20
"""Fewest readings of the cell for judging whether they have settled [A]: five per quarter."""
QUARTERS: Final = 4
NOISES: Final = 4.0
"""Tolerance for noise, in standard deviations of the means: pure noise exceeds it in 2 % of cases [A]."""


AVERAGE_S: Final = 1.0
"""Averaging time of a settled point, s [A]: 0.25 N of noise at 100 readings a second leaves 0.025 N."""
STILL_N: Final = 0.1
"""Settled: the means of those quarters agree within this and their noise [A]: 0.2 % of the least weight."""
SWINGS_S: Final = 30.0
"""Longest swing of a weight, s [A]."""


@dataclass(frozen=True, slots=True)
class CellPlan:
    """A kind's calibration. ``channels``: labels of the cell's channels; ``most_n``: the rig's greatest weight, N."""

    channels: tuple[str, ...]
    ways: tuple[HungWay, ...]
    most_n: Callable[[Rig], float]
    conclude: Callable[[Notes, HungCell], None]
    """Reports and records the results, and prints the lines for the rig file."""
    still_n: float = STILL_N
    zero_n: Callable[[Rig], float] = lambda rig: inf
    """Returns the greatest reading without a weight, N."""


def settled_cell(seat: QuietSeat, still_n: float = STILL_N) -> Generator[Waits, str, list[float]]:
    """Yield until the cell's readings have settled; return the means of its channels, raw, N.

    Settled: the means of the quarters of the last ``AVERAGE_S`` of readings agree within ``still_n`` and their noise.
    The noise is estimated from successive readings, because a swing is slower. Raises StepRefused if the weight still
    swings after ``SWINGS_S``.
    """
    cell = seat.cell
    rows: deque[tuple[float, tuple[float, ...]]] = deque()
    began_s = inf

    def settled() -> bool:
        quarter = len(rows) // QUARTERS
        for values in zip(*(row for _, row in rows), strict=True):
            noise = sqrt(0.5 * fmean((after - before) ** 2 for before, after in pairwise(values)))
            means = [fmean(values[place * quarter : (place + 1) * quarter]) for place in range(QUARTERS)]
            if max(means) - min(means) > still_n + NOISES * noise / sqrt(quarter):
                return False
        return True

    def enough(now_s: float) -> bool:
        nonlocal began_s
        began_s = min(began_s, now_s)
        if cell.valid and (not rows or cell.stamp_s > rows[-1][0]) and all(map(isfinite, cell.raw)):
            rows.append((cell.stamp_s, tuple(cell.raw)))
            while rows[-1][0] - rows[0][0] > AVERAGE_S:
                rows.popleft()
        if now_s - began_s > SWINGS_S:
            raise StepRefused(
                f"the load cell's readings have not settled within {still_n:g} N in {SWINGS_S:g} s: the weight swings,"
                " or the cell drifts"
            )
        return now_s - began_s >= AVERAGE_S and len(rows) >= LEAST_READINGS and settled()

    yield enough
    return [fmean(values) for values in zip(*(row for _, row in rows), strict=True)]


def calibrate(plan: CellPlan, seat: QuietSeat, notes: Notes) -> Dialogue:
    """Calibrate every channel with hung weights; raises StepRefused."""
    hung = HungCell(plan, seat, notes)
    stages: list[Stage] = [hung.ask_weights]
    for way in plan.ways:
        first = partial(hung.ask_zero, way)
        stages.append(first)
        channel = hung.channels[way.name]
        most_n = plan.most_n(seat.rig)
        abouts = [about for about in way.plan if about <= most_n]
        if not abouts:
            least_n = min(way.plan)
            raise StepRefused(f"{way.label}: the least weight, {least_n:g} N, is more than the rig's {most_n:g} N")
        stages += [partial(hung.ask_point, channel, place, about) for place, about in enumerate(abouts)]
        stages += [partial(hung.ask_mistyped, channel), judged(first, partial(hung.judge, channel))]
    yield from in_stages(notes, *stages, hung.ask_off, hung.ask_due, hung.finish)


class HungCell:
    """The stages of a calibration with hung weights."""

    def __init__(self, plan: CellPlan, seat: QuietSeat, notes: Notes) -> None:
        """Nothing hangs yet."""
        self.plan, self.seat, self.notes = plan, seat, notes
        self.channels = {way.name: HungChannel(way) for way in plan.ways}
        self.skipped: set[str] = set()
        """Names of ways in which no weight can hang."""
        self.zero: list[float] = []
        self.weights = self.due = ""

    def ask_weights(self) -> Dialogue:
        """Ask for the weights' certificate."""
        self.weights = yield from line(
            "weights certificate",
            "which weights, with which certificate? Force = mass times local gravity (9.78 to 9.83)",
        )

    def _off(self, way: HungWay) -> str:
        place = self.plan.ways.index(way)
        return f"{self.plan.ways[place - 1].label}: take the weights off. " if place else ""

    def ask_zero(self, way: HungWay) -> Dialogue:
        """Read the cell without a weight."""
        self.skipped.discard(way.name)
        if way.optional:
            text = f"{way.label}: can weights pull this way, too?"
            if (yield from choose(f"possible {way.name}", text, "yes", "no")) == "no":
                self.skipped.add(way.name)
                return
        text = f"{self._off(way)}{way.label}: hang up hook and wire{way.how}, no weight yet; type 0"
        yield from measured_twice(f"hang {way.name} 0.0", text, "N", _not_zero)
        self.zero = yield from settled_cell(self.seat, self.plan.still_n)
        most_n = self.plan.zero_n(self.seat.rig)
        if not all(abs(zero) <= most_n for zero in self.zero):
            raise StepRefused(
                f"zero of the load cell: it shows {max(self.zero, key=abs):.1f} N with nothing hung, at most {most_n:g}"
                " N count as zero (arming.unloaded), and no run arms: set its zero at the transmitter; does something"
                " touch?"
            )

    def ask_point(self, channel: HungChannel, place: int, about: float) -> Dialogue:
        """Ask for a hung force, and read the cell; a force far from what the cell shows is asked for once more."""
        if channel.name in self.skipped:
            return
        key = f"hang {channel.name} {about}"
        what = f"{channel.way.label}: hang about {about:g} N, let it come to rest, and type the force of all that hangs"
        hung = yield from measured_twice(key, what, "N", lambda force: "" if force > 0.0 else "no weight has it")
        if not hung > 0.0:
            raise StepRefused(f"a weight of {hung:g} N cannot be hung")
        mean = yield from settled_cell(self.seat, self.plan.still_n)
        sign = channel.way.sign
        shown = tuple(sign * (force - zero) for force, zero in zip(mean, self.zero, strict=True))
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
        self.notes.read(f"{channel.way.label} {about:g} N", {"hung_n": hung, "shown_n": list(shown)})

    def ask_mistyped(self, channel: HungChannel) -> Dialogue:
        """Ask once more for a weight that does not fit the others."""
        wrong = -1 if channel.name in self.skipped else channel.typed_wrongly()
        if wrong >= 0:
            yield from _again(self.notes, channel, wrong)

    def judge(self, channel: HungChannel) -> None:
        """Raise StepRefused for a channel that is not as the rig file has it, or a weight that does not fit."""
        if channel.name in self.skipped:
            return
        wrong = channel.typed_wrongly()
        if wrong >= 0:
            answer = channel.answering()
            raise StepRefused(
                f"{channel.way.label}: the weight typed as {channel.hung_n[wrong]:g} N does not fit the others (it was"
                f" about {_seems_n(channel, wrong, answer):.1f} N): a weight was typed wrongly, or something bears on"
                " the cell"
            )
        judge_channel(channel, self.plan.channels)

    def ask_off(self) -> Dialogue:
        """Let the person take everything off."""
        last = [way for way in self.plan.ways if way.name not in self.skipped][-1]
        text = f"{last.label}: take the weights off. Take off hook and wire as well; type 0"
        yield from measured_twice(f"hang {last.name} 0.0", text, "N", _not_zero)

    def ask_due(self) -> Dialogue:
        """Ask for the last day on which the calibration is valid."""
        self.due = yield from _due()

    def finish(self) -> Dialogue:
        """Record and report what was found."""
        channels = self.hung()
        self.notes.values = {
            "weights": self.weights,
            "due": self.due,
            "zero_n": self.zero,
            "points": {
                name: {"hung_n": c.hung_n, "shown_n": [list(s) for s in c.shown_n]} for name, c in channels.items()
            },
            "gains": self.gains(),
            "standard_uncertainties": self.standards(),
            "matrix": {name: list(channel.slopes()) for name, channel in channels.items()},
            "residuals_n": {name: channel.residuals() for name, channel in channels.items()},
        }
        gains, standards = self.gains(), self.standards()
        residual = max(abs(r) for channel in channels.values() for r in channel.residuals())
        self.notes.text = (
            ", ".join(
                f"{way.label} {gains[way.name]:.5f} +- {standards[way.name]:.5f}"
                for way in sorted((channel.way for channel in channels.values()), key=lambda way: way.label)
            )
            + f" N/N (standard uncertainty); largest residual {residual:.2f} N; weights: {self.weights}; counts until"
            f" {self.due}"
        )
        self.plan.conclude(self.notes, self)
        yield from ()

    def hung(self) -> dict[str, HungChannel]:
        """Return the ways in which weights hung."""
        return {name: channel for name, channel in self.channels.items() if name not in self.skipped}

    def gains(self) -> dict[str, float]:
        """Return each way's reading of its own channel per newton hung."""
        return {name: channel.slopes()[channel.place] for name, channel in self.hung().items()}

    def standards(self) -> dict[str, float]:
        """Return the gains' standard uncertainties."""
        return {name: channel.standard() for name, channel in self.hung().items()}


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
    text = f"{channel.way.label}: {typed:g} N was typed, by the other points it was about {seems:.1f} N; what was it?"
    notes.tell(text)
    channel.hung_n[wrong] = yield from measure(f"retype {channel.name} {seems:.6g}", text, "N")
    notes.read(f"{channel.way.label} typed again", {"before_n": typed, "hung_n": channel.hung_n[wrong]})


def _due() -> Generator[Waits, str, str]:
    """Ask for the last day on which the calibration is valid, and return it."""
    text = "until which day does this calibration count (2027-01-31)? A year is usual for a cell in daily use [A]"
    while True:
        answer = yield from line("due", text)
        try:
            return date.fromisoformat(answer).isoformat()
        except ValueError:
            text = f'"{answer}" is no date such as 2027-01-31; until which day does it count?'


def tell_calibration(notes: Notes, due: str) -> None:
    """Print the lines of the rig file that name a calibration."""
    notes.tell("  for the rig file, section calibration:")
    notes.tell(f'    load_cell: "{due}"')
    notes.tell("    overdue: refuse               # or warn")
    notes.tell("    record: ...                   # the hash after \"on record\", below")
