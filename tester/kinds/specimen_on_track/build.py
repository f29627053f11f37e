"""Put a rig together from its configuration: ports, drivers, control, executor."""

from __future__ import annotations

from math import inf

from tester.inputs.recipe.plan import Plan
from tester.inputs.rig.sensors import quantities_on
from tester.kinds.specimen_on_track.axes import held_by
from tester.kinds.specimen_on_track.context import TrackAttendant, TrackContext
from tester.kinds.specimen_on_track.control import TrackControl
from tester.kinds.specimen_on_track.devices import TrackDevices
from tester.kinds.specimen_on_track.procedures.arming import TrackArming
from tester.kinds.specimen_on_track.procedures.condition import TrackResults
from tester.kinds.specimen_on_track.procedures.steps import TrackProcedures
from tester.kinds.specimen_on_track.process import TrackDemand
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.connect import Connector
from tester.machine.engine import Engine
from tester.machine.executor import Executor
from tester.machine.ports import Ports
from tester.machine.prompts import Prompts
from tester.machine.run import Run
from tester.machine.sampler import Sampler
from tester.store.recorder import Recorder
from tester.store.resume import ResumePoint


def build_run(
    rig: TrackConfig,
    plan: Plan,
    ports: Ports,
    attendant: TrackAttendant,
    recorder: Recorder,
    prompts: Prompts,
    point: ResumePoint | None = None,
) -> Run:
    """Return a run that is ready to be ticked; ``point``: where it goes on, with the remaining plan."""
    devices = TrackDevices(rig, ports)
    speeds = [held_by(step.setpoint).track_m_s for step in plan.conditions()]
    # A linear track is brought to its place at half its greatest speed, whatever the recipe asks for.
    most_m_s = max([0.5 * rig.limits.track_speed_m_s if rig.linear else 0.0, *speeds], default=0.0) if speeds else inf
    control = TrackControl(rig, most_m_s)
    quantities = quantities_on(rig)
    ctx = TrackContext(rig, TrackDemand(), prompts, recorder, attendant, devices, quantities)
    results = TrackResults(recorder)
    if point is not None:
        results.earlier = dict(point.conditions)
        results.pool = point.pool
    engine = Engine(devices, control, Executor(plan, TrackProcedures(results)), ctx, Sampler(recorder, quantities))
    return Run(Connector(devices, rig, TrackArming(devices, rig), rig.arming.listen_s), engine)
