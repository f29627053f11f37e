"""Jog an axis: first a short way, to check its identity and direction; then further, to check its scale.

A person reads a ruler, a protractor or a dial gauge and types the value. The scale is this value over the way that the
drive reports; beyond the tolerance the step is refused, and the message gives the correct increments. The first way is
so short and slow that a motion ten times as far and fast is harmless.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, pi
from typing import Final

from tester.kinds.wheel_on_belt.commission.quiet import JogSeat, JogSpeeds
from tester.machine.commission.commission_step import (
    Dialogue,
    Measured,
    Notes,
    StepRefused,
    choose,
    measure,
    press,
    wait,
)

FIRST_SHARE: Final = 0.3
"""Tolerance of the first, short way, share [A]: a ruler on a few millimetres."""
SPRING_S: Final = 1.5
"""Time for a spring to take the press back, s [A]: 4 mm at 20 mm/s take 0.2 s."""
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

    def shown(self, moved: float) -> float:
        """Return a way in the unit of the person's instrument."""
        return degrees(moved) if self.name == "wheel" else 1e3 * moved if self.name == "belt" else moved


AXES: Final = (
    JoggedAxis("wheel", JogSpeeds(0.4, 0.4, 1.0, 2.0 * pi), "deg", "a protractor, or marks on the tread and beside it",
         "so that its lowest point goes the way of the arrow of the belt", 0.01, 0.5, False),
    JoggedAxis("belt", JogSpeeds(0.02, 0.02, 0.05, 0.25), "mm", "a mark on the belt and a ruler beside it",
         "so that its upper side goes the way of the arrow", 0.01, 0.5, False),
    JoggedAxis("press", JogSpeeds(0.5, 0.25, 2.0, 4.0), "mm", "a dial gauge on the press", "towards the contact",
         0.01, 0.01, True, True),
    JoggedAxis("sideslip", JogSpeeds(1.0, 0.5, 2.0, 10.0), "deg", "the yaw axis's scale, or an inclinometer",
         "to the side that the rig's papers call positive", 0.03, 0.1, True),
    JoggedAxis("camber", JogSpeeds(1.0, 0.5, 2.0, 5.0), "deg", "an inclinometer on the wheel's carrier",
         "to the side that the rig's papers call positive", 0.05, 0.1, True),
)  # fmt: skip
"""Ways and speeds are in the axes' units (rad, m, mm, deg; per second) [A]; tolerances [A]; readings: half of an
instrument's finest division [A]."""

SPEEDS: Final = {axis.name: axis.speeds for axis in AXES}


def jog_axis(axis: JoggedAxis, seat: JogSeat, notes: Notes) -> Dialogue:
    """Jog an axis for direction and scale; raises StepRefused."""
    if axis.name not in seat.believed.axes.driven():
        notes.text = "set by hand: nothing to jog"
        return
    speeds = axis.speeds
    began = seat.jogging.drive(axis.name).actual
    first = yield from _move(axis, seat, "first", speeds.first_way, speeds.first)
    seen = yield from choose(
        f"jog {axis.name} direction",
        f"did the {axis.name}, and only it, move {axis.positive}?"
        f" ({REVERSED}: the other way; {OTHER}: another axis moved; {NOTHING}: nothing did)",
        RIGHT, REVERSED, OTHER, NOTHING,
    )  # fmt: skip
    _direction(axis, seat, seen)
    read = yield from _read(axis, "first")
    notes.read("first way", {"reported": axis.shown(first), "read": read, "unit": axis.unit})
    yield from _rest(axis, seat)
    share = abs(read / axis.shown(first))
    least = 2.0 * axis.reading / abs(axis.shown(first))
    if not abs(share - 1.0) <= max(FIRST_SHARE, least):
        raise StepRefused(_wrong_scale(axis, seat, share, "on the first, little way: measure again after the change"))
    moved, whole = 0.0, speeds.way
    yield from _mark(axis)
    while abs(moved) < abs(whole) - 1e-3 * abs(whole):
        moved += yield from _move(axis, seat, "further", whole - moved, speeds.speed)
    read = yield from _read(axis, "whole")
    yield from _rest(axis, seat)
    shown = axis.shown(moved)
    share = read / shown
    notes.read("whole way", {"reported": shown, "read": read, "unit": axis.unit, "share": share})
    if not abs(share - 1.0) <= axis.tolerance:
        raise StepRefused(_wrong_scale(axis, seat, share, f"more than {100 * axis.tolerance:g} % off"))
    drive = seat.jogging.drive(axis.name)
    while axis.back and abs(left := began - drive.actual) > 0.02 * abs(speeds.way):
        yield from _move(axis, seat, "back", left, speeds.speed)
        yield from _rest(axis, seat)
    notes.values = {
        "reported": shown, "read": read, "unit": axis.unit, "scale_error": share - 1.0,
        "standard_uncertainty": axis.reading / abs(shown),
    }  # fmt: skip
    notes.text = (
        f"direction right; {shown:.2f} {axis.unit} reported, {read:.2f} read: scale off by {100 * (share - 1):+.2f} %"
        f" (standard uncertainty {100 * axis.reading / abs(shown):.2f} %)"
    )


def _move(axis: JoggedAxis, seat: JogSeat, which: str, way: float, speed: float) -> Measured:
    """Wait for a key, a closed guard, and the axis; return the way that the drive reports."""
    text = f"{axis.name}: hands off, guard closed; it moves by {axis.shown(way):.4g} {axis.unit} at most, and stops"
    yield from press(f"jog {axis.name} {which}", text, seat.guarded)
    jog = seat.jogging.begin(axis.name, way, speed, holds=axis.holds)
    yield lambda now_s: jog.over
    return jog.moved


def _rest(axis: JoggedAxis, seat: JogSeat) -> Dialogue:
    """Switch off an axis that kept its power to be read."""
    jog = seat.jogging.rest() if axis.holds else None
    if jog is not None:
        yield lambda now_s: jog.over
        yield from wait(SPRING_S)


def _mark(axis: JoggedAxis) -> Dialogue:
    yield from choose(f"jog {axis.name} mark", f"{axis.name}: set {axis.instrument} to zero now; done?", "yes")


def _read(axis: JoggedAxis, which: str) -> Measured:
    """Ask how far the axis has moved; the intended direction is positive."""
    text = f"{axis.name}: how far has it moved, by {axis.instrument}?"
    return (yield from measure(f"jog {axis.name} {which} read", text, axis.unit))


def _direction(axis: JoggedAxis, seat: JogSeat, seen: str) -> None:
    name, node = axis.name, seat.rig.axes.driven()[axis.name].node_id
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


def _wrong_scale(axis: JoggedAxis, seat: JogSeat, share: float, why: str) -> str:
    """Return the error of a scale, with the correct lines of the rig file."""
    config = seat.believed.axes.driven()[axis.name]
    if not abs(share) > 1e-6:
        return f"the {axis.name} axis has not moved according to the reading: no scale can be computed"
    right = [f"axes.{axis.name}.velocity_increments: {config.velocity_increments / share:.7g}"]
    if config.position_increments:
        right.append(f"axes.{axis.name}.position_increments: {config.position_increments / share:.7g}")
    return (
        f"scale of the {axis.name} axis: it moved {share:.4g} times as far as its drive reports, {why}."
        f" In the rig file: {'; '.join(right)} (now {config.velocity_increments:.7g})"
    )
