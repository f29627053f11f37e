"""Moves one axis of a rig with untested scales at a key press: slowly, a short way, with little torque."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import copysign, inf
from typing import Final

from drivers.axis import AxisConfig
from drivers.cia402 import Goal, State
from drivers.joined_cell import LoadCell
from drivers.servo import ServoDrive
from tester.machine.connect import Lifting
from tester.machine.devices import INPUT_SAFETY_CHAIN, DeviceList
from tester.machine.proof import ENABLE_S

PRESS_S: Final = 2.0
"""Longest motion for a key press, s [A]: a terminal cannot detect a released key."""
STILL_S: Final = 1.0
"""Time for a jogged axis to come to rest, s [A]: the ramp from creep takes 25 ms."""
TORQUE_SHARE: Final = 0.3
"""Share of the rated torque for a jog [A]: bearings and inertia of these machines' axes take a tenth of it."""


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


def slowed(axis: AxisConfig, speeds: JogSpeeds, most_per_mille: int) -> AxisConfig:
    """Return an axis with at most this torque, per mille of its rated torque; a positioned axis also has jog speed."""
    slow = replace(axis, max_torque_per_mille=min(axis.max_torque_per_mille, most_per_mille))
    if axis.mode != "position":
        return slow
    most_speed = min(axis.max_speed, speeds.speed)
    homing = {key: min(getattr(axis, key), most_speed) for key in ("homing_speed", "homing_zero_speed")}
    return replace(slow, max_speed=most_speed, **homing)


@dataclass(frozen=True, slots=True)
class CellWatch:
    """How a kind's load cell shows that a jogged axis meets something."""

    cell: LoadCell
    silent_s: float
    """Longest time without a valid reading, s."""
    touches: Callable[[Sequence[float]], str]
    """Returns the alarm for a change of the raw channels since the jog began, N; "" for none."""


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
    opens: bool = False
    """The safety chain may open during this move, which then ends it (an end switch)."""
    opened: bool = False
    """The safety chain has opened."""


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

    @property
    def chain_may_open(self) -> bool:
        """Whether an open safety chain is part of the step."""
        return False


class Jogging(Moving):
    """Moves one axis at a key press."""

    def __init__(
        self, devices: DeviceList, watch: CellWatch, left_because: Mapping[str, str] | None = None
    ) -> None:
        """Move nothing before a jog begins. ``left_because``: by axis, why its drive may leave operation by itself."""
        self.devices = devices
        self.watch = watch
        self._left_because = left_because or {}
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

    @property
    def chain_may_open(self) -> bool:
        # A switch that ended the move stays open: the step that asked for it then refuses.
        return self.jog is not None and self.jog.opens and (self.jog.opened or not self.jog.over)

    def begin(
        self, axis: str, way: float, speed: float, *, holds: bool = False, most_s: float = PRESS_S, opens: bool = False
    ) -> JogMove:
        """Begin a jog."""
        self._earlier = self.moved
        self.jog = JogMove(axis, way, speed, most_s, holds, opens=opens)
        self._enter("enable", inf)
        self._rest = tuple(self.watch.cell.raw)
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
        if jog.opens and not self.devices.io.inputs & INPUT_SAFETY_CHAIN:
            self._open(drive, jog, by_position=by_position)
            return
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
            because = self._left_because.get(jog.axis, "")
            self.failure = f"the {jog.axis} drive left operation while it was jogged{because}"
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

    def _open(self, drive: ServoDrive, jog: JogMove, *, by_position: bool) -> None:
        """End a move at an end switch, power off."""
        if by_position:
            jog.moved = drive.actual - self._from
        drive.target = drive.actual if drive.config.mode == "position" else 0.0
        drive.goal = Goal.DISABLED
        jog.over = jog.opened = True

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
        cell = self.watch.cell
        if not (cell.valid and now - cell.stamp_s <= self.watch.silent_s):
            return "load cell silent: whether the specimen touches is unknown"
        if not self._rest:
            return ""
        return self.watch.touches([now_n - rest_n for now_n, rest_n in zip(cell.raw, self._rest, strict=True)])

    def stop(self) -> None:
        """Stop everything; power off."""
        for drive in self.devices.drives:
            if drive.connected:
                if drive.config.mode == "velocity":
                    drive.target = 0.0
                drive.goal = Goal.DISABLED
        if self.jog is not None:
            self.jog.over = True


def has_power(devices: DeviceList) -> bool:
    """Return whether a drive has power."""
    return any(drive.state > State.READY_TO_SWITCH_ON for drive in devices.drives if drive.connected)
