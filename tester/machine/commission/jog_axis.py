"""Jog an axis: first a short way, to check its identity and direction; then further, to check its scale.

A person reads a ruler, a protractor or a dial gauge and types the value. The scale is this value over the way that the
drive reports. A value beyond the tolerance is asked for once more; then the step is refused, and the message gives the
correct increments, if a diameter or a gear explains them. The first way is
so short and slow that a motion ten times as far and fast is harmless.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, hypot, nan, pi
from typing import Final

from drivers.gearing import WITHIN, gear_ratio
from tester.machine.commission.commission_step import Dialogue, Measured, Notes, StepRefused, choose, press, wait
from tester.machine.commission.jogging import JogSpeeds
from tester.machine.commission.quiet_seat import JogSeat
from tester.machine.commission.stages import Stage, in_stages, measured_twice

FIRST_SHARE: Final = 0.3
"""Tolerance of the first, short way, share [A]: a ruler on a few millimetres."""
SPRING_S: Final = 1.5
"""Time for a spring to take the press back, s [A]: 4 mm at 20 mm/s take 0.2 s."""
ROLLER_SHARE: Final = 1.2
"""Greatest factor of a scale that a roller's diameter or a spindle's lead explains [A]; beyond it a gear has to."""
LEAST_RADIUS_MM, MOST_RADIUS_MM = 5.0, 500.0
NO_RADIUS: Final = f"a disc's track has {LEAST_RADIUS_MM:g} to {MOST_RADIUS_MM:g} mm"
"""Radii of the discs of such rigs, mm [A]: another number has another unit."""
RADIUS_MM: Final = 0.3
"""Standard uncertainty of a radius read by a ruler, mm [A]: half a millimetre's division, and the specimen's middle."""
STUCK_SHARE: Final = 1e-3
"""A key that moves an axis by less than this share of the way has not moved it [A]."""
DIAMETER_SHARE: Final = 0.03
"""Within this a factor of two counts as a diameter in place of a radius [A]."""
RIGHT, REVERSED, OTHER, NOTHING = "yes", "reversed", "other", "nothing"


@dataclass(frozen=True, slots=True)
class JoggedAxis:
    """Data for jogging an axis. ``tolerance``: of its scale; ``reading``: standard uncertainty, in ``unit``."""

    name: str
    speeds: JogSpeeds
    unit: str
    instrument: str
    positive: str
    tolerance: float
    reading: float
    back: bool
    """The axis is moved back afterwards, unlike one that turns endlessly."""
    holds: bool = False
    """The axis is read while its drive holds it: without power a spring pulls it back."""

    factor: float = 1.0
    """The instrument's unit per unit of the axis; on a disc: mm of way per unit."""
    disc: bool = False
    """The axis turns a disc, and its unit is a way at the track's radius, which a person measures."""

    @property
    def way_unit(self) -> str:
        """Unit of ``shown``."""
        return "mm" if self.disc else self.unit

    def shown(self, moved: float) -> float:
        """Return a way in the unit of the person's instrument, on a disc in mm."""
        return self.factor * moved


def jog_axis(axis: JoggedAxis, seat: JogSeat, notes: Notes) -> Dialogue:
    """Jog an axis for direction and scale; raises StepRefused."""
    if axis.name not in seat.believed.drives():
        notes.text = "set by hand: nothing to jog"
        return
    jog = _AxisJog(axis, seat, notes)
    radius: tuple[Stage, ...] = (jog.ask_radius,) if axis.disc else ()
    yield from in_stages(
        notes, *radius, jog.first_way, jog.direction, jog.first_read, jog.mark, jog.whole_way, jog.whole_read, jog.back
    )


class _AxisJog:
    """The stages of an axis' jog."""

    def __init__(self, axis: JoggedAxis, seat: JogSeat, notes: Notes) -> None:
        """Move nothing yet."""
        self.axis, self.seat, self.notes = axis, seat, notes
        self.whole_way_wanted = axis.speeds.way
        self.radius_mm = nan
        self.began = seat.jogging.drive(axis.name).actual
        self.first = self.whole = nan
        """What the drive reported of both ways, in the unit of the instrument."""
        seat.jogging.mark(axis.name)

    def ask_radius(self) -> Dialogue:
        """Ask for the radius of a disc's track; one revolution is the measured way."""
        name = self.axis.name
        text = f"{name}: what is the radius from the disc's axis to the middle of the specimen (not the diameter)?"
        self.radius_mm = yield from measured_twice(
            f"jog {name} radius", text, "mm", lambda r: "" if LEAST_RADIUS_MM <= r <= MOST_RADIUS_MM else NO_RADIUS
        )
        if not LEAST_RADIUS_MM <= self.radius_mm <= MOST_RADIUS_MM:
            raise StepRefused(f"radius of the {name}: {self.radius_mm:g} mm typed, {NO_RADIUS}")
        self.whole_way_wanted = 2.0 * pi * self.radius_mm / self.axis.factor

    def shown(self, moved: float) -> float:
        """Return a way in the unit of the person's instrument; on a disc the angle at the radius that was read."""
        return degrees(self.axis.shown(moved) / self.radius_mm) if self.axis.disc else self.axis.shown(moved)

    @property
    def uncertainty(self) -> float:
        """Standard uncertainty of the whole way, share: the reading, and the radius of a disc."""
        radius = RADIUS_MM / self.radius_mm if self.axis.disc else 0.0
        return hypot(self.axis.reading / abs(self.whole), radius)

    def first_way(self) -> Dialogue:
        """Move a short way, slowly."""
        yield from self._move("first", self.axis.speeds.first_way, self.axis.speeds.first)
        self.first = self.shown(self.seat.jogging.moved)

    def direction(self) -> Dialogue:
        """Ask which axis moved, and which way."""
        name = self.axis.name
        seen = yield from choose(
            f"jog {name} direction",
            f"did the {name}, and only it, move {self.axis.positive}?"
            f" ({REVERSED}: the other way; {OTHER}: another axis moved; {NOTHING}: nothing did)",
            RIGHT, REVERSED, OTHER, NOTHING,
        )  # fmt: skip
        _direction(self.axis, self.seat, seen)

    def first_read(self) -> Dialogue:
        """Ask for the short way."""
        axis, shown = self.axis, self.first
        read = yield from self._read("first", "since it was at rest, at first", FIRST_SHARE, shown)
        self.notes.read("first way", {"reported": shown, "read": read, "unit": axis.unit})
        yield from _rest(axis, self.seat)
        if not self._near(read, shown, FIRST_SHARE):
            why = "on the first, little way: measure again after the change"
            raise StepRefused(_wrong_scale(axis, self.seat, read, shown, why))

    def mark(self) -> Dialogue:
        """Let the person set the instrument to zero."""
        yield from _mark(self.axis)
        self.seat.jogging.mark(self.axis.name)

    def whole_way(self) -> Dialogue:
        """Move the whole way, by as many keys as it takes."""
        jogging, whole = self.seat.jogging, self.whole_way_wanted
        while abs(jogging.moved) < abs(whole) - 1e-3 * abs(whole):
            before = jogging.moved
            yield from self._move("further", whole - before, self.axis.speeds.speed)
            if abs(jogging.moved - before) < STUCK_SHARE * abs(whole):
                raise StepRefused(
                    f"the {self.axis.name} axis moves no further by its drive: software limits (0x607D), torque, or"
                    " something is in the way"
                )
        self.whole = self.shown(jogging.moved)

    def whole_read(self) -> Dialogue:
        """Ask for the whole way; its share of what the drive reports is the scale."""
        axis, notes, shown = self.axis, self.notes, self.whole
        read = yield from self._read("whole", "since the mark, not since the last key", axis.tolerance, shown)
        yield from _rest(axis, self.seat)
        share = read / shown
        notes.read("whole way", {"reported": shown, "read": read, "unit": axis.unit, "share": share})
        if not abs(share - 1.0) <= axis.tolerance:
            why = f"more than {100 * axis.tolerance:g} % off"
            raise StepRefused(_wrong_scale(axis, self.seat, read, shown, why))
        notes.values = {
            "reported": shown, "read": read, "unit": axis.unit, "scale_error": share - 1.0,
            "standard_uncertainty": self.uncertainty, **({"radius_mm": self.radius_mm} if axis.disc else {}),
        }  # fmt: skip
        notes.text = (
            f"direction right; {shown:.2f} {axis.unit} reported, {read:.2f} read: scale off by {100 * (share - 1):+.2f}"
            f" % (standard uncertainty {100 * self.uncertainty:.2f} %)"
        )

    def back(self) -> Dialogue:
        """Move an axis that does not turn endlessly back."""
        axis, drive = self.axis, self.seat.jogging.drive(self.axis.name)
        while axis.back and abs(left := self.began - drive.actual) > 0.02 * abs(axis.speeds.way):
            yield from self._move("back", left, axis.speeds.speed)
            yield from _rest(axis, self.seat)

    def _move(self, which: str, way: float, speed: float) -> Dialogue:
        """Wait for a key, a closed guard, and the axis."""
        axis = self.axis
        text = f"{axis.name}: hands off, guard closed; it moves by {self.shown(way):.4g} {axis.unit} at most, and stops"
        yield from press(f"jog {axis.name} {which}", text, self.seat.guarded)
        jog = self.seat.jogging.begin(axis.name, way, speed, holds=axis.holds)
        yield lambda now_s: jog.over

    def _near(self, read: float, shown: float, tolerance: float) -> bool:
        least = 2.0 * self.axis.reading / abs(shown) if tolerance == FIRST_SHARE else 0.0
        return abs(read / shown - 1.0) <= max(tolerance, least)

    def _read(self, which: str, since: str, tolerance: float, shown: float) -> Measured:
        """Ask how far the axis has moved; the intended direction is positive."""
        axis = self.axis

        def refused(read: float) -> str:
            if self._near(read, shown, tolerance):
                return ""
            return f"{read / shown:.3g} times the way that its drive reports; look at its unit, its sign, its decimals"

        text = f"{axis.name}: how far has it moved in all {since}, by {axis.instrument}?"
        return (yield from measured_twice(f"jog {axis.name} {which} read", text, axis.unit, refused))


def _rest(axis: JoggedAxis, seat: JogSeat) -> Dialogue:
    """Switch off an axis that kept its power to be read."""
    jog = seat.jogging.rest() if axis.holds else None
    if jog is not None:
        yield lambda now_s: jog.over
        yield from wait(SPRING_S)


def _mark(axis: JoggedAxis) -> Dialogue:
    yield from choose(f"jog {axis.name} mark", f"{axis.name}: set {axis.instrument} to zero now; done?", "yes")


def _direction(axis: JoggedAxis, seat: JogSeat, seen: str) -> None:
    name, node = axis.name, seat.rig.drives()[axis.name].node_id
    refusals = {
        REVERSED: f"the {name} axis is reversed: it moves the wrong way round. Set its drive's polarity (0x607E) or"
        " swap two of its motor's phases and its encoder's direction, by its manual; the rig file has no sign for it",
        OTHER: f"the {name} axis is not the one that moves at node {node}: node ids or motors are swapped"
        " (axes.*.node_id)",
        NOTHING: f"the {name} axis does not move although its drive at node {node} reports motion: motor, encoder or"
        " coupling",
    }
    if seen in refusals:
        raise StepRefused(refusals[seen])


def _wrong_scale(axis: JoggedAxis, seat: JogSeat, read: float, shown: float, why: str) -> str:
    """Return the error of a scale, with the correct lines of the rig file where a gear explains the error."""
    config, share = seat.believed.drives()[axis.name], read / shown
    if not abs(share) > 1e-6:
        return f"the {axis.name} axis has not moved according to the reading: no scale can be computed"
    moved = f"scale of the {axis.name} axis: it moved {share:.4g} times as far as its drive reports, {why}."
    if axis.disc and share > 0.0 and min(abs(share - 2.0), abs(share - 0.5)) <= DIAMETER_SHARE * share:
        return f"{moved} A diameter in place of a radius explains it, here or in the rig file: measure the radius again"
    if share < 0.0:
        return f"{moved} The sign contradicts the direction that was seen: look at both again"
    if not 1.0 / ROLLER_SHARE <= share <= ROLLER_SHARE:
        ratio = gear_ratio(share, max(WITHIN, 2.0 * axis.reading / abs(shown)))
        if ratio is None:
            return (
                f"{moved} No gear explains that: look at the instrument, at a coupling that gives way, at the"
                " drive's own gear factors; the rig file stays as it is"
            )
        share = float(ratio)
        moved += f" A gear of {ratio.numerator} : {ratio.denominator} explains it."
    right = [f"axes.{axis.name}.velocity_increments: {config.velocity_increments / share:.7g}"]
    if config.position_increments:
        right.append(f"axes.{axis.name}.position_increments: {config.position_increments / share:.7g}")
    return f"{moved} In the rig file: {'; '.join(right)} (now {config.velocity_increments:.7g})"
