"""Put a rig together from its configuration: ports, drivers, control, executor."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass
from math import log, pi

from drivers.canopen.master import CanMaster
from drivers.ir_thermometer import IrThermometer
from drivers.jacket import HeatingJacket
from drivers.load_cell import LoadCell
from drivers.modbus import ModbusLink
from drivers.ports import CanPort, LinePort
from drivers.profiles import load_profile
from drivers.servo import AxisConfig, ServoDrive
from tester.control.heat_loop import HeatLoop
from tester.control.load_loop import LoadLoop
from tester.control.state import ControlState
from tester.control.step import Control
from tester.engine.connect import Connector
from tester.engine.context import Attendant, Context
from tester.engine.devices import Axes, Devices
from tester.engine.engine import Engine
from tester.engine.executor import Executor
from tester.engine.gates import Gates
from tester.engine.plan_bounds import plan_bounds
from tester.engine.prompts import Prompts
from tester.engine.results import StoredResults
from tester.engine.resume import take_up
from tester.engine.run import Run
from tester.engine.sampler import Sampler
from tester.engine.wheel_life import WheelLife
from tester.interlocks.heat_ratio import NO_HISTORY, KnownRatio
from tester.pace import Pace
from tester.process import Demand, Readings, Setpoints
from tester.recipe.plan import Plan
from tester.rig import LineConfig, RigConfig
from tester.store.recorder import Recorder
from tester.store.resume import ResumePoint


@dataclass(frozen=True, slots=True)
class Ports:
    """The wires to a rig: one CAN bus, and the Modbus lines by their names in the rig file.

    Real ones come with the clock that stamps what arrives on them (``pace``) and are closed by ``opened``.
    """

    can: CanPort
    lines: dict[str, LinePort]
    pace: Pace | None = None
    opened: ExitStack | None = None

    def close(self) -> None:
        """Give the wires back."""
        if self.opened is not None:
            self.opened.close()


def build_devices(rig: RigConfig, ports: Ports) -> Devices:
    """Return drivers for every device of the rig file, on the given wires."""
    master = CanMaster(rig.can.node, rig.can.heartbeat_s)

    def drive(config: AxisConfig | None) -> ServoDrive | None:
        if config is None:
            return None
        made = ServoDrive(config)
        master.add(made)
        return made

    axes = rig.axes
    wheel, belt, press = (ServoDrive(config) for config in (axes.wheel, axes.belt, axes.press))
    for made in (wheel, belt, press):
        master.add(made)
    links = {name: _link(config) for name, config in rig.lines.items()}
    cell, jacket, thermometer = rig.devices.load_cell, rig.devices.jacket, rig.devices.ir_thermometer
    return Devices(
        can=ports.can,
        master=master,
        axes=Axes(wheel, belt, press, drive(axes.sideslip), drive(axes.camber)),
        lines=[(ports.lines[name], link) for name, link in links.items()],
        cell=LoadCell(load_profile(cell.profile), cell.unit_id, links[cell.line]),
        thermometer=IrThermometer(
            load_profile(thermometer.profile), thermometer.unit_id, links[thermometer.line],
            emissivity=thermometer.emissivity,
        ),
        jacket=HeatingJacket(load_profile(jacket.profile), jacket.unit_id, links[jacket.line]),
    )  # fmt: skip


def _link(config: LineConfig) -> ModbusLink:
    return ModbusLink(config.framing, config.baud, config.parity)


def loss_ratios(rig: RigConfig) -> tuple[float, float]:
    """Return the steady hub-surface difference per kelvin of surface above ambient: lifted, and in rolling contact.

    Resistance of hub joint and rubber times the loss conductance of the surface, from the observer's parameters
    [A]. The rubber's side faces lose about half of their heat through the surface cells.
    """
    observer, thermal = rig.observer, rig.observer.thermal
    outer, width = 0.5e-3 * rig.geometry.wheel_diameter_mm, 1e-3 * rig.geometry.wheel_width_mm
    inner = outer - 1e-3 * observer.wheel.rubber_layer
    resistance = log(outer / inner) / (2.0 * pi * thermal.conductivity * width) + 1.0 / thermal.hub_to_rubber
    tread = thermal.film_rotating * 2.0 * pi * outer * width
    sides = thermal.film_sides * pi * (outer * outer - inner * inner)
    lifted = tread + sides
    return resistance * lifted, resistance * (lifted + observer.belt_conductance)


def build_run(
    rig: RigConfig,
    plan: Plan,
    ports: Ports,
    attendant: Attendant,
    recorder: Recorder,
    prompts: Prompts,
    point: ResumePoint | None = None,
    heat: KnownRatio = NO_HISTORY,
) -> Run:
    """Return a run that is ready to be ticked; ``point``: where it goes on, with the remaining plan; ``heat``: what
    earlier runs on this rig make known of its heat balance (tester.store.heatings)."""
    devices = build_devices(rig, ports)
    load = LoadLoop()
    state = ControlState(Setpoints(), load, HeatLoop(rig.loops.heat.hub_min_c))
    control = Control(rig, state, loss_ratios(rig), plan_bounds(plan, rig))
    geometry = rig.geometry
    ctx = Context(
        rig=rig,
        readings=Readings(cold_mm=geometry.wheel_diameter_mm, diameter_mm=geometry.wheel_diameter_mm),
        demand=Demand(),
        gates=Gates(rig.gates),
        prompts=prompts,
        journal=recorder,
        attendant=attendant,
        cell=devices.cell,
        wheel=WheelLife(installed_mm=geometry.wheel_diameter_mm, width_mm=geometry.wheel_width_mm),
        contact=load,
        ambient_c=rig.ambient_c,
        wheel_changed=control.view.wheel_changed,
        heat=control.view.heat,
        heat_known=control.view.know_heat(heat),
    )
    results = StoredResults(recorder)
    executor = Executor(plan, results, hardware=not rig.simulated)
    if point is not None:
        take_up(executor, results, point)
    engine = Engine(devices, control, executor, ctx, Sampler(recorder))
    return Run(Connector(devices, rig), engine)
