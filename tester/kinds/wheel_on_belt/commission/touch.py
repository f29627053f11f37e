"""The armed rig's cold steps: homing, first contact and tare, and the ratio of the speeds at which the wheel rolls."""

from __future__ import annotations

from collections.abc import Generator
from functools import partial
from typing import Any, Final

from sim.physics.friction import KNOWN
from tester.kinds.wheel_on_belt.commission.armed import WheelSeat, mean_temperatures
from tester.kinds.wheel_on_belt.procedures.first_contact import FirstContact, Friction
from tester.kinds.wheel_on_belt.procedures.motions import Lift, Load, TakeTare, Turn
from tester.machine.commission.commission_step import Dialogue, Notes, StepRefused, Waits
from tester.machine.commission.compound import ask_compound
from tester.machine.commission.stages import in_stages, measured_twice
from tester.machine.motions import Power, Sequence, Settle

ANGLE_DEG: Final = 0.5
"""Greatest deviation of a homed axis from straight [A]: the misalignment in the budget."""
SHARE_MOST: Final = 1.2
"""Greatest factor by which a wheel's diameter may differ from the rig file's; beyond it none is advised [A]."""
DIAMETER_MM: Final = 0.5
"""Greatest deviation of a new wheel's diameter from the rig file's [A]: three times a caliper's resolution on rubber.
"""
TARE_S: Final = 2.0
ROLLING_N: Final = 50.0
"""Load of the rolling wheel [A]: the indentation shortens its radius by only some hundredths of a mm."""
SPEEDS_M_S: Final = (0.2, 0.5, 0.8)
HALVINGS: Final = 6
"""Number of halvings of the range in which friction reverses: from +-(3 % and 10 mm/s) to 0.05 %."""
SURFACE_S: Final = 3.0
"""Time for reading the lifted tread: thirty readings of 0.1 K leave 0.02 K [A]."""
SWEEP_SHARE: Final = 0.03
CREEP_M_S: Final = 0.010
RATIO_SHARE: Final = 0.005
"""Tolerance of the speeds' ratio [A]: scales are known to 0.1 %, a diameter to 0.15 mm of 90, the rolling radius to
0.05 mm.
"""


def home(seat: WheelSeat, notes: Notes) -> Dialogue:
    """Check positioned axes after homing: a person measures whether their zero is straight."""
    angles: dict[str, Any] = {}

    def angle(name: str) -> Dialogue:
        at = seat.ctx.readings.positions[name]
        text = f"{name}: it was homed and is at {at:.2f} deg; what does an inclinometer show?"
        read = yield from measured_twice(
            f"angle {name}", text, "deg", lambda typed: "" if abs(typed - at) <= ANGLE_DEG else "that is not straight"
        )
        off = read - at
        angles[name] = {"shown_deg": at, "read_deg": read}
        if not abs(off) <= ANGLE_DEG:
            config = seat.rig.axes.driven()[name]
            raise StepRefused(
                f"home of the {name} axis: straight is {off:+.2f} deg off. In the rig file:"
                f" axes.{name}.home_offset: {config.home_offset - off:.2f} (now {config.home_offset:g})"
            )
        notes.values = angles
        notes.text = "homed; " + ", ".join(f"{one} {found['read_deg']:+.2f} deg" for one, found in angles.items())

    yield from in_stages(notes, *(partial(angle, name) for name in seat.run.engine.devices.axes.positioned))


def touch(seat: WheelSeat, notes: Notes) -> Dialogue:
    """Measure the wheel, touch it at a small load, check that friction reverses, and tare the cell."""
    believed, values = seat.rig.geometry.wheel_diameter_mm, dict[str, Any]()

    def diameter() -> Dialogue:
        text = f"what does a caliper show of the new wheel (believed {believed:g})?"
        read = yield from measured_twice(
            "diameter", text, "mm", lambda typed: "" if abs(typed - believed) <= DIAMETER_MM else "not the rig file's"
        )
        values["diameter_mm"] = read
        share = read / believed
        if not 1.0 / SHARE_MOST <= share <= SHARE_MOST:
            raise StepRefused(f"wheel diameter: {read:g} mm cannot be, the rig file has {believed:g} mm: its unit?")
        if not abs(read - believed) <= DIAMETER_MM:
            raise StepRefused(
                f"wheel diameter: {read:g} mm measured, the rig file has {believed:g} mm."
                f" In the rig file: geometry.wheel_diameter: {read:g} mm"
            )

    def compound() -> Dialogue:
        values["compound"] = yield from ask_compound(notes, KNOWN, "wheel")

    yield from in_stages(notes, diameter, compound, lambda: _touched(seat, notes, values))


def _touched(seat: WheelSeat, notes: Notes, values: dict[str, Any]) -> Dialogue:
    """Touch the wheel and take the cell's zero; raises StepRefused."""
    yield from seat.do(FirstContact())
    reference: list[float] = []
    tare = _tare(reference)
    yield from seat.do(Sequence(Power(True), Lift(), tare))
    if tare.failed:
        raise StepRefused(f"tare: {tare.failed}")
    press_mm = seat.ctx.contact.contact_mm
    yield from seat.do(Sequence(Turn(0.0, 0.0), Power(False)))
    notes.values = {**values, "touched_mm": press_mm, "zero": reference}
    zero = ", ".join(f"{force:.2f}" for force in reference[:3])
    notes.text = (
        f"wheel of {values['compound']}, {values['diameter_mm']:g} mm, touched at {press_mm:.2f} mm; zero {zero} N"
    )


def _tare(reference: list[float]) -> TakeTare:
    return TakeTare(TARE_S, reference, ends_run=False)


def roll(seat: WheelSeat, notes: Notes) -> Dialogue:
    """Find the slip at which friction reverses, at three speeds: the part proportional to speed gives the scales'
    ratio.
    """
    first = SPEEDS_M_S[0]
    yield from seat.do(
        Sequence(Power(True), Lift(), Turn(first, first), Settle(0.5), _tare([]), Load(ROLLING_N, percent=5.0))
    )
    reversals: list[tuple[float, float]] = []
    for speed in SPEEDS_M_S:
        yield from seat.do(Turn(speed, speed))
        slip = yield from _turns_round(seat, speed)
        reversals.append((speed, slip))
        notes.read("friction turns round", {"wheel_m_s": speed, "slip_m_s": slip})
    yield from seat.do(Sequence(Turn(first, first), Lift()))
    surface_c, _ = yield from mean_temperatures(seat, SURFACE_S)
    yield from seat.do(Sequence(Turn(0.0, 0.0), Power(False)))
    count = len(reversals)
    mean_v, mean_s = sum(v for v, _ in reversals) / count, sum(s for _, s in reversals) / count
    square = sum((v - mean_v) ** 2 for v, _ in reversals)
    ratio = sum((v - mean_v) * (s - mean_s) for v, s in reversals) / square
    creep = mean_s - ratio * mean_v
    left = sum((s - creep - ratio * v) ** 2 for v, s in reversals)
    resolved = 2.0 * (SWEEP_SHARE * SPEEDS_M_S[-1] + CREEP_M_S) / 2.0**HALVINGS
    standard = ((left / (count - 2) + resolved * resolved / 12.0) / square) ** 0.5
    if not abs(ratio) <= RATIO_SHARE + 2.0 * standard:
        geometry = seat.rig.geometry
        raise StepRefused(
            f"speed ratio: rolling freely the belt is {100 * ratio:+.2f} % (+-{100 * standard:.2f} %) off the rim:"
            f" either geometry.wheel_diameter is {geometry.wheel_diameter_mm * (1.0 - ratio):.2f} mm, or in the rig"
            f" file axes.belt.velocity_increments: {seat.rig.axes.belt.velocity_increments * (1.0 - ratio):.7g}"
        )
    notes.values = {
        "ratio_error": ratio, "standard_uncertainty": standard, "creep_m_s": creep,
        "turns_round": [*map(list, reversals)], "surface_c": surface_c,
    }  # fmt: skip
    notes.text = (
        f"speed ratio off by {100 * ratio:+.2f} % (standard uncertainty {100 * standard:.2f} %),"
        f" creep {1e3 * creep:.1f} mm/s"
    )


def _turns_round(seat: WheelSeat, speed: float) -> Generator[Waits, str, float]:
    """Return the slip (wheel less belt, m/s, as shown) at which friction reverses."""
    reach = SWEEP_SHARE * speed + CREEP_M_S
    low, high = -reach, reach
    ends: list[float] = []
    for slip in (low, high):
        friction = yield from _friction(seat, speed, slip)
        ends.append(friction)
    if not (ends[0] < 0.0 < ends[1]):
        raise StepRefused(
            f"friction does not turn round between {low:.3f} and {high:.3f} m/s of slip at {speed:g} m/s"
            f" ({ends[0]:.1f}, {ends[1]:.1f} N): direction, scale or diameter of wheel or belt"
        )
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        friction = yield from _friction(seat, speed, middle)
        low, high = (low, middle) if friction > 0.0 else (middle, high)
    return 0.5 * (low + high)


def _friction(seat: WheelSeat, speed: float, slip: float) -> Generator[Waits, str, float]:
    activity = Friction(speed, speed - slip)
    yield from seat.do(activity)
    return activity.friction_n / activity.count


