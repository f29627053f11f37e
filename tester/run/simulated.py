"""The simulated rig of a run in this process: its wires, and its true values."""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from drivers.canopen.node_config import NodeConfig
from drivers.ports import byte_bits
from sim import machines
from sim.nodes.sensor_slave import UnknownQuantityError
from sim.rig import DeviceSpec, LineSpec, RigSpec, ShareSpec, SimRig
from sim.wires.can_wire import CanWire
from tester.base.source import InvalidSource, Problem
from tester.inputs.materials.setting import law_setting
from tester.inputs.recipe.plan import Plan
from tester.inputs.rig import DeviceConfig, LineConfig, Rig
from tester.inputs.rig.further_sensors import further_sensors, shares_of
from tester.inputs.rig.profiles import profile_of
from tester.inputs.rig.safety_input import CLOSED
from tester.machine.rig_ports import Ports
from tester.run.bus_log import BusLog
from tester.run.kind_lookup import run_parts
from tester.store.recorder import Recorder


def simulated_ports(
    rig: Rig,
    seed: int,
    log: BusLog | None,
    can_wire: type[CanWire] = CanWire,
    *,
    recipe: Path | None = None,
    surface: str = "",
) -> tuple[Ports, SimRig, Any]:
    """Return the wires of a new simulated rig, the rig, and its attendant (the same object).

    Raises InvalidSource if a sensor shows a quantity that the plant lacks. ``can_wire``: the class of the bus,
    ``sim.faults.can.FaultyCanWire`` for faults. ``recipe``: a file; materials are searched first in its folder.
    ``surface``: the recipe's name of the track.
    """
    try:
        world = machines.find(run_parts(rig).plant).world(spec_of(rig), rig.plant, seed, can_wire)
    except UnknownQuantityError as error:
        raise InvalidSource([Problem("rig file", 1, 1, f"devices: {error}")]) from error
    if world.by_surface:
        world.take(law_setting(surface, recipe))
    if log is not None:
        log.watch(world.can, world.lines)
    return Ports(world.can, dict(world.lines)), world, world


def spec_of(rig: Rig) -> RigSpec:
    """Return the wiring that a rig file describes."""
    held_s: float = getattr(rig.plant, "latency_timer", 0.0)  # a kind may lack it
    closed = frozenset(one.channel for one in rig.safety_inputs.values())
    return RigSpec(
        bitrate=rig.can.bitrate,
        axes=rig.drives(),
        lines={name: _line(line, held_s) for name, line in rig.lines.items()},
        devices={name: _device(config, closed) for name, config in rig.devices.items()},
        nodes=tuple(_node(node, closed) for node in rig.can.nodes.values()),
        further=tuple(further_sensors(rig)),
        inputs=closed,
        shares={name: ShareSpec(share.shared, share.members) for name, share in shares_of(rig).items()},
    )


def _line(config: LineConfig, held_s: float) -> LineSpec:
    return LineSpec(config.baud, byte_bits(config.framing, config.parity, config.stop_bits), held_s)


def _device(config: DeviceConfig, closed: Container[str]) -> DeviceSpec:
    """Return a device's wiring; ``closed``: channels of safety inputs, which show a closed contact unless stated."""
    profile = profile_of(config.profile)
    shows = {name: CLOSED for name in profile.channels if config.channels.get(name, name) in closed}
    return DeviceSpec(
        profile, config.line, config.unit_id, {**shows, **config.simulated}, config.part_of, config.channels
    )


def _node(node: NodeConfig, closed: Container[str]) -> NodeConfig:
    """Return a node whose safety inputs are closed."""
    channels = {
        name: replace(channel, simulated=CLOSED) if name in closed else channel
        for name, channel in node.channels.items()
    }
    return replace(node, channels=channels)


Truth = Callable[[Mapping[str, float]], Mapping[str, float]]
"""Function that takes setpoints by axis and returns the true values of the present repeat."""


def truth_of(world: Any, plant: Any) -> Truth | None:
    """Return the function for a simulated rig's true values; None if they are not requested or not available."""
    return getattr(world, "truth", None) if getattr(plant, "record_truth", False) else None


class Witnessed:
    """The attendant of a simulated rig, which also records the true values whenever a repeat begins."""

    def __init__(self, attendant: Any, truth: Truth, plan: Plan, recorder: Recorder) -> None:
        """``plan``: of this part of the run; a row of the table is one condition."""
        self._attendant = attendant
        self._truth = truth
        self._recorder = recorder
        self._steps = {step.row: step for step in plan.conditions()}

    def __getattr__(self, name: str) -> Any:
        """Return any other method of the attendant."""
        return getattr(self._attendant, name)

    def begin_repeat(self, row: int, repeat: int, attempt: int, *more: Mapping[str, float]) -> None:
        """Begin a repeat at the rig, and record its true values; ``more``: further arguments that the kind defines."""
        self._attendant.begin_repeat(row, repeat, attempt, *more)
        step = self._steps.get(row)
        if step is not None:
            self._recorder.truth(step.condition, repeat, attempt, self._truth(step.setpoint.numbers()))
