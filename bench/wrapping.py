"""Wraps the entry points of a scan's parts during a measurement."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from bench.ledger import Ledger

ENTRY_POINTS: tuple[tuple[str, str, str, tuple[str, ...]], ...] = (
    ("twin", "sim.rig", "SimRig", ("advance",)),
    ("plant", "sim.machines.wheel_on_belt.plant", "Plant",
     ("advance", "forces_measured", "surface_measured_c", "controller_measured_c")),
    ("nodes: drives", "sim.nodes.cia402_slave", "Cia402Slave", ("advance", "move")),
    ("nodes: Modbus slaves", "sim.nodes.controller_slave", "ControllerSlave", ("advance",)),
    ("nodes: Modbus slaves", "sim.nodes.modbus_slave", "ModbusSlave", ("answer",)),
    ("bus: CAN", "sim.wires.can_wire", "CanWire", ("send", "send_cycle", "receive", "transmit")),
    ("bus: Modbus", "sim.wires.modbus_wire", "ModbusWire", ("write", "read")),
    ("drivers: receive", "tester.machine.devices", "DeviceList", ("receive",)),
    ("drivers: image", "tester.kinds.wheel_on_belt.image.devices", "Devices", ("fill",)),
    ("drivers: apply", "tester.kinds.wheel_on_belt.image.devices", "Devices", ("apply",)),
    ("drivers: transmit", "tester.machine.devices", "DeviceList", ("transmit",)),
    ("control", "tester.machine.control", "Control", ("step",)),
    ("executor", "tester.machine.executor", "Executor", ("step",)),
    ("executor", "tester.kinds.wheel_on_belt.procedures.gates", "Gates", ("update",)),
    ("recorder", "tester.machine.sampler", "Sampler", ("record",)),
    ("engine", "tester.machine.run", "Run", ("tick",)),
)
"""Part, module, class, methods. Nodes that listen on CAN are wrapped where they subscribe."""


@contextmanager
def wrapped(ledger: Ledger) -> Generator[list[str], None, None]:
    """Wrap all entry points; yield those that no longer exist. A rig must be built inside the block."""
    undo: list[tuple[type, str, object]] = []
    missing: list[str] = []

    def replace(owner: type, name: str, made: Callable[[Any], object]) -> None:
        bare = owner.__dict__.get(name)
        if bare is None:
            missing.append(f"{owner.__name__}.{name}")
            return
        undo.append((owner, name, bare))
        setattr(owner, name, made(bare))

    try:
        for part, module, class_name, methods in ENTRY_POINTS:
            owner = getattr(import_module(module), class_name, None)
            if owner is None:
                missing.append(f"{module}.{class_name}")
                continue
            for method in methods:
                replace(owner, method, lambda bare, part=part: ledger.wrap(part, bare))
        wire: type = import_module("sim.wires.can_listeners").CanListeners
        known: dict[object, Callable[..., Any]] = {}
        replace(wire, "listen", lambda bare: _subscribing(ledger, bare, known))
        replace(wire, "forget", lambda bare: _leaving(bare, known))
        yield missing
    finally:
        for owner, name, bare in reversed(undo):
            setattr(owner, name, bare)


def _subscribing(
    ledger: Ledger, listen: Callable[..., Any], known: dict[object, Callable[..., Any]]
) -> Callable[..., None]:
    """Return a ``CanListeners.listen`` that subscribes the measured listener in place of the bare one."""

    def subscribe(wire: object, can_id: int, listener: Callable[..., Any], *rest: Any, **named: Any) -> None:
        if listener not in known:
            known[listener] = ledger.wrap("nodes: drives, on a frame", listener)
        listen(wire, can_id, known[listener], *rest, **named)

    return subscribe


def _leaving(forget: Callable[..., Any], known: dict[object, Callable[..., Any]]) -> Callable[..., None]:
    """Return a ``CanListeners.forget`` that maps a bare listener to its measured one."""

    def leave(wire: object, can_id: int, listener: Callable[..., Any]) -> None:
        forget(wire, can_id, known.get(listener, listener))

    return leave
