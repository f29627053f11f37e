"""Builds the runs of a wheel on a belt, and splits their plans (``tester.machine.run_parts``)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import ClassVar, Final

from tester.inputs.recipe.plan import ConditionStep, Plan, Step
from tester.inputs.rig import Rig
from tester.kinds.wheel_on_belt.context import Attendant
from tester.kinds.wheel_on_belt.interlocks.heat_balance import NO_HISTORY
from tester.kinds.wheel_on_belt.procedures.on_record import record_state
from tester.kinds.wheel_on_belt.procedures.steps import WheelProcedures
from tester.kinds.wheel_on_belt.recipe.plan_steps import Cool, Install, WheelPlan, starts_of
from tester.kinds.wheel_on_belt.recipe.wheel_change import with_belts
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.run.build import build_run
from tester.kinds.wheel_on_belt.run.past_runs import known_heat
from tester.kinds.wheel_on_belt.served.left_on_rig import HeatHistory
from tester.machine.run import Run
from tester.machine.run_parts import KindRun, Part, RunSetup
from tester.store.recorder import Recorder
from tester.store.records import Calibration


def split(plan: Plan) -> tuple[Part, ...]:
    """Return the parts of a plan in its order; at least one."""
    starts = starts_of(plan.steps, lambda install: (install.specimen, install.replicate))
    last_wheel = max((step.wheel for step in plan.steps if isinstance(step, Install)), default=0)
    if len(starts) == 1 or WheelPlan.of(plan).references:
        return (Part(1, plan, last_wheel),)
    whole = WheelPlan.of(plan)
    parts: list[Part] = []
    for number, (begin, end) in enumerate(zip(starts, [*starts[1:], len(plan.steps)], strict=True), start=1):
        steps = whole.steps[begin:end]
        if isinstance(steps[0], Cool):
            steps = steps[1:]  # a separate rig starts cold
        steps = with_belts(steps, again=False)  # ... and with a belt of its own
        wheels = {step.wheel for step in steps if isinstance(step, Install)}
        parts.append(Part(number, _part_of(plan, steps, wheels), last_wheel))
        # Every unplanned wheel measures at least one condition, so two parts never use the same number.
        last_wheel += sum(1 for step in steps if isinstance(step, ConditionStep))
    return tuple(parts)


def _part_of(plan: Plan, steps: tuple[Step, ...], wheels: set[int]) -> Plan:
    """Return a plan of some steps, with the wear of their wheels."""
    whole = WheelPlan.of(plan)
    return replace(whole, steps=steps, wear=tuple(wear for wear in whole.wear if wear.wheel in wheels))


class WheelRuns(KindRun):
    """Builds a run of this machine, and supplies its further parts."""

    plan: type[Plan] = WheelPlan
    plant: str = "wheel_on_belt"
    procedures: ClassVar[type[WheelProcedures]] = WheelProcedures
    """Selects the activities for the steps of a plan; a laboratory's own kind may extend it."""

    def split(self, plan: Plan) -> tuple[Part, ...]:
        """Return a part for each specimen and replicate."""
        return split(plan)

    def build(self, setup: RunSetup) -> Run:
        """Return a run that is ready to be ticked."""
        heat = setup.history.ratio if isinstance(setup.history, HeatHistory) else NO_HISTORY
        return build_run(setup, heat, self.procedures)

    def mount(self, attendant: Attendant, compound: str) -> None:
        """Mount a new wheel; "" is compound 1#."""
        attendant.install(0, 0, compound or "1#", new_specimen=True)

    def history(self, runs: Path, rig: Rig) -> HeatHistory:
        """Return the facts about the heat balance from past runs."""
        return HeatHistory(known_heat(runs, RigConfig.of(rig)))

    def calibration(self, rig: Rig) -> Iterator[Calibration]:
        """Yield the diameters that convert turns to speeds."""
        geometry, known = RigConfig.of(rig).geometry, RigConfig.of(rig).calibration
        if known.record:
            yield Calibration("load_cell", "calibration record", known.record, "")
            yield Calibration("load_cell", "cell sensitivity", repr(known.cell_sensitivity), "1")
        yield Calibration("wheel", "diameter when new", repr(geometry.wheel_diameter_mm), "mm")
        yield Calibration("belt", "roller diameter", repr(geometry.belt_roller_diameter_mm), "mm")

    def store_state(self, run: Run, recorder: Recorder, now_s: float) -> None:
        """Store the wheel's wear, and the distances of belt and wheel."""
        ctx = run.engine.ctx
        if ctx.wheel.wheel:
            record_state(recorder, ctx, now_s)


RUNS: Final = WheelRuns()
