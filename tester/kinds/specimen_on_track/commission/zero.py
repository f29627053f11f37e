"""The zero over the travel or over revolutions: the force while the track moves with the arm raised.

Nothing touches, so that the cell should show the same everywhere. A force that varies with the place is run-out or
crosstalk; one that turns round with the direction is drag of a cable or a seal. Both enter every coefficient.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from math import inf, pi
from statistics import fmean
from typing import Final

from tester.kinds.specimen_on_track.commission.seats import TrackSeat
from tester.kinds.specimen_on_track.procedures.motions import ComeToStand, GoTo, TurnFor
from tester.machine.commission.commission_step import Dialogue, Notes, StepRefused, Waits, choose, press
from tester.machine.commission.stages import in_stages
from tester.machine.motions import Power, Sequence

ZERO_SHARE: Final = 0.01
"""Greatest variation and drag, as a share of the least weight [A]: as much as the coefficient is off."""
BINS: Final = 12
"""Places in which the force is averaged [A]: a period of a twelfth of the way is resolved."""
REVOLUTIONS: Final = 3
TURNS_M_S: Final = 0.1
REST_S: Final = 2.0
"""Averaging time at rest, s [A]: 0.02 N of noise leave 0.002 N."""
INSIDE_MM: Final = 5.0
"""The track turns round this far inside its soft ends, mm [A]."""


@dataclass(slots=True)
class Seen:
    """The force by place: the sums in ``BINS`` of a way's share, 0 to 1."""

    sums: list[float] = field(default_factory=lambda: [0.0] * BINS)
    counts: list[int] = field(default_factory=lambda: [0] * BINS)

    def add(self, share: float, force_n: float) -> None:
        """Add a reading."""
        place = min(max(int(share * BINS), 0), BINS - 1)
        self.sums[place] += force_n
        self.counts[place] += 1

    def means(self) -> list[float]:
        """Return the means of the bins; raises StepRefused for a place without a reading."""
        if not all(self.counts):
            raise StepRefused("zero: the load cell gave no valid reading on part of the way")
        return [total / count for total, count in zip(self.sums, self.counts, strict=True)]


def zero(seat: TrackSeat, notes: Notes) -> Dialogue:
    """Move the track with the arm raised; raises StepRefused."""
    yield from in_stages(notes, lambda: _over_the_way(seat, notes))


def _over_the_way(seat: TrackSeat, notes: Notes) -> Dialogue:
    rig, ctx = seat.rig, seat.ctx
    if rig.axes.lift is None:
        yield from choose("arm raised", "raise the arm by hand, nothing touches the specimen; done?", "yes")
        ctx.devices.by_hand_mm = rig.arm.raised_mm
    where = "over its travel, forward and back" if rig.linear else f"for {REVOLUTIONS} revolutions"
    yield from press("zero run", f"track: arm raised, hands off, guard closed; it moves {where}", seat.guarded)
    yield from seat.do(Sequence(Power(True), ComeToStand()))
    rest_n = yield from _at_rest(seat)
    forward, back = (yield from _linear(seat)) if rig.linear else (yield from _disc(seat, notes))
    after_n = yield from _at_rest(seat)
    yield from seat.do(Sequence(Power(False)))
    means = forward.means()
    returning = back.means() if back is not None else []
    # Of a disc, which turns one way, the force at rest takes the place of the way back.
    drag_n = 0.5 * (fmean(means) - fmean(returning)) if returning else fmean(means) - 0.5 * (rest_n + after_n)
    middle = [0.5 * (a + b) for a, b in zip(means, returning, strict=True)] if returning else means
    varies_n = max(middle) - min(middle)
    notes.read("force by place", {"forward_n": means, "back_n": returning, "rest_n": [rest_n, after_n]})
    _judge(rig.weights[0], varies_n, drag_n, "travel" if rig.linear else "revolution")
    notes.values = {"zero_n": rest_n, "varies_n": varies_n, "drag_n": drag_n, "drift_n": after_n - rest_n}
    notes.text = (
        f"zero {rest_n:+.2f} N, with the arm raised it varies by {varies_n:.3f} N over the"
        f" {'travel' if rig.linear else 'revolution'}, drag {drag_n:+.3f} N"
    )


def _judge(least_n: float, varies_n: float, drag_n: float, way: str) -> None:
    # Run-out first: of a disc, the force at rest is that of one place.
    most_n = ZERO_SHARE * least_n
    limit = f"at most {most_n:g} N, {100 * ZERO_SHARE:g} % of the least weight: {ZERO_SHARE:g} of a coefficient"
    if not varies_n <= most_n:
        raise StepRefused(
            f"run-out: with the arm raised the force varies by {varies_n:.2f} N over the {way} ({limit}): the cell's"
            " cable, crosstalk from a track that is not level, or a frame that bends"
        )
    if not abs(drag_n) <= most_n:
        raise StepRefused(
            f"drag: the moving track changes the force by {drag_n:+.2f} N with the arm raised ({limit}): a cable,"
            " a seal or a draught pulls at the arm, or something still touches"
        )


def _watched(seat: TrackSeat, activity: Sequence, see: Callable[[], None]) -> Dialogue:
    """Carry out an activity, and look at every scan."""
    executor = seat.executor
    executor.activity = activity

    def over(now_s: float) -> bool:
        if seat.ctx.readings.cell_valid:
            see()
        return executor.activity is None and not executor.failed

    yield over


def _at_rest(seat: TrackSeat) -> Generator[Waits, str, float]:
    """Return the mean force at rest, N."""
    forces, began_s = list[float](), inf

    def enough(now_s: float) -> bool:
        nonlocal began_s
        began_s = min(began_s, now_s)
        if seat.ctx.readings.cell_valid:
            forces.append(seat.ctx.readings.force_n)
        return now_s - began_s >= REST_S and bool(forces)

    yield enough
    return fmean(forces)


def _linear(seat: TrackSeat) -> Generator[Waits, str, tuple[Seen, Seen | None]]:
    """Move to the low end, to the high end, back, and to the middle; return the force on both long ways."""
    limits, r = seat.rig.limits, seat.ctx.readings
    low_mm, high_mm = limits.travel_low_mm + INSIDE_MM, limits.travel_high_mm - INSIDE_MM
    forward, back = Seen(), Seen()

    def see(seen: Seen) -> Callable[[], None]:
        return lambda: seen.add((r.track_mm - low_mm) / (high_mm - low_mm), r.force_n)

    yield from seat.do(Sequence(GoTo(low_mm), ComeToStand()))
    yield from _watched(seat, Sequence(GoTo(high_mm)), see(forward))
    yield from seat.do(Sequence(ComeToStand()))
    yield from _watched(seat, Sequence(GoTo(low_mm)), see(back))
    yield from seat.do(Sequence(ComeToStand(), GoTo(0.5 * (low_mm + high_mm)), ComeToStand()))
    return forward, back


def _disc(seat: TrackSeat, notes: Notes) -> Generator[Waits, str, tuple[Seen, Seen | None]]:
    """Turn a disc; return the force by its angle."""
    round_m = 2e-3 * pi * float(notes.done["jog track"]["radius_mm"])
    speed = min(max(TURNS_M_S, seat.rig.limits.slowest_m_s), seat.rig.limits.track_speed_m_s)
    seen, r = Seen(), seat.ctx.readings
    turning = Sequence(TurnFor(REVOLUTIONS * round_m, speed))
    yield from _watched(seat, turning, lambda: seen.add(r.way_m / round_m % 1.0, r.force_n))
    yield from seat.do(Sequence(ComeToStand()))
    return seen, None
