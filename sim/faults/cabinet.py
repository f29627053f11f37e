"""Faults of the control cabinet: contactor, safety chain and guard, the computer and its operator."""

from __future__ import annotations

from collections.abc import Callable

from sim.faults.scene import ControlComputer, Effect, Scene, switched
from sim.nodes.safety_io import SafetyIo


def io_of(scene: Scene) -> SafetyIo:
    """Return the inputs and outputs at the drive that has them. Raises LookupError if no drive has them."""
    for drive in scene.rig.axes.values():
        if drive.io is not None:
            return drive.io
    raise LookupError("no drive of this rig has digital inputs")


@switched
def contactor_welded(scene: Scene, on: bool, now: float) -> None:
    """The contactor's contacts are welded: once closed it stays closed, until they break loose."""
    if on:
        io_of(scene).welded = True
    else:
        io_of(scene).release(now)
        _reschedule(scene)


@switched
def contactor_dead(scene: Scene, on: bool, now: float) -> None:
    """The contactor's coil is open: it drops out and does not pull in again."""
    io_of(scene).break_coil(on, now)
    _reschedule(scene)


@switched
def chain_open(scene: Scene, on: bool, now: float) -> None:
    """The safety chain opens at its input: a broken wire, without a button pressed."""
    _set_chain(scene, not on)


@switched
def emergency_stop(scene: Scene, on: bool, now: float, stopped: tuple[str, ...]) -> None:
    """The emergency stop is pressed: the chain opens, and the ``stopped`` drives lose torque at once (category 0)."""
    _set_chain(scene, not on)
    for name in stopped:
        scene.rig.axes[name].set_torque_off(on)


@switched
def guard_open(scene: Scene, on: bool, now: float) -> None:
    """The guard is open."""
    for drive in scene.rig.axes.values():
        drive.set_guard(not on)


def _set_chain(scene: Scene, healthy: bool) -> None:
    for drive in scene.rig.axes.values():
        drive.set_safety_chain(healthy)
    _reschedule(scene)


def _reschedule(scene: Scene) -> None:
    """Make the drives read the contactor's new time."""
    for drive in scene.rig.axes.values():
        if drive.io is not None:
            drive.reschedule()


class OfComputer(Effect):
    """An event, once, in the controlling process, or a request of its operator."""

    def __init__(self, act: Callable[[ControlComputer], None]) -> None:
        self._act = act

    def begin(self, scene: Scene, now: float) -> None:
        """Cause the event."""
        self._act(scene.computer)


def stalled(seconds: float) -> OfComputer:
    """The controlling process gets no processor for this time, s."""
    return OfComputer(lambda computer: computer.stall(seconds))


def killed() -> OfComputer:
    """The controlling process is killed: no scan ever again."""
    return OfComputer(lambda computer: computer.kill())


def clock_jump(seconds: float) -> OfComputer:
    """The computer's clock jumps ahead by this time, s, as after a suspend."""
    return OfComputer(lambda computer: computer.jump(seconds))


def operator(action: str) -> OfComputer:
    """The operator asks for "hold", "release", "abort", "stop" or "fast stop"."""
    return OfComputer(lambda computer: computer.operate(action))
