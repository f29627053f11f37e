"""Consistency checks between the sections of a rig of this kind; each section alone is checked by its types."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from drivers.profiles import ProfileError
from tester.base.source import Location
from tester.inputs.rig.cells import skew_problem
from tester.inputs.rig.config import HEAT_OFF
from tester.inputs.rig.profiles import profile_of
from tester.kinds.wheel_on_belt.image.axes import POSITIONED
from tester.kinds.wheel_on_belt.rig.press import torque_problem

if TYPE_CHECKING:
    from tester.kinds.wheel_on_belt.rig.config import RigConfig

EQUAL_DECELERATIONS = 0.05
"""Wheel and belt must decelerate alike, in m/s2, within this share [A]: otherwise one stops before the other."""

_Found = Iterator[tuple[Location, str]]


def problems_between(rig: RigConfig) -> _Found:
    """Yield inconsistencies, with their places in the file."""
    for check in (_speeds, _decelerations, _units, _press, _temperatures, _skew, _heat_off):
        yield from check(rig)


def _speeds(rig: RigConfig) -> _Found:
    """A drive that clamps below the rig's limit would run slower than it is asked, silently."""
    wheel = rig.axes.wheel.max_speed * 0.5e-3 * rig.geometry.wheel_diameter_mm
    if wheel < rig.limits.wheel_speed_m_s:
        yield ("axes", "wheel", "max_speed"), f"gives {wheel:.3f} m/s, less than limits.wheel_speed"
    if rig.axes.belt.max_speed < rig.limits.belt_speed_m_s:
        yield ("axes", "belt", "max_speed"), f"{rig.axes.belt.max_speed:g} m/s is less than limits.belt_speed"
    if rig.loops.load.lift_speed_mm_s > rig.axes.press.max_speed:
        yield ("loops", "load", "lift_speed"), "is above axes.press.max_speed"
    if rig.loops.load.acceleration_mm_s2 > min(rig.axes.press.acceleration, rig.axes.press.deceleration):
        yield ("loops", "load", "acceleration"), "is above what axes.press can follow"


def _decelerations(rig: RigConfig) -> _Found:
    radius_m = 0.5e-3 * rig.geometry.wheel_diameter_mm
    for key in ("deceleration", "quick_stop_deceleration"):
        wheel = float(getattr(rig.axes.wheel, key)) * radius_m
        belt = float(getattr(rig.axes.belt, key))
        if abs(wheel - belt) > EQUAL_DECELERATIONS * belt:
            message = f"wheel {wheel:.3g} m/s2 at the rim, belt {belt:.3g} m/s2: they must be equal within 5 %"
            yield ("axes", "wheel", key), message


def _units(rig: RigConfig) -> _Found:
    due = {"wheel": "rad/s", "belt": "m/s", "press": "mm/s"} | {axis.name: axis.recipe_unit for axis in POSITIONED}
    for name, axis in rig.axes.driven().items():
        if axis.unit != due[name]:
            yield ("axes", name, "unit"), f"the {name} axis is in {due[name]}, not {axis.unit}"
    if not rig.axes.press.digital_io:
        yield ("axes", "press", "digital_io"), "the press drive carries the safety chain's inputs (expected true)"
    if rig.interlocks.stale_inputs_s < 2.0 * rig.axes.press.inputs_period_s:
        message = "is less than two of axes.press.inputs_period: a single lost frame would stop the rig"
        yield ("interlocks", "stale_inputs"), message


def _press(rig: RigConfig) -> _Found:
    problem = torque_problem(rig)
    if problem:
        yield ("axes", "press", "screw"), problem


def _skew(rig: RigConfig) -> _Found:
    needed = rig.own["load_cell"].channels
    yield from skew_problem(rig, needed, rig.interlocks.cell_skew_s)


def _heat_off(rig: RigConfig) -> _Found:
    """The heat ends without this program: by a lease, or by what the file says that the machine has instead."""
    for name, device in rig.devices.items():
        if device.heat_off and (name != "jacket" or device.heat_off not in HEAT_OFF):
            expected = "it is the jacket's" if name != "jacket" else f"expected {' or '.join(HEAT_OFF)}"
            yield ("devices", name, "heat_off"), f"{device.heat_off} ({expected})"
    jacket = rig.devices.get("jacket")
    try:
        profile = profile_of(jacket.profile) if jacket is not None else None
    except ProfileError:
        return  # another check reports it
    if jacket is None or profile is None or rig.simulated or "lease" in profile.writes:
        return
    if jacket.heat_off == "fallback" and profile.falls_back_s is None:
        message = f"{profile.title} has no setpoint of its own that it falls back to (falls_back_s): expected relay"
        yield ("devices", "jacket", "heat_off"), message
    elif not jacket.heat_off:
        ways = "; ".join(f"{key}: {words}" for key, words in HEAT_OFF.items())
        message = f"{profile.title} has no lease: it heats on when the PC is silent. Say by heat_off what ends that"
        yield ("devices", "jacket"), f"{message} ({ways})"


def _temperatures(rig: RigConfig) -> _Found:
    heat = rig.loops.heat
    if heat.hub_max_c > rig.limits.jacket_c:
        yield ("loops", "heat", "hub_max"), f"{heat.hub_max_c:g} degC is above limits.jacket"
    if heat.hub_min_c >= heat.hub_max_c:
        yield ("loops", "heat", "hub_min"), "is not below hub_max"
