"""Initialises steps from the state that an interrupted run left in the store."""

from __future__ import annotations

from tester.inputs.recipe.plan import Stand
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.process_image import CELL
from tester.kinds.wheel_on_belt.procedures.on_record import WheelResults
from tester.kinds.wheel_on_belt.procedures.steps import WheelProcedures
from tester.kinds.wheel_on_belt.procedures.wheel_life import WheelLife
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelPlan
from tester.store.resumable import ResumePoint


def take_up(procedures: WheelProcedures, results: WheelResults, point: ResumePoint) -> None:
    """Let the procedures of the remaining plan know what is committed: repeats, wheels, the load cell's reference
    zero."""
    results.earlier = dict(point.conditions)
    results.pool = point.pool
    if point.reference_tare is not None:
        procedures.reference_tare.extend(point.reference_tare[name] for name in CELL)
    wheels = point.stand.mounted
    procedures.wheels = max([procedures.wheels, *(wheel.number for wheel in wheels)])
    # The wheel that is on has measured before, so that a condition it would not outlast gets a new one. A condition
    # that is half measured stays on its wheel, as in a run without an interruption.
    if wheels and wheels[-1].last_condition and point.next_repeat is None:
        procedures.measured_wheel = wheels[-1].number


def take_up_wheels(ctx: Context, plan: WheelPlan, stand: Stand) -> None:
    """Know the belt that is on, and the wheels that were, for a plan with references; others have a belt a part."""
    if not plan.references:
        return
    ctx.belt_travel_m = stand.travel_m
    if stand.travel_m > 0.0:
        ctx.attendant.belt_travelled(stand.travel_m)
    installed_mm, width_mm = ctx.wheel.installed_mm, ctx.wheel.width_mm
    for one in stand.mounted:
        ctx.shelf[(one.specimen, one.replicate)] = WheelLife(
            specimen=one.specimen,
            replicate=one.replicate,
            wheel=one.number,
            compound=plan.specimen(one.specimen).compound,
            installed_mm=installed_mm,
            width_mm=width_mm,
            loss_mm=installed_mm - one.diameter_mm,
            sliding_m=one.sliding_m,
            condition=one.last_condition,
        )
