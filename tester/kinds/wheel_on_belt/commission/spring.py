"""The press's lifting spring: the torque of the press's drive in free travel, both ways, and a spring balance.

With the wheel off the belt half the sum of both ways' torques is what the spring takes: the screw's friction cancels.
"press spring" (tester.kinds.wheel_on_belt.interlocks.witness) compares the same before every contact. An error of the
torque's gain looks like another spring, so a person weighs the spring: a balance has no supply in common with a drive.
"""

from __future__ import annotations

from math import hypot, inf, sqrt
from statistics import fmean
from typing import Final, NamedTuple

from drivers.screw import Screw
from tester.kinds.wheel_on_belt.control.interlock_inputs import UNKNOWN_MM
from tester.kinds.wheel_on_belt.interlocks.monitors import MOVES_MM, UNDER_WAY_MM
from tester.machine.commission.commission_step import Dialogue, Notes, StepRefused, press, wait
from tester.machine.commission.quiet_seat import JogSeat
from tester.machine.commission.stages import in_stages, measured_twice

SPEED_MM_S: Final = 2.0
"""Speed of the press [A]: that of its jog."""
SPRING_S: Final = 1.5
"""Time for the spring to take the press back, s [A]: 8 mm at 20 mm/s take 0.4 s."""
WITHIN_SHARE: Final = 0.02
"""Tolerance besides half a digit of the torque, a share [A]: less than half of ``interlocks.press_spring_share``, and
1 N of a balance."""
WEIGHED_AGAIN: Final = 1.2
"""Greatest factor between balance and torque that a gain of the torque explains [A]."""
PARTS: Final = 3
"""Parts of the travel that are compared: a spring whose force grows differs at the ends."""
LEAST_TRAVEL_SHARE: Final = 0.9
FRICTION_SHARE: Final = 0.2
"""The growths measured on the two ways may differ by this share: a screw of 83 % efficiency [A]."""
ROUNDED: Final = 4.0
"""... and standard uncertainties of the growth: digits of a torque that hardly changes [A]."""


class SpringForce(NamedTuple):
    """A spring as its torque shows it: its force at 0 mm, N, growth, N/mm, and standard uncertainties."""

    at_rest_n: float
    rate_n_per_mm: float
    standard_n: float
    standard_rate: float
    parts: tuple[tuple[float, float], ...]
    """Place, mm, and force, N, of each part of the travel."""
    friction_nm: float
    """Half the difference of both ways' torques."""
    apart_n_per_mm: float
    """Half the difference of both ways' growths: the screw's friction explains a share of the growth."""

    @property
    def words(self) -> str:
        """Return force and growth in words."""
        rate = f" and {self.rate_n_per_mm:.2f} N per mm of travel" if self.rate_n_per_mm else ""
        return f"{self.at_rest_n:.1f} N{rate} (standard uncertainty {self.standard_n:.1f} N)"


Way = list[tuple[float, float]]
"""Positions, mm, and torques, N m, of one way."""


def spring_of(down: Way, up: Way, nm_per_n: float, digit_nm: float) -> SpringForce:
    """Return the spring of both ways; ``nm_per_n``: of the screw without friction, ``digit_nm``: the torque's last.

    Force and growth come from least squares; a growth within its uncertainty is none.
    """
    ways = down, up
    low_mm, high_mm = max(min(way)[0] for way in ways), min(max(way)[0] for way in ways)
    middle_mm, third_mm = 0.5 * (low_mm + high_mm), (high_mm - low_mm) / PARTS
    (down_nm, down_rate, down_off), (up_nm, up_rate, up_off) = (_line(way, middle_mm) for way in ways)
    force_n, rate = 0.5 * (down_nm + up_nm) / nm_per_n, 0.5 * (down_rate + up_rate) / nm_per_n
    standard_n = hypot(digit_nm / sqrt(12.0), down_off, up_off) / (sqrt(2.0) * nm_per_n)
    standard_rate = 2.0 * standard_n / (high_mm - low_mm)
    parts: list[tuple[float, float]] = []
    for number in range(PARTS):
        first_mm = low_mm + number * third_mm
        within = [[pair for pair in way if first_mm <= pair[0] <= first_mm + third_mm] for way in ways]
        mm, torque_nm = (0.5 * sum(fmean(pair[i] for pair in way) for way in within) for i in range(2))
        parts.append((mm, torque_nm / nm_per_n))
    rate = rate if abs(rate) > standard_rate else 0.0
    return SpringForce(
        force_n - rate * middle_mm, rate, standard_n, standard_rate, tuple(parts), 0.5 * (down_nm - up_nm),
        0.5 * (down_rate - up_rate) / nm_per_n,
    )  # fmt: skip


def _line(way: Way, at_mm: float) -> tuple[float, float, float]:
    """Return a way's torque at a place, N m, its growth, N m per mm, and the standard uncertainty of its mean, N m."""
    mean_mm, mean_nm = fmean(mm for mm, _ in way), fmean(nm for _, nm in way)
    square = sum((mm - mean_mm) ** 2 for mm, _ in way)
    rate = sum((mm - mean_mm) * (nm - mean_nm) for mm, nm in way) / square
    left = sum((nm - mean_nm - rate * (mm - mean_mm)) ** 2 for mm, nm in way)
    return mean_nm + rate * (at_mm - mean_mm), rate, sqrt(left) / len(way)


def measure_spring(seat: JogSeat, notes: Notes) -> Dialogue:
    """Measure the lifting spring by torque and balance; raises StepRefused."""
    screw = seat.believed.axes.press.screw
    if screw is None:
        notes.text = "the rig file has no axes.press.screw: the press's torque is compared with nothing"
        return
    trial = _SpringTrial(seat, notes, screw)
    yield from in_stages(notes, trial.travel, trial.weigh)


class _SpringTrial:
    """The stages of the measurement."""

    def __init__(self, seat: JogSeat, notes: Notes, screw: Screw) -> None:
        """Move nothing yet."""
        self.seat, self.notes, self.screw = seat, notes, screw
        self.digit_n = 1e-3 * seat.believed.axes.press.rated_torque_nm / screw.nm_per_n
        self.spring: SpringForce | None = None

    def travel(self) -> Dialogue:
        """Move the press down and up over its free travel, and compute the spring from its torque."""
        seat, drive = self.seat, self.seat.jogging.drive("press")
        to_mm = seat.believed.geometry.touch_mm - UNKNOWN_MM
        text = f"press: wheel off the belt, hands off, guard closed; it goes to {to_mm:.1f} mm slowly, and back"
        yield from press("spring travel", text, seat.guarded)
        ways: list[Way] = []
        began_mm = drive.actual
        for target_mm in (to_mm, began_mm):
            way: Way = []
            yield from _travel(seat, target_mm - drive.actual, way, holds=target_mm == to_mm)
            ways.append(way)
            come_mm = abs(way[-1][0] - way[0][0]) if way else 0.0
            if not come_mm >= LEAST_TRAVEL_SHARE * abs(to_mm - began_mm) - UNDER_WAY_MM:
                raise StepRefused(
                    f"press: it came {come_mm:.1f} mm of {abs(to_mm - began_mm):.1f} mm with the torque for 60 N beyond"
                    " axes.press.screw.spring: a stronger spring, or something is in its way"
                )
        yield from wait(SPRING_S)
        digit_nm = self.digit_n * self.screw.nm_per_n
        self.spring = spring_of(ways[0], ways[1], self.screw.nm_per_n, digit_nm)
        self.notes.read("press's torque in free travel", {
            "spring_n": self.spring.at_rest_n, "rate_n_per_mm": self.spring.rate_n_per_mm,
            "friction_nm": self.spring.friction_nm, "parts": [list(part) for part in self.spring.parts],
        })  # fmt: skip
        if not self._none():
            _sound(self.spring)

    def weigh(self) -> Dialogue:
        """Ask what a balance shows, and compare torque, balance and rig file."""
        spring, screw = self.spring, self.screw
        assert spring is not None
        if self._none():
            self.notes.text = "no spring lifts the press, as the rig file has it"
            return
        text = (
            "press, no power: hook a spring balance to it, pull it 1 mm towards the contact and let it up, slowly;"
            " what is the mean of both readings?"
        )

        def refused(typed: float) -> str:
            return "" if self._near(typed, spring.at_rest_n) else f"by its torque it takes {spring.at_rest_n:.1f} N"

        weighed_n = yield from measured_twice("spring weighed", text, "N", refused)
        off_n = max((abs(force_n - screw.lifts_n(mm)) for mm, force_n in spring.parts), default=inf)
        by_file = off_n <= self._within_n(screw.spring_n)
        self.notes.values = {
            "spring_n": spring.at_rest_n, "standard_uncertainty_n": spring.standard_n,
            "rate_n_per_mm": spring.rate_n_per_mm, "standard_uncertainty_n_per_mm": spring.standard_rate,
            "weighed_n": weighed_n, "friction_nm": spring.friction_nm,
        }  # fmt: skip
        if not self._near(weighed_n, spring.at_rest_n):
            raise StepRefused(self._contradicted(spring, weighed_n))
        if not by_file:
            raise StepRefused(
                f"lifting spring of the press: by torque and balance it is {spring.words}. In the rig file:"
                f" axes.press.screw.spring: {spring.at_rest_n:.1f} N; axes.press.screw.spring_rate:"
                f" {spring.rate_n_per_mm:.2f} N/mm (now {screw.spring_n:g} N, {screw.spring_rate_n_per_mm:g} N/mm)"
            )
        self.notes.text = f"lifting spring {spring.words}; balance {weighed_n:g} N"

    def _none(self) -> bool:
        """Return whether neither the rig file nor the torque has a spring: a press that holds its place."""
        most_n = max(abs(force_n) for _, force_n in self.spring.parts) if self.spring is not None else inf
        return self.screw.spring_n == 0.0 and most_n <= self._within_n(0.0)

    def _within_n(self, force_n: float) -> float:
        return 0.5 * self.digit_n + WITHIN_SHARE * force_n

    def _near(self, weighed_n: float, force_n: float) -> bool:
        return abs(weighed_n - force_n) <= self._within_n(force_n)

    def _contradicted(self, spring: SpringForce, weighed_n: float) -> str:
        """Return what a balance that contradicts the torque means."""
        found = f"the press's torque means a spring of {spring.words}, a balance shows {weighed_n:g} N"
        share = spring.at_rest_n / weighed_n if weighed_n > 0.0 else inf
        if not 1.0 / WEIGHED_AGAIN <= share <= WEIGHED_AGAIN and not self._near(weighed_n, self.screw.spring_n):
            return f"{found}: look at the balance's unit, zero and hook; the rig file stays as it is"
        return (
            f"gain of the press's torque: {found}: the drive measures {share:.2f} times its torque. Look at its rated"
            " torque (0x6076, axes.press.rated_torque), its current sensor and its supply; axes.press.screw.spring"
            " stays as it is"
        )


def _sound(spring: SpringForce) -> None:
    """Raise StepRefused for a torque that no spring takes."""
    if not spring.at_rest_n > 2.0 * spring.standard_n:
        raise StepRefused(
            f"press's torque in free travel: half the sum of both ways means a spring of {spring.at_rest_n:.1f} N that"
            " lifts it: does the drive report its torque (0x6077), and with the right sign? Is the spring there?"
        )
    if not abs(spring.apart_n_per_mm) <= FRICTION_SHARE * spring.rate_n_per_mm + ROUNDED * spring.standard_rate:
        raise StepRefused(
            f"press's torque in free travel: down it grows by {2.0 * spring.apart_n_per_mm:.2f} N per mm more than up:"
            " it drifts, or something bears on the press; measure again"
        )
    if spring.rate_n_per_mm < 0.0:
        raise StepRefused(
            f"press's torque in free travel: the spring's force falls by {-spring.rate_n_per_mm:.2f} N per mm of"
            " travel: does something press on the press, or does the spring come loose?"
        )
    if not spring.friction_nm > 0.0:
        raise StepRefused(
            f"press's torque in free travel: {spring.friction_nm:.4f} N m of friction; going down has to take more"
            " torque than going up: 0x6077 has another sign, or does not follow the torque"
        )


def _travel(seat: JogSeat, way_mm: float, way: Way, *, holds: bool) -> Dialogue:
    """Move the press by ``way_mm``; collect position and torque once it is under way."""
    jogging, drive = seat.jogging, seat.jogging.drive("press")
    began_mm = last_mm = drive.actual
    jog = jogging.begin("press", way_mm, SPEED_MM_S, holds=holds, most_s=2.0 * abs(way_mm) / SPEED_MM_S)

    def over(now_s: float) -> bool:
        nonlocal last_mm
        at_mm = drive.actual
        if not jog.over and abs(at_mm - last_mm) >= MOVES_MM and abs(at_mm - began_mm) >= UNDER_WAY_MM:
            way.append((at_mm, drive.torque_nm))
        last_mm = at_mm
        return jog.over

    yield over
