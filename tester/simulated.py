"""Wire a run to the simulated rig in this process."""

from __future__ import annotations

from sim.can_wire import CanWire
from sim.rig import DeviceSpec, LineSpec, RigSpec, SimRig
from tester.bus_log import BusLog
from tester.engine.build import Ports
from tester.rig import DeviceConfig, IrThermometerConfig, RigConfig


def simulated_ports(
    rig: RigConfig, seed: int, log: BusLog | None, can_wire: type[CanWire] = CanWire
) -> tuple[Ports, SimRig, SimRig]:
    """Return the wires of a new simulated rig, the rig, and the hands at it (the same object).

    ``can_wire``: the kind of bus, ``sim.faults.can.FaultyCanWire`` where it is to be spoiled.
    """
    world = SimRig(spec_of(rig), rig.sim, seed, can_wire)
    if log is not None:
        world.can.tap = log.can
        for name, line in world.lines.items():
            line.tap = log.lines[name]
    return Ports(world.can, dict(world.lines)), world, world


def spec_of(rig: RigConfig) -> RigSpec:
    """Return the wiring that a rig file describes."""
    devices = rig.devices
    return RigSpec(
        bitrate=rig.can.bitrate,
        axes=rig.axes.driven(),
        lines={name: LineSpec(line.baud, line.parity) for name, line in rig.lines.items()},
        load_cell=_device(devices.load_cell),
        jacket=_device(devices.jacket),
        ir_thermometer=_device(devices.ir_thermometer),
    )


def _device(config: DeviceConfig | IrThermometerConfig) -> DeviceSpec:
    return DeviceSpec(config.profile, config.line, config.unit_id)
