"""A rig with untested scales: connected, with every drive off except the drive that a person jogs.

This comes before arming, and so before the interlock table: most of its rows depend on scales. The checks are those of
the connection before every run (tester.machine.connect), and the load cell must stay constant. Two bounds need no
scale: a jog lasts at most ``PRESS_S`` for each key press, and the drive has only a share of its torque.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import copysign, hypot, inf
from typing import Any, Final

from drivers.axis import AxisConfig
from drivers.cia402 import Goal, State
from drivers.servo import ServoDrive
from tester.inputs.rig import Rig
from tester.kinds.wheel_on_belt.image.devices import Devices
from tester.kinds.wheel_on_belt.procedures.arming import WheelArming
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.connect import Connector, Lifting, Stage
from tester.machine.devices import INPUT_GUARD, INPUT_SAFETY_CHAIN
from tester.machine.proof import ENABLE_S
from tester.machine.rig_ports import Ports

PRESS_S: Final = 2.0
"""Longest motion for a key press, s [A]: a terminal cannot detect a released key."""
STILL_S: Final = 1.0
"""Time for a jogged axis to come to rest, s [A]: the ramp from creep takes 25 ms."""
TORQUE_SHARE: Final = 0.3
"""Share of the rated torque for a jog [A]: bearings and inertia of this machine's axes take a tenth of it."""
PRESS_LOAD_N: Final = 60.0
"""Load that the press must still be able to produce, N [A]: its spring pulls back with 40 N."""

RELAY: Final = {name: f"; by a standstill relay: the scale of the {name} axis is wrong" for name in ("wheel", "belt")}
"""Why a jogged drive loses its torque: the relay acts from 0.1 m/s on, twice the speed of a jog at the right scale."""


@dataclass(frozen=True, slots=True)
class JogSpeeds:
    """Speeds and ways of the first, short jog and of the measured jog, in the axis's units.

    The first speed is at most a tenth of 250 mm/s, the reduced speed near a person (ISO 10218-1): even a scale that is
    wrong by a factor of ten does not exceed 250 mm/s.
    """

    first: float
    first_way: float
    speed: float
    way: float


def jog_rig(rig: RigConfig, speeds: dict[str, JogSpeeds]) -> RigConfig:
    """Return a rig with little torque in its drives and with slow positioned axes."""
    axes: dict[str, AxisConfig | None] = {}
    for name, axis in rig.axes.driven().items():
        most = min(axis.max_torque_per_mille, round(1000 * TORQUE_SHARE))
        if name == "press" and axis.screw is not None:
            needed = 1000.0 * axis.screw.torque_nm(PRESS_LOAD_N) / axis.rated_torque_nm
            most = min(axis.max_torque_per_mille, max(1, round(needed)))
        slow = replace(axis, max_torque_per_mille=most)
        if axis.mode == "position":
            most_speed = min(axis.max_speed, speeds[name].speed)
            homing = {key: min(getattr(axis, key), most_speed) for key in ("homing_speed", "homing_zero_speed")}
            slow = replace(slow, max_speed=most_speed, **homing)
        axes[name] = slow
    return replace(rig, axes=replace(rig.axes, **axes))


@dataclass(slots=True)
class JogMove:
    """Motion for one key press: an axis moves ``way`` (signed, its unit) at ``speed``, for at most ``most_s``."""

    axis: str
    way: float
    speed: float
    most_s: float = PRESS_S  # longer once the scale is known
    holds: bool = False  # keeps its power at rest: a spring would move an unpowered press
    moved: float = 0.0  # as the drive itself reports it
    over: bool = False
    read: bool = False
    """The way was read while the axis was held: a spring that takes it back changes nothing."""


class Moving(Lifting):
    """Moves axes in place of a run's lift, as long as the seat is in use: it is never done."""

    done = False
    stepped_s = 0.0
    """Time of the last step, s."""

    @property
    def powered(self) -> bool:
        """Whether a drive has power, or is about to."""
        raise NotImplementedError

    @property
    def provokes(self) -> bool:
        """Whether drives are deliberately made to stop by themselves."""
        return False


class Jogging(Moving):
    """Moves one axis at a key press."""

    def __init__(self, devices: Devices, rig: RigConfig) -> None:
        """Move nothing before a jog begins."""
        self.devices = devices
        self.rig = rig
        self.jog: JogMove | None = None
        self._earlier = self._marked = 0.0
        """Way from the mark to the present jog (velocity feedback), and the position at the mark (position)."""
        self._drives: dict[str, ServoDrive] = {drive.config.name: drive for drive in devices.drives}
        self._phase = ""
        self._since_s = self._last_s = self._from = 0.0
        self._rest: tuple[float, ...] = ()
        """Readings of the cell before the jog."""

    @property
    def powered(self) -> bool:
        """Whether a drive has power, or is about to."""
        return (self.jog is not None and not self.jog.over) or has_power(self.devices)

    def begin(self, axis: str, way: float, speed: float, *, holds: bool = False, most_s: float = PRESS_S) -> JogMove:
        """Begin a jog."""
        self._earlier = self.moved
        self.jog = JogMove(axis, way, speed, most_s, holds)
        self._enter("enable", inf)
        self._rest = tuple(self.devices.cell.raw)
        return self.jog

    @property
    def moved(self) -> float:
        """Way in all since the mark, as the drive reports it, in the axis's unit; as it was read, once it was."""
        jog = self.jog
        if jog is None:
            return 0.0
        drive = self._drives[jog.axis]
        if jog.read or drive.config.feedback != "position":
            return self._earlier + jog.moved
        return drive.actual - self._marked

    def mark(self, axis: str) -> None:
        """Count an axis' way from here: where it stands at first, or where the person sets the instrument to zero."""
        self._earlier = -(self.jog.moved if self.jog is not None else 0.0)
        self._marked = self._drives[axis].actual

    def drive(self, axis: str) -> ServoDrive:
        """Return an axis's drive."""
        return self._drives[axis]

    def rest(self) -> JogMove | None:
        """Switch off an axis that was holding; return its finished jog once it is off."""
        jog = self.jog
        if jog is not None and jog.over and jog.holds:
            self._earlier, jog.moved = 0.0, self.moved
            jog.holds = jog.over = False
            jog.read = True
            self._enter("still", -inf)
        return jog

    def step(self, now: float) -> None:
        """Advance by one tick at ``now`` s."""
        self.stepped_s = now
        jog = self.jog
        if jog is None or jog.over or self.failure:
            return
        if self._since_s == inf:
            self._since_s = self._last_s = now
        drive, elapsed, dt = self._drives[jog.axis], now - self._since_s, now - self._last_s
        self._last_s = now
        by_position = drive.config.feedback == "position"
        if self._phase == "enable":
            drive.goal = Goal.ENABLED
            if drive.state is State.OPERATION_ENABLED:
                self._from = drive.actual
                self._command(drive, jog, now)
                self._enter("move", now)
            elif elapsed > ENABLE_S:
                self.failure = f"the {jog.axis} drive is not enabled after {ENABLE_S:g} s"
            return
        if drive.state is not State.OPERATION_ENABLED and self._phase != "off":
            self.failure = f"the {jog.axis} drive left operation while it was jogged{RELAY.get(jog.axis, '')}"
            return
        if not jog.read:
            jog.moved = drive.actual - self._from if by_position else jog.moved + drive.actual * dt
        if self._phase == "move":
            if self._arrived(drive, jog) or elapsed >= jog.most_s:
                self._halt(drive)
                self._enter("still", now)
        elif self._phase == "still":
            if elapsed >= STILL_S and jog.holds:
                jog.over = True
            elif elapsed >= STILL_S:
                drive.goal = Goal.DISABLED
                self._enter("off", now)
        elif drive.state <= State.READY_TO_SWITCH_ON or elapsed > ENABLE_S:
            jog.over = True

    def _enter(self, phase: str, now: float) -> None:
        self._phase, self._since_s = phase, now

    def _command(self, drive: ServoDrive, jog: JogMove, now: float) -> None:
        if drive.config.mode == "position":
            most = jog.speed * PRESS_S
            drive.target = drive.actual + max(-most, min(jog.way, most))
        else:
            drive.target = copysign(jog.speed, jog.way)

    def _arrived(self, drive: ServoDrive, jog: JogMove) -> bool:
        if drive.config.mode == "position":
            return drive.reached()
        ramp = 0.5 * jog.speed * jog.speed / drive.config.deceleration  # way of the ramp after the stop command
        return abs(jog.moved) + ramp >= abs(jog.way)

    def _halt(self, drive: ServoDrive) -> None:
        if drive.config.mode == "velocity":
            drive.target = 0.0
        elif not drive.reached():
            drive.target = drive.actual

    def trouble(self, now: float) -> str:
        """Return the reason to stop all motion, "" for none; also "" if nothing has power."""
        if not self.powered:
            return ""
        cell, bounds = self.devices.cell, self.rig.interlocks
        if not (cell.valid and now - cell.stamp_s <= bounds.stale_cell_s + bounds.stale_cell_delay_s):
            return "load cell silent: a touching wheel would go unnoticed"
        if not self._rest:
            return ""
        x, y, z = (cell.raw[i] - self._rest[i] for i in range(3))
        most = self.rig.arming.unloaded_n
        if hypot(x, y) <= most and abs(z) <= most:
            return ""
        return (
            f"the load cell has changed by Fz {z:.0f} N, friction {hypot(x, y):.0f} N while an axis was jogged"
            f" (at most {most:g} N, arming.unloaded): the wheel touches, or something is in the way"
        )

    def stop(self) -> None:
        """Stop everything; power off."""
        for drive in self.devices.drives:
            if drive.connected:
                if drive.config.mode == "velocity":
                    drive.target = 0.0
                drive.goal = Goal.DISABLED
        if self.jog is not None:
            self.jog.over = True


def has_power(devices: Devices) -> bool:
    """Return whether a drive has power."""
    return any(drive.state > State.READY_TO_SWITCH_ON for drive in devices.drives if drive.connected)


class QuietArming(WheelArming):
    """Arming as before every run, but without power the guard may be open, so that a person can read a ruler."""

    def __init__(self, devices: Devices, rig: RigConfig, moving: Moving) -> None:
        """``moving``: jogs or trials, in place of a run's lift."""
        super().__init__(devices, rig)
        self.moving = moving
        self.renews = True
        """The jacket's lease is renewed, unless the lease is being tried."""

    def unfit(self, now: float, configured_s: float) -> str:
        reason = super().unfit(now, configured_s)
        return reason if self.moving.powered or reason not in ("safety chain", "guard open") else ""

    def renew(self) -> None:
        if self.renews:
            super().renew()

    def lift(self) -> Any:
        return self.moving


class QuietConnector(Connector):
    """Connects, waits for the devices, and stays there: no homing, no proof."""

    timeout_s = inf

    def __init__(self, devices: Devices, rig: RigConfig, arming: QuietArming) -> None:
        """Send nothing."""
        super().__init__(devices, rig, arming, rig.arming.listen_s)
        self._moving = arming.moving

    @property
    def watches_drives(self) -> bool:
        return super().watches_drives and not self._moving.provokes

    def _lift(self, lifting: Any, now: float) -> None:
        lifting.step(now)
        if lifting.failure:
            self._fail(lifting.failure)


class QuietSeat:
    """The rig during the first steps (tester.machine.commission.commission_step.Seat)."""

    def __init__(self, rig: RigConfig, believed: RigConfig, devices: Devices, moving: Moving) -> None:
        """Connect. ``believed``: the rig file's rig; ``rig``: the rig with the drives' bounds (``jog_rig``)."""
        self.rig, self.believed, self.devices, self.moving = rig, believed, devices, moving
        self.arming = QuietArming(devices, rig, moving)
        self.connector = QuietConnector(devices, rig, self.arming)

    @property
    def ready(self) -> bool:
        """Whether every device is connected and answers."""
        return self.connector.stage is Stage.LIFT

    @property
    def finished(self) -> bool:
        """Whether everything is released."""
        return self.connector.finished

    @property
    def reason(self) -> str:
        """Reason for an unrequested end; "" after ``stop``."""
        return self.connector.failure

    def guarded(self) -> bool:
        """Return whether guard and safety chain are closed."""
        closed = INPUT_GUARD | INPUT_SAFETY_CHAIN
        return self.devices.axes.press.inputs & closed == closed

    def tick(self, now: float) -> float:
        """Advance the rig by one tick."""
        return self.connector.tick(now)

    def stop(self, why: str, *, fast: bool = False) -> None:
        """Stop, and release the drives."""
        self.connector.abort("")

    def abandon(self) -> None:
        """Send zero and power off once."""
        self.moving.stop()
        self.devices.transmit(self.moving.stepped_s, scan=True)


class JogSeat(QuietSeat):
    """The rig while a person jogs its axes, one at a time, with the drives bounded (``jog_rig``)."""

    def __init__(self, speeds: dict[str, JogSpeeds], rig: Rig, ports: Ports, hands: Any) -> None:
        """Connect."""
        believed = RigConfig.of(rig)
        bounded = jog_rig(believed, speeds)
        devices = Devices(bounded, ports)
        self.jogging = Jogging(devices, bounded)
        super().__init__(bounded, believed, devices, self.jogging)
