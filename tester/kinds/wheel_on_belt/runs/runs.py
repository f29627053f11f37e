"""This machine, for a run (``tester.machine.run_parts``)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar, Final

from tester.inputs.recipe.plan import Plan
from tester.inputs.rig import Rig
from tester.kinds.wheel_on_belt.context import Attendant
from tester.kinds.wheel_on_belt.interlocks.heat_ratio import NO_HISTORY
from tester.kinds.wheel_on_belt.procedures.results import record_state
from tester.kinds.wheel_on_belt.procedures.steps import WheelProcedures
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.runs.build import build_run
from tester.kinds.wheel_on_belt.runs.heatings import known_heat
from tester.kinds.wheel_on_belt.runs.split import split
from tester.kinds.wheel_on_belt.served.left_on_rig import HeatHistory
from tester.machine.ports import Ports
from tester.machine.prompts import Prompts
from tester.machine.run import Run
from tester.machine.run_parts import KindRun, Part
from tester.machine.served import History
from tester.store.recorder import Recorder
from tester.store.records import Calibration
from tester.store.resume import ResumePoint


class WheelRuns:
    """Builds a run of this machine, and supplies its further parts."""

    plant: str = "wheel_on_belt"
    procedures: ClassVar[type[WheelProcedures]] = WheelProcedures
    """Selects the activities for the steps of a plan; a laboratory's own kind may extend it."""

    def split(self, plan: Plan) -> tuple[Part, ...]:
        """Return a part for each specimen and replicate."""
        return split(plan)

    def build(
        self,
        rig: Rig,
        plan: Plan,
        ports: Ports,
        attendant: Attendant,
        recorder: Recorder,
        prompts: Prompts,
        point: ResumePoint | None = None,
        history: History | None = None,
    ) -> Run:
        """Return a run that is ready to be ticked."""
        heat = history.ratio if isinstance(history, HeatHistory) else NO_HISTORY
        return build_run(RigConfig.of(rig), plan, ports, attendant, recorder, prompts, point, heat, self.procedures)

    def mount(self, attendant: Attendant, compound: str) -> None:
        """Put a new wheel on; "" is compound 1#."""
        attendant.install(0, 0, compound or "1#", new_specimen=True)

    def history(self, runs: Path, rig: Rig) -> HeatHistory:
        """Return the facts about the heat balance from the runs."""
        return HeatHistory(known_heat(runs, RigConfig.of(rig)))

    def calibration(self, rig: Rig) -> Iterator[Calibration]:
        """Yield the diameters that make speeds of turns."""
        geometry, known = RigConfig.of(rig).geometry, RigConfig.of(rig).calibration
        if known.record:
            yield Calibration("load_cell", "calibration record", known.record, "")
            yield Calibration("load_cell", "cell sensitivity", repr(known.cell_sensitivity), "1")
        yield Calibration("wheel", "diameter when new", repr(geometry.wheel_diameter_mm), "mm")
        yield Calibration("belt", "roller diameter", repr(geometry.belt_roller_diameter_mm), "mm")

    def store_state(self, run: Run, recorder: Recorder, now_s: float) -> None:
        """Store how worn the wheel is, and how far belt and wheel have come."""
        ctx = run.engine.ctx
        if ctx.wheel.wheel:
            record_state(recorder, ctx, now_s)


RUNS: Final[KindRun] = WheelRuns()
