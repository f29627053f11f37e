"""A rig armed as before every run, with a commissioning's moves in place of a recipe.

Control, interlocks, limits and stops are those of a run; only the demand comes from elsewhere.
"""

from __future__ import annotations

from collections.abc import Generator
from math import inf, isfinite
from typing import Any

from tester.inputs.rig import Rig
from tester.kinds.wheel_on_belt.commission.moves import COMMISSIONING, MovesExecutor
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.control.permissives import rig_bounds
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelPlan
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.run.build import build_run
from tester.machine.activity import Activity
from tester.machine.commission.commission_step import Dialogue, Waits
from tester.machine.prompts import Prompts
from tester.machine.rig_ports import Ports
from tester.machine.run_parts import RunSetup
from tester.machine.state import Mode
from tester.store.recorder import NullRecorder


class ArmedSeat:
    """The rig during the later steps (tester.machine.commission.commission_step.Seat)."""

    def __init__(self, rig: Rig, ports: Ports, hands: Any) -> None:
        """Send nothing; the simulated rig gets a new wheel."""
        self.rig = believed = RigConfig.of(rig)
        plan = WheelPlan(COMMISSIONING, (), (), 1)
        self.run = build_run(RunSetup(believed, plan, ports, hands, NullRecorder(), Prompts()))
        self.executor = MovesExecutor()
        engine = self.run.engine
        engine.executor = self.executor
        engine.control.bounds = rig_bounds(believed)
        self.ctx: Context = engine.ctx
        hands.install(1, 1, "1#", new_specimen=True)
        self._stopped = False

    @property
    def ready(self) -> bool:
        """Whether the rig is armed and in RUN."""
        return self.run.connected and self.run.engine.control.state.mode is Mode.RUN

    @property
    def finished(self) -> bool:
        """Whether the rig is at rest and released."""
        return self.run.finished

    @property
    def reason(self) -> str:
        """Reason for an unrequested end: a refusal to arm, a trip, a failed move."""
        trip = self.run.engine.control.state.trip
        if trip is not None:
            return f"{trip.name}: {trip.text}"
        return self.executor.failed or ("" if self._stopped else self.run.reason)

    def tick(self, now: float) -> float:
        """Advance the rig by one tick."""
        return self.run.tick(now)

    def stop(self, why: str, *, fast: bool = False) -> None:
        """Stop as a run does; a warm wheel keeps turning until it may come to rest."""
        self._stopped = True
        self.executor.activity = None
        self.run.request_stop(why, fast=fast)

    def abandon(self) -> None:
        """Send safe outputs once."""
        self.run.abandon()

    def do(self, activity: Activity[Any]) -> Dialogue:
        """Yield until an activity is done."""
        self.executor.activity = activity
        executor = self.executor
        yield lambda now_s: executor.activity is None and not executor.failed


def mean_temperatures(seat: ArmedSeat, seconds: float) -> Generator[Waits, str, tuple[float, float]]:
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
