"""The wheel's rig armed as before every run (tester.machine.commission.armed_seat)."""

from __future__ import annotations

from collections.abc import Generator
from math import inf, isfinite
from typing import Any

from tester.inputs.rig import Rig
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.control.permissives import rig_bounds
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelPlan
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.run.build import build_run
from tester.machine.commission.armed_seat import ArmedSeat
from tester.machine.commission.commission_step import Waits
from tester.machine.commission.moves import COMMISSIONING
from tester.machine.prompts import Prompts
from tester.machine.rig_ports import Ports
from tester.machine.run_parts import RunSetup
from tester.store.recorder import NullRecorder


class WheelSeat(ArmedSeat):
    """The wheel's rig during the later steps."""

    def __init__(self, rig: Rig, ports: Ports, hands: Any) -> None:
        """Send nothing; the simulated rig gets a new wheel."""
        self.rig = believed = RigConfig.of(rig)
        plan = WheelPlan(COMMISSIONING, (), (), 1)
        super().__init__(build_run(RunSetup(believed, plan, ports, hands, NullRecorder(), Prompts())), plan)
        engine = self.run.engine
        engine.control.bounds = rig_bounds(believed)
        self.ctx: Context = engine.ctx
        hands.install(1, 1, "1#", new_specimen=True)


def mean_temperatures(seat: WheelSeat, seconds: float) -> Generator[Waits, str, tuple[float, float]]:
    """Return the means of surface and hub over a time, degC."""
    surfaces, hubs, began_s = list[float](), list[float](), inf

    def enough(now_s: float) -> bool:
        nonlocal began_s
        r, began_s = seat.ctx.readings, min(began_s, now_s)
        if isfinite(r.surface_c) and isfinite(r.hub_c) and r.surface_valid and r.jacket_valid:
            surfaces.append(r.surface_c)
            hubs.append(r.hub_c)
        return now_s - began_s >= seconds and bool(surfaces)

    yield enough
    return sum(surfaces) / len(surfaces), sum(hubs) / len(hubs)
