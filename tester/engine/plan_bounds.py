"""The most a recipe asks for: no command goes beyond it, whatever the executor wants."""

from __future__ import annotations

from tester.control.permissives import Bounds, rig_bounds
from tester.engine.executor import DEFAULT_LOAD_N, DEFAULT_SPEED_M_S
from tester.engine.wear_check import ROLL_CHECK_N
from tester.recipe.plan import ConditionStep, Heat, Plan, PreGrind
from tester.rig import RigConfig


def plan_bounds(plan: Plan, rig: RigConfig) -> Bounds:
    """Return the greatest load, speeds, temperature and angles among a plan's steps and its wheel changes."""
    load, wheel, belt = ROLL_CHECK_N, rig.interlocks.cooldown_speed_m_s, 0.0
    surface, sideslip, camber = rig.ambient_c, 0.0, 0.0
    conditions = False
    steps = (*plan.steps, plan.prepare.pre_grind) if plan.prepare.pre_grind is not None else plan.steps
    for step in steps:
        if isinstance(step, ConditionStep):
            conditions = True
            sp = step.setpoint
            load, wheel = max(load, sp.load_n), max(wheel, sp.wheel_speed_m_s)
            belt, surface = max(belt, sp.belt_speed_m_s), max(surface, sp.temperature_c)
            sideslip, camber = max(sideslip, abs(sp.sideslip_deg)), max(camber, abs(sp.camber_deg))
        elif isinstance(step, PreGrind):
            load, wheel = max(load, step.load_n), max(wheel, step.wheel_speed_m_s)
            belt = max(belt, step.belt_speed_m_s)
        elif isinstance(step, Heat):
            surface = max(surface, step.temperature_c)
            if not conditions:
                load, wheel = max(load, DEFAULT_LOAD_N), max(wheel, DEFAULT_SPEED_M_S)
    # Matched speeds: the belt runs as fast as the wheel whenever there is to be no slip.
    return Bounds(load, wheel, max(belt, wheel), surface, rig_bounds(rig).hub_c, sideslip, camber)
