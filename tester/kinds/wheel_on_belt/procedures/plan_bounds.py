"""The most a recipe asks for: no command goes beyond it, whatever the executor wants."""

from __future__ import annotations

from tester.inputs.recipe.plan import Plan
from tester.kinds.wheel_on_belt.control.permissives import Bounds, rig_bounds
from tester.kinds.wheel_on_belt.image.axes import held_by, straight
from tester.kinds.wheel_on_belt.procedures.steps import DEFAULT_LOAD_N, DEFAULT_SPEED_M_S
from tester.kinds.wheel_on_belt.recipe.steps import Heat, PreGrind, WheelCondition, WheelPlan
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.roll_check import ROLL_CHECK_N


def plan_bounds(plan: Plan, rig: RigConfig) -> Bounds:
    """Return the greatest load, speeds, temperature and positions among a plan's steps and its wheel changes."""
    load, wheel, belt = ROLL_CHECK_N, rig.interlocks.cooldown_speed_m_s, 0.0
    surface, positions = rig.ambient_c, straight()
    conditions = False
    grind = plan.prepare.pre_grind if isinstance(plan, WheelPlan) else None  # by hand nothing is planned
    steps = (*plan.steps, grind) if grind is not None else plan.steps
    for step in steps:
        if isinstance(step, WheelCondition):
            conditions = True
            sp = held_by(step.setpoint)
            load, wheel = max(load, sp.load_n), max(wheel, sp.wheel_speed_m_s)
            belt, surface = max(belt, sp.belt_speed_m_s), max(surface, sp.temperature_c)
            if step.both_directions:
                belt = max(belt, sp.reversed().belt_speed_m_s)
            positions = {name: max(most, abs(sp.positions[name])) for name, most in positions.items()}
        elif isinstance(step, PreGrind):
            load, wheel = max(load, step.load_n), max(wheel, step.wheel_speed_m_s)
            belt = max(belt, step.belt_speed_m_s)
        elif isinstance(step, Heat):
            surface = max(surface, step.temperature_c)
            if not conditions:
                load, wheel = max(load, DEFAULT_LOAD_N), max(wheel, DEFAULT_SPEED_M_S)
    # Matched speeds: the belt runs as fast as the wheel whenever there is to be no slip.
    return Bounds(load, wheel, max(belt, wheel), surface, rig_bounds(rig).hub_c, positions)
