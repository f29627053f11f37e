"""Builds the runs of a plain machine (``tester.machine.run_parts.KindRun``). A kind defines twin, table and speeds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import nan
from typing import ClassVar

from tester.base.axes import Setpoint
from tester.inputs.recipe.plain_recipe import Mount, PlainPart
from tester.inputs.recipe.plan import Plan
from tester.inputs.rig.further_sensors import quantities_on
from tester.inputs.rig.plain_rig import PlainRig
from tester.machine.connect import Arming
from tester.machine.interlock_table import InterlockTable
from tester.machine.plain.context import PlainAttendant, PlainContext
from tester.machine.plain.control import PlainControl
from tester.machine.plain.devices import PlainDevices
from tester.machine.plain.image import PlainReadings
from tester.machine.plain.procedures import PlainProcedures
from tester.machine.proof import WatchdogProof
from tester.machine.result_keeping import StoredResults
from tester.machine.run import Run, run_of
from tester.machine.run_parts import KindRun, Part, RunSetup
from tester.machine.safety_inputs import table_on


class PlainArming(Arming[PlainDevices, PlainRig]):
    """Tests the drives' watchdogs at standstill; lifts nothing."""

    def prove(self) -> WatchdogProof:
        """Begin to test the drives' watchdogs."""
        arming = self.rig.arming
        return WatchdogProof(self.devices, follow=False, watchdog=arming.watchdog_proof, withhold_s=arming.withhold_s)


class PlainRuns(KindRun):
    """Builds runs of a plain machine. A kind inherits from it."""

    part: PlainPart
    table: InterlockTable
    compound: ClassVar[str] = "1#"
    """Of a specimen that no recipe mounts: in manual mode, and on a twin in a process of its own."""
    context: ClassVar[type[PlainContext]] = PlainContext
    """A kind with gates of its own extends it."""

    def readings(self, rig: PlainRig) -> PlainReadings:
        """Return the kind's readings before anything has been read."""
        raise NotImplementedError

    def speeds(self, setpoint: Setpoint, readings: PlainReadings) -> Mapping[str, float]:
        """Return the speeds that a condition demands of the drives; called at the begin of each repeat."""
        raise NotImplementedError

    def split(self, plan: Plan) -> tuple[Part, ...]:
        """Return a part of the plan for each specimen that is mounted."""
        starts = [place for place, step in enumerate(plan.steps) if isinstance(step, Mount)] or [0]
        parts: list[Part] = []
        for number, (begin, end) in enumerate(zip(starts, [*starts[1:], len(plan.steps)], strict=True), start=1):
            parts.append(Part(number, replace(plan, steps=plan.steps[begin:end]), number))
        return tuple(parts)

    def build(self, setup: RunSetup) -> Run:
        """Return a run that is ready to be ticked."""
        own, quantities = PlainRig.of(setup.rig), quantities_on(setup.rig)
        devices = PlainDevices(own, setup.ports)
        readings = self.readings(own)
        readings.channels = [nan] * len(quantities.further)
        control = PlainControl(own, table_on(own, self.table), readings)
        ctx = self.context(own, readings, setup.prompts, setup.recorder, setup.attendant, quantities, devices.own)
        results = StoredResults[PlainContext](setup.recorder, point=setup.point)
        procedures = PlainProcedures(self.part, results, self.speeds)
        arming = PlainArming(devices, own)
        return run_of(setup.plan, devices, control, ctx, arming, procedures, quantities, own.arming.listen_s)

    def mount(self, attendant: PlainAttendant, compound: str) -> None:
        """Mount a new specimen; "" is the kind's ``compound``."""
        attendant.install(0, compound or self.compound)
