"""The heat of friction in a contact of which one part stands while the other turns, and what keeps it below harm.

It is the power of friction at the full speed of the part that turns, times a time: until the program notices, and until
the press has lifted or the part stands too. Both drives' torque limits (0x6072) bound the power, whatever the rubber.
Where the program cannot hold a contact in time, a relay that takes the torque off wheel and belt (safe torque off) once
one of them stands and the other turns must: ``arming.standstill_relay``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import ceil
from typing import TYPE_CHECKING, Final, NamedTuple

from drivers.axis import AxisConfig
from sim.physics.wheel_law import known_law
from tester.kinds.wheel_on_belt.image.axes import held_by
from tester.kinds.wheel_on_belt.interlocks.contact_force import STIFFNESS_EXPONENT, depth_mm
from tester.kinds.wheel_on_belt.recipe.plan_steps import Install, PreGrind, WheelCondition

if TYPE_CHECKING:
    from tester.inputs.recipe.plan import Plan
    from tester.kinds.wheel_on_belt.rig import RigConfig

HARMFUL_J: Final = 40.0
"""Heat on one spot of the wheel from which it is harmed [A]."""
POWER_SCATTER: Final = 0.15
"""Greatest excess of friction over the model's, a share [A]: two standard deviations of wheel, condition and repeat."""
SOFTEST: Final = 0.75
"""Least stiffness of a contact as a share of ``loops.load.stiffness`` [A]: it takes the longest to lift."""
CELL_S: Final = 0.02
"""Friction is read so much later than a drive's torque, s [A] (``interlocks.belt_torque_delay``)."""
STEP_S: Final = 1e-3
"""Of the sum over a stop, s."""
RELAY_S: Final = 0.05
"""Longest time of the relay from standstill to torque off, s [A]: 800 W of friction are 40 J then."""
RELAY: Final = "arming.standstill_relay: true"
_CAUSES: Final = (
    "beside a scan that is just not late enough to trip", "where something holds the belt fast", "without brakes",
)  # fmt: skip
WARMING_K: Final = 5.0
"""Between the temperatures of a heating at which friction is looked at, K."""


class PlannedContact(NamedTuple):
    """A contact that a plan asks for: compound, load (N), greatest speed (m/s), and friction on a part at rest (N)."""

    compound: str
    load_n: float
    speed_m_s: float
    friction_n: float

    @property
    def power_w(self) -> float:
        """Return the power of friction with one part at rest, W."""
        return self.friction_n * self.speed_m_s


class Stopping(NamedTuple):
    """How long a contact rubs at its full power, s, for each cause."""

    late_s: float
    """A part jams beside a scan that is just not late enough to trip."""
    held_s: float
    """Something holds the belt fast while its drive turns on, found by torque and friction."""
    weak_s: float
    """The part that turns does not brake: the press alone ends it."""

    @property
    def worst_s(self) -> float:
        """Return the longest of them, s."""
        return max(self)


def stop_s(rig: RigConfig, load_n: float, speed_m_s: float, *, brakes: bool = True) -> float:
    """Return the integral over a fast stop of friction's power as a share of the power at its beginning, s.

    Force and speed fall together: the press lifts on its ramp behind its lag, and the turning part ``brakes``.
    """
    press, quick_m_s2 = rig.axes.press, rig.axes.belt.quick_stop_deceleration
    depth = depth_mm(load_n, SOFTEST * rig.loops.load.stiffness_n_per_mm)
    exponent, lag_s = 1.0 / (1.0 - STIFFNESS_EXPONENT), rig.interlocks.press_lag_s
    lifted_mm = press_mm_s = wanted_mm_s = total_s = 0.0
    now_s = 0.0
    while lifted_mm < depth:
        share = (1.0 - lifted_mm / depth) ** exponent
        if brakes:
            share *= max(1.0 - quick_m_s2 * now_s / speed_m_s, 0.0)
        total_s += share * STEP_S
        if share <= 0.0:
            break
        now_s += STEP_S
        wanted_mm_s = min(wanted_mm_s + press.acceleration * STEP_S, press.max_speed)
        press_mm_s += (wanted_mm_s - press_mm_s) * min(STEP_S / lag_s, 1.0)
        lifted_mm += press_mm_s * STEP_S
    return total_s


def stopping(rig: RigConfig, load_n: float, speed_m_s: float) -> Stopping:
    """Return how long a contact of this load (N) and speed (m/s) rubs at full power for each cause, s."""
    limits, scan_s = rig.interlocks, 1.0 / rig.scan.enabled_hz
    end_s = stop_s(rig, load_n, speed_m_s)
    reported = rig.axes.wheel.speed_zero > 0.0 and rig.axes.belt.speed_zero > 0.0  # else the next scan reads it
    seen_s = (0.0 if reported else scan_s) + limits.standing_delay_s
    delay_s = max(limits.belt_torque_delay_s, STEP_S)
    noticed_s = scan_s * (1 + ceil(delay_s / scan_s)) + CELL_S
    return Stopping(
        seen_s + limits.late_scan_s + end_s, noticed_s + end_s,
        scan_s + stop_s(rig, load_n, speed_m_s, brakes=False),
    )  # fmt: skip


def friction_n(rig: RigConfig, compound: str, load_n: float, speed_m_s: float, at_c: Iterable[float]) -> float:
    """Return the greatest friction at a slip of ``speed_m_s`` at these temperatures, N.

    It is bounded by the drives' torque limits. A compound without a law has what "friction beyond load" allows.
    """
    wheel, belt = rig.axes.wheel, rig.axes.belt
    wheel_n = _limit_nm(wheel) / (0.5e-3 * rig.interlocks.least_diameter_mm)
    belt_n = _limit_nm(belt) / (0.5e-3 * rig.geometry.belt_roller_diameter_mm)
    law = known_law(rig.sim.friction_model, compound)
    if law is not None:
        own_n = (1.0 + POWER_SCATTER) * load_n * max(law.mu(one, load_n, speed_m_s) for one in at_c)
    else:
        own_n = rig.interlocks.friction_share * load_n + rig.interlocks.friction_least_n
    return min(own_n, max(wheel_n, belt_n))


def _limit_nm(axis: AxisConfig) -> float:
    return 1e-3 * axis.max_torque_per_mille * axis.rated_torque_nm


def contact(rig: RigConfig, compound: str, load_n: float, speed_m_s: float, hottest_c: float) -> PlannedContact:
    """Return a contact between the rig's ambient temperature and another, degC."""
    low, high = min(rig.ambient_c, hottest_c), max(rig.ambient_c, hottest_c)
    count = ceil((high - low) / WARMING_K)
    at_c = [low + (high - low) * place / count for place in range(count + 1)] if count else [low]
    return PlannedContact(compound, load_n, speed_m_s, friction_n(rig, compound, load_n, speed_m_s, at_c))


def unheld(rig: RigConfig, one: PlannedContact) -> str:
    """Return why the program alone does not keep a contact below harm, "" if it does."""
    times = stopping(rig, one.load_n, one.speed_m_s)
    heat_j = one.power_w * times.worst_s
    if not heat_j > HARMFUL_J:
        return ""
    return f"{_heat(one, times)}; harm begins at {HARMFUL_J:g} J"


def remedy(rig: RigConfig, one: PlannedContact) -> str:
    """Return what lets the program hold a contact that it does not hold."""
    times, most_s = stopping(rig, one.load_n, one.speed_m_s), HARMFUL_J / one.power_w
    late_s = rig.interlocks.late_scan_s - (times.late_s - most_s)
    if max(times.held_s, times.weak_s) <= most_s and late_s > 0.0:
        return f"interlocks.late_scan of at most {1e3 * late_s:.0f} ms, a smaller load, or {RELAY}"
    return f"a smaller load, less torque of the drives (max_torque_per_mille), or {RELAY}"


def _heat(one: PlannedContact, times: Stopping) -> str:
    cause = _CAUSES[times.index(times.worst_s)]
    who = one.compound or "rubber without a friction model"
    return (
        f"{who} at {one.load_n:.0f} N and {one.speed_m_s:g} m/s takes up to {one.power_w:.0f} W once wheel or belt"
        f" stands, {one.power_w * times.worst_s:.0f} J {cause}"
    )


def counted_on(rig: RigConfig, plan: Plan) -> list[str]:
    """Return the line of a run's record: the plan's contact with the most heat on a part at rest, and what holds it."""
    asked: dict[tuple[str, float, float], float] = {}
    for compound, load_n, speed_m_s, hottest_c in _asked(rig, plan):
        key = compound, load_n, speed_m_s
        asked[key] = max(hottest_c, asked.get(key, hottest_c))
    worst = _worst(rig, [contact(rig, *key, hottest_c) for key, hottest_c in asked.items()])
    if worst is None:
        return []
    why = unheld(rig, worst)
    if not why:
        times = stopping(rig, worst.load_n, worst.speed_m_s)
        return [f"stopped contact: {_heat(worst, times)} at most: the program holds it"]
    return [f"stopped contact: {why}: the relay that takes the torque off is COUNTED ON ({RELAY})"]


def _worst(rig: RigConfig, contacts: Sequence[PlannedContact]) -> PlannedContact | None:
    """Return the contact with the most heat, None without contacts."""
    if not contacts:
        return None
    # More load or speed takes longer to stop: no contact takes longer than this, and most need no sum of their own.
    longest_s = stopping(rig, max(one.load_n for one in contacts), max(one.speed_m_s for one in contacts)).worst_s
    worst, most_j = None, -1.0
    for one in sorted(contacts, key=lambda one: -one.power_w):
        if one.power_w * longest_s <= most_j:
            break
        heat_j = one.power_w * stopping(rig, one.load_n, one.speed_m_s).worst_s
        if heat_j > most_j:
            worst, most_j = one, heat_j
    return worst


def _asked(rig: RigConfig, plan: Plan) -> Iterator[tuple[str, float, float, float]]:
    """Yield compound, load (N), greatest speed (m/s) and greatest temperature (degC) of each contact of a plan.

    What heats up rolls at the load of its condition or less, from ambient on.
    """
    compound, ambient_c = "", rig.ambient_c
    for step in plan.steps:
        if isinstance(step, Install):
            compound = step.compound
        elif isinstance(step, PreGrind):
            yield compound, step.load_n, max(step.wheel_speed_m_s, step.belt_speed_m_s), ambient_c
        elif isinstance(step, WheelCondition):
            held = held_by(step.setpoint)
            belt_m_s = max(held.belt_speed_m_s, held.reversed().belt_speed_m_s if step.both_directions else 0.0)
            hottest_c = held.temperature_c + step.temperature_band_k
            yield held.compound, held.load_n, max(held.wheel_speed_m_s, belt_m_s), hottest_c
