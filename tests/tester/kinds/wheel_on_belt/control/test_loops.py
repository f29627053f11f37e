"""The press loop against an ideal contact: a spring behind a velocity-controlled screw."""

from __future__ import annotations

import math

import pytest

from tester.kinds.wheel_on_belt.control.loops import HeatLoop, LoadLoop
from tester.kinds.wheel_on_belt.image.process_image import Demand, Press, Readings
from tester.kinds.wheel_on_belt.interlocks.contact_force import STIFFNESS_EXPONENT, depth_mm
from tester.kinds.wheel_on_belt.rig import RigConfig

GAP_MM = 10.0


class Contact:
    """A screw that follows its velocity with the press's acceleration, and a spring of 145 N/mm behind a gap."""

    def __init__(self) -> None:
        self.position_mm = 0.0
        self.velocity_mm_s = 0.0

    def move(self, command: float, dt: float, acceleration: float) -> None:
        change = min(max(command - self.velocity_mm_s, -acceleration * dt), acceleration * dt)
        self.velocity_mm_s += change
        self.position_mm = max(0.0, self.position_mm + self.velocity_mm_s * dt)

    @property
    def force_n(self) -> float:
        return 145.0 * max(0.0, self.position_mm - GAP_MM)


def load(
    rig: RigConfig, loop: LoadLoop, contact: Contact, target_n: float, seconds: float, *, quick: bool = False
) -> list[float]:
    """Close the loop for a time at 100 Hz; return the forces."""
    demand = Demand(press=Press.LOAD, load_n=target_n, quick_touch=quick)
    forces: list[float] = []
    for _ in range(round(seconds / 0.01)):
        readings = Readings(force_z_n=contact.force_n, press_mm=contact.position_mm)
        command = loop.velocity(demand, readings, 0.01, rig.loops.load)
        contact.move(command, 0.01, rig.axes.press.acceleration)
        forces.append(contact.force_n)
    return forces


@pytest.mark.parametrize("target", [50.0, 100.0, 200.0, 400.0])
def test_a_first_touch_reaches_every_load_without_overshoot_beyond_the_interlock(rig: RigConfig, target: float) -> None:
    forces = load(rig, LoadLoop(), Contact(), target, 15.0)
    assert forces[-1] == pytest.approx(target, rel=0.01)
    assert max(forces) < 1.1 * target + 10.0


def test_a_known_contact_is_touched_quickly(rig: RigConfig) -> None:
    loop, contact = LoadLoop(), Contact()
    load(rig, loop, contact, 200.0, 15.0)
    lift(rig, loop, contact)
    forces = load(rig, loop, contact, 200.0, 4.0, quick=True)
    reached = next(i for i, force in enumerate(forces) if abs(force - 200.0) < 4.0) * 0.01
    assert reached < 1.5
    assert max(forces) < 230.0


def lift(rig: RigConfig, loop: LoadLoop, contact: Contact) -> None:
    for _ in range(300):
        readings = Readings(force_z_n=contact.force_n, press_mm=contact.position_mm)
        command = loop.velocity(Demand(), readings, 0.01, rig.loops.load)
        contact.move(command, 0.01, rig.axes.press.acceleration)


def test_lifting_stops_at_the_clearance_off_the_last_contact(rig: RigConfig) -> None:
    loop, contact = LoadLoop(), Contact()
    load(rig, loop, contact, 200.0, 15.0)
    lift(rig, loop, contact)
    assert contact.force_n == 0.0
    assert contact.position_mm == pytest.approx(loop.contact_mm - rig.loops.load.clearance_mm, abs=0.1)


@pytest.mark.parametrize("field", ["force_z_n", "press_mm"])
def test_unknown_force_or_position_never_presses(rig: RigConfig, field: str) -> None:
    loop = LoadLoop(in_contact=True, contact_mm=10.0)
    readings = Readings(force_z_n=100.0, press_mm=11.0)
    setattr(readings, field, math.nan)
    assert loop.velocity(Demand(press=Press.LOAD, load_n=200.0), readings, 0.01, rig.loops.load) < 0.0


def test_a_load_that_comes_again_before_the_contact_was_open_does_not_move_the_known_contact(rig: RigConfig) -> None:
    loop, contact = LoadLoop(), Contact()
    load(rig, loop, contact, 400.0, 15.0)
    before_mm = loop.contact_mm
    readings = Readings(force_z_n=contact.force_n, press_mm=contact.position_mm)
    loop.velocity(Demand(), readings, 0.01, rig.loops.load)
    load(rig, loop, contact, 400.0, 1.0)
    assert contact.force_n > 300.0
    assert loop.contact_mm == before_mm


def test_a_contact_first_touched_while_the_cell_was_never_seen_open_stays_unknown(rig: RigConfig) -> None:
    loop = LoadLoop()
    readings = Readings(force_z_n=90.0, press_mm=12.0)
    loop.velocity(Demand(press=Press.LOAD, load_n=200.0), readings, 0.01, rig.loops.load)
    assert loop.in_contact and math.isnan(loop.contact_mm)
    assert loop.lifted_mm(rig.loops.load) == 0.0


def test_a_press_at_its_clearance_goes_back_further_while_the_cell_shows_a_load(rig: RigConfig) -> None:
    loop = LoadLoop(contact_mm=10.0)
    at_clearance = Readings(force_z_n=95.0, press_mm=8.0)
    assert loop.velocity(Demand(), at_clearance, 0.01, rig.loops.load) < 0.0


@pytest.mark.parametrize("force", [100.0, 200.0, 400.0])
def test_the_depth_grows_with_the_load_by_the_tangent_stiffness(force: float) -> None:
    slope = 2.0 / (depth_mm(force + 1.0, 145.0) - depth_mm(force - 1.0, 145.0))
    assert slope == pytest.approx(145.0 * (force / 200.0) ** STIFFNESS_EXPONENT, rel=1e-4)


@pytest.mark.parametrize("force", [0.0, -3.0, math.nan])
def test_no_force_or_an_unknown_one_needs_no_depth(force: float) -> None:
    assert depth_mm(force, 145.0) == 0.0


def test_at_the_target_the_hub_setpoint_is_the_feed_forward(rig: RigConfig) -> None:
    loop = HeatLoop()
    assert loop.update(0.0, 40.0, 40.0, 23.0, 0.8, rig.loops.heat) == pytest.approx(40.0 + 17.0 * 0.8)


def test_the_hub_setpoint_never_leaves_its_clamp(rig: RigConfig) -> None:
    loop, heat = HeatLoop(), rig.loops.heat
    for now, surface in enumerate([-40.0, 20.0, 150.0, 85.0]):
        hub = loop.update(float(now) * 2.0, 85.0, surface, 23.0, 0.8, heat)
        assert heat.hub_min_c <= hub <= heat.hub_max_c


def test_it_is_computed_once_a_period(rig: RigConfig) -> None:
    loop, heat = HeatLoop(), rig.loops.heat
    first = loop.update(0.0, 40.0, 30.0, 23.0, 0.8, heat)
    assert loop.update(0.5 * heat.period_s, 40.0, 39.0, 23.0, 0.8, heat) == first
    assert loop.update(heat.period_s, 40.0, 39.0, 23.0, 0.8, heat) < first


def test_a_missing_surface_temperature_changes_nothing(rig: RigConfig) -> None:
    loop, heat = HeatLoop(), rig.loops.heat
    first = loop.update(0.0, 40.0, 30.0, 23.0, 0.8, heat)
    assert loop.update(5.0, 40.0, math.nan, 23.0, 0.8, heat) == first


def test_the_integral_removes_a_lasting_error_and_is_bounded(rig: RigConfig) -> None:
    loop, heat = HeatLoop(), rig.loops.heat
    values = [loop.update(t * heat.period_s, 40.0, 39.5, 23.0, 0.8, heat) for t in range(20_000)]
    assert values[100] > values[0]
    assert values[-1] <= 40.0 + 17.0 * 0.8 + heat.outer_gain * 0.5 + heat.integral_limit_k + 1e-9


def test_a_target_that_moves_a_little_keeps_what_the_integral_has_learned(rig: RigConfig) -> None:
    loop, heat = HeatLoop(), rig.loops.heat
    learned = [loop.update(t * heat.period_s, 39.0, 39.5, 23.0, 0.8, heat) for t in range(600)][-1]
    moved = loop.update(600 * heat.period_s, 39.3, 39.8, 23.0, 0.8, heat)
    assert moved == pytest.approx(learned + 0.3 * 1.8, abs=0.01)


def test_a_target_far_away_forgets_it(rig: RigConfig) -> None:
    loop, heat = HeatLoop(), rig.loops.heat
    for t in range(600):
        loop.update(t * heat.period_s, 39.0, 39.5, 23.0, 0.8, heat)
    far_c = 39.1 + heat.integral_band_k
    assert loop.update(600 * heat.period_s, far_c, far_c, 23.0, 0.8, heat) == HeatLoop().update(
        0.0, far_c, far_c, 23.0, 0.8, heat
    )


def test_a_lifted_wheel_teaches_the_integral_nothing(rig: RigConfig) -> None:
    loop, heat = HeatLoop(), rig.loops.heat
    values = [loop.update(t * heat.period_s, 39.0, 41.0, 23.0, 0.4, heat, touching=False) for t in range(360)]
    assert values[-1] == values[0]
