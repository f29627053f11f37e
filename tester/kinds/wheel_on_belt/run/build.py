"""Put a rig together from its configuration: ports, drivers, control, executor."""

from __future__ import annotations

from math import nan

from drivers.joined_cell import JoinedCell
from tester.analysis.left_out import combining_of
from tester.inputs.recipe.plan import Plan, Stand
from tester.inputs.rig.further_sensors import quantities_on
from tester.kinds.wheel_on_belt.budget import ROLL_CHECK_N
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.control.loops import hub_needed_c
from tester.kinds.wheel_on_belt.control.permissives import Bounds, rig_bounds
from tester.kinds.wheel_on_belt.control.step import WheelControl
from tester.kinds.wheel_on_belt.image.axes import held_by, straight
from tester.kinds.wheel_on_belt.image.devices import Devices
from tester.kinds.wheel_on_belt.image.process_image import CELL, Readings
from tester.kinds.wheel_on_belt.interlocks.heat_balance import NO_HISTORY, KnownRatio
from tester.kinds.wheel_on_belt.procedures.arming import WheelArming
from tester.kinds.wheel_on_belt.procedures.belts import Belts
from tester.kinds.wheel_on_belt.procedures.on_record import WheelResults
from tester.kinds.wheel_on_belt.procedures.steps import DEFAULT_LOAD_N, DEFAULT_SPEED_M_S, WheelProcedures
from tester.kinds.wheel_on_belt.procedures.wheel_life import wheel_of
from tester.kinds.wheel_on_belt.recipe.plan_steps import Heat, PreGrind, WheelCondition, WheelPlan
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.stopped_contact import counted_on
from tester.machine.run import Run, run_of
from tester.machine.run_parts import RunSetup
from tester.store.resumable import ResumePoint


def take_up(procedures: WheelProcedures, results: WheelResults, point: ResumePoint) -> None:
    """Give the remaining plan's procedures the committed data: repeats, wheels, the load cell's reference zero."""
    results.earlier = dict(point.conditions)
    results.pool = point.pool
    if point.reference_tare is not None:
        procedures.reference_tare.extend(point.reference_tare[name] for name in CELL)
    wheels = point.stand.mounted
    procedures.wheels = max([procedures.wheels, *(wheel.number for wheel in wheels)])
    # The present wheel counts as having measured, so that a condition that would wear it out gets a new wheel. A half
    # measured condition stays on its wheel, as in a run without an interruption.
    if wheels and wheels[-1].last_condition and point.next_repeat is None:
        procedures.measured_wheel = wheels[-1].number


def take_up_wheels(ctx: Context, plan: WheelPlan, stand: Stand) -> None:
    """Restore the history of the belts, and the earlier wheels for a plan with references.

    On a simulated rig a plan without references has belts of its own in every part.
    """
    if plan.references or not ctx.rig.simulated:
        ctx.belts = Belts(travels_m=stand.travels_m)
    if ctx.belts.travel_m > 0.0:
        ctx.attendant.belt_travelled(ctx.belts.travel_m)
    if not plan.references:
        return
    for piece in stand.mounted:
        compound = plan.specimen(piece.specimen).compound
        wheel = wheel_of(ctx.rig.geometry, piece.specimen, piece.replicate, piece.number, compound, piece.diameter_mm)
        wheel.sliding_m, wheel.condition = piece.sliding_m, piece.last_condition
        ctx.shelf[(piece.specimen, piece.replicate)] = wheel


def plan_bounds(plan: Plan, rig: RigConfig) -> Bounds:
    """Return the greatest load, speeds, temperature and positions among a plan's steps and its wheel changes."""
    load, wheel, belt = ROLL_CHECK_N, rig.interlocks.cooldown_speed_m_s, 0.0
    surface, positions = rig.ambient_c, straight()
    conditions = False
    grind = plan.prepare.pre_grind if isinstance(plan, WheelPlan) else None  # manual mode plans nothing
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
    # Matched speeds: without slip the belt runs as fast as the wheel.
    hub = min(rig_bounds(rig).hub_c, hub_needed_c(rig, surface))
    return Bounds(load, wheel, max(belt, wheel), surface, hub, positions)


def build_run(
    setup: RunSetup, heat: KnownRatio = NO_HISTORY, procedures: type[WheelProcedures] = WheelProcedures
) -> Run:
    """Return a run that is ready to be ticked.

    ``heat``: facts from earlier runs on this rig about its heat balance (``heatings``); ``procedures``: selects the
    activities of its steps.
    """
    rig, plan, point = RigConfig.of(setup.rig), setup.plan, setup.point
    devices = Devices(rig, setup.ports)
    control = WheelControl(rig, plan_bounds(plan, rig))
    control.view.know_heat(heat)
    diameter_mm, quantities, cell = rig.geometry.wheel_diameter_mm, quantities_on(rig), devices.cell
    readings = Readings(
        cold_mm=diameter_mm,
        diameter_mm=diameter_mm,
        channels=[nan] * len(quantities.further),
        joined=cell if isinstance(cell, JoinedCell) else None,
        cell_old_s=rig.interlocks.stale_cell_s,
    )
    ctx = Context(rig, readings, setup.prompts, setup.recorder, setup.attendant, cell, control.view, quantities)
    ctx.counted_on = counted_on(rig, plan)
    results = WheelResults(setup.recorder, combining_of(plan.metadata))
    serving = procedures(plan, results, hardware=not rig.simulated)
    if point is not None:
        take_up(serving, results, point)
        take_up_wheels(ctx, WheelPlan.of(plan), point.stand)
    arming = WheelArming(devices, rig)
    return run_of(plan, devices, control, ctx, arming, serving, quantities, rig.arming.listen_s)
