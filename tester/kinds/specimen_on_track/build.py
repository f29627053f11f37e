"""Put a rig together from its configuration: ports, drivers, control, executor."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf

from drivers.canopen.master import CanMaster
from drivers.canopen.sensor_node import SensorNode
from drivers.chamber import ClimateChamber
from drivers.modbus import Device, ModbusLink
from drivers.sensor import Sensor
from drivers.servo import ServoDrive
from tester.inputs.recipe.plan import Plan
from tester.inputs.rig.profiles import profile_of
from tester.inputs.rig.sensors import further_sensors, quantities_on, title_of
from tester.kinds.specimen_on_track.axes import held_by
from tester.kinds.specimen_on_track.context import TrackAttendant, TrackContext
from tester.kinds.specimen_on_track.control import TrackControl
from tester.kinds.specimen_on_track.devices import CELL_CHANNELS, SURFACE_CHANNELS, TrackDevices
from tester.kinds.specimen_on_track.procedures.arming import TrackArming
from tester.kinds.specimen_on_track.procedures.condition import TrackResults
from tester.kinds.specimen_on_track.procedures.steps import TrackProcedures
from tester.kinds.specimen_on_track.process import TrackDemand
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.connect import Connector
from tester.machine.engine import Engine
from tester.machine.executor import Executor
from tester.machine.field_device import FieldDevice
from tester.machine.ports import Ports
from tester.machine.prompts import Prompts
from tester.machine.run import Run
from tester.machine.sampler import Sampler
from tester.store.recorder import Recorder
from tester.store.resume import ResumePoint


def build_devices(rig: TrackConfig, ports: Ports) -> TrackDevices:
    """Return drivers for every device of the rig file, on the given wires."""
    master = CanMaster(rig.can.node, rig.can.heartbeat_s)
    track = ServoDrive(rig.axes.track)
    lift = ServoDrive(rig.axes.lift) if rig.axes.lift is not None else None
    nodes = [SensorNode(config) for config in rig.can.nodes.values()]
    for node in (track, lift, *nodes):
        if node is not None:
            master.add(node)
    links = {name: ModbusLink(one.framing, one.baud, one.parity) for name, one in rig.lines.items()}
    cell = _sensor(rig, "load_cell", links, CELL_CHANNELS)
    assert cell is not None  # the file has one, or is refused
    thermometer, pyrometer = (_sensor(rig, name, links, SURFACE_CHANNELS) for name in ("thermometer", "pyrometer"))
    chamber: ClimateChamber | None = None
    if rig.chamber:
        config = rig.devices["chamber"]
        chamber = ClimateChamber(profile_of(config.profile), config.unit_id, links[config.line])
    further = {name: _sensor(rig, name, links) for name in further_sensors(rig)}
    own = {"load_cell": cell, "chamber": chamber, "thermometer": thermometer, "pyrometer": pyrometer}
    drivers: dict[str, Device] = {name: one for name, one in {**own, **further}.items() if one is not None}
    return TrackDevices(
        can=ports.can,
        master=master,
        track=track,
        lift=lift,
        lines=[(ports.lines[name], link) for name, link in links.items()],
        cell=cell,
        chamber=chamber,
        thermometer=thermometer,
        pyrometer=pyrometer,
        modbus=[
            FieldDevice(name, title_of(rig, name), config.line, drivers[name]) for name, config in rig.devices.items()
        ],
        sensors=[one for one in further.values() if one is not None],
        nodes=nodes,
        arm=rig.arm,
        metres=rig.metres,
    )


def _sensor(
    rig: TrackConfig, name: str, links: Mapping[str, ModbusLink], channels: tuple[str, ...] = ()
) -> Sensor | None:
    """Return the driver of a sensor, None where the rig has none of that name."""
    config = rig.devices.get(name)
    if config is None:
        return None
    return Sensor(profile_of(config.profile), config.unit_id, links[config.line], channels, config.parameters)


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
    devices = build_devices(rig, ports)
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
