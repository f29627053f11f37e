"""Commands to a drive (goal, target, halt, fault reset, homing start), and the RPDO1 that carries them."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from math import floor
from typing import Final

from drivers import cia402
from drivers.axis import AxisConfig
from drivers.canopen.node import CanNode
from drivers.cia402 import Goal, State

# Two layouts (drivers.canopen.pdo): controlword, and 32 bits of target velocity or position, or an inverter's 16.
_RPDO1: Final = struct.Struct("<Hi").pack
_RPDO1_INVERTER: Final = struct.Struct("<Hh").pack
_INF: Final = math.inf
_MOST: Final = math.nextafter(math.inf, 0.0)     # limits are finite, so no target beyond them is missed
_I32_MAX: Final = 0x7FFF_FFFF
_IO_MAX: Final = 0xFFFF_FFFF
_RETARGETED: Final = 2
"""Value of ``dirty`` while nothing but the target is new: every other change sets it to True."""

# Members bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_DISABLED: Final = Goal.DISABLED
_ENABLED: Final = Goal.ENABLED
_QUICK_STOP: Final = Goal.QUICK_STOP
_FREE: Final = Goal.FREE
_OPERATING: Final = State.OPERATION_ENABLED
_TARGET_REACHED: Final = cia402.TARGET_REACHED

_STOPPED_BY_ITSELF: Final = frozenset(
    (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE, State.FAULT_REACTION, State.FAULT))
"""If a drive falls from one of these states to a lower one while the goal is ENABLED, it is not enabled again by
itself."""


class AxisCommand(CanNode):
    """The command side of a drive: composes RPDO1 from the commands and from the last statusword.

    The bytes are composed again only when something they depend on has changed.
    ``aimed`` is the last target that was set, NaN when it has to be set again. ``news`` is set with
    every change of the drive's known state; the reader clears it.
    ``inhibited``: the drive left operation, or a fault, while the goal was ENABLED; another goal must be set
    before ENABLED counts again, so that nothing restarts by itself.
    """

    __slots__ = ("_at_rest", "_goal", "_halt", "_high", "_homing", "_homing_start", "_low", "_motion_bits",
                 "_new_set_point", "_outputs", "_pack", "_per_unit", "_position_mode", "_raw", "_remote_bit",
                 "_resetting", "_rpdo", "_set_point", "_target", "_target_counts", "_word", "aimed", "config",
                 "homing_scans", "inhibited", "news", "state", "statusword")

    def __init__(self, config: AxisConfig) -> None:
        super().__init__(config.name, config.node_id, config.heartbeat_s, config.digital_io)
        self.config = config
        self._position_mode = config.mode == "position"
        inverter = config.drive.inverter
        self._pack: Callable[[int, int], bytes] = _RPDO1_INVERTER if inverter else _RPDO1
        self._motion_bits: int = cia402.RAMP if inverter else 0
        self._remote_bit = cia402.REMOTE if config.drive.remote else 0
        self._per_unit = config.position_increments if self._position_mode else config.velocity_increments
        reach = _I32_MAX / self._per_unit
        limits = config.software_limits if self._position_mode else (-config.max_speed, config.max_speed)
        low, high = limits or (-reach, reach)
        self._low, self._high = max(low, -_MOST), min(high, _MOST)
        self.clear_commands()

    def clear_commands(self) -> None:
        """Reset every command, and all that is known of the device's state."""
        self.state = State.NOT_READY
        self.statusword: int = 0
        self.connected = False
        self.lost = False
        self.inhibited = False
        self.homing_scans = 0
        self._raw: int = 0               # TPDO1's field, counts
        self._goal = Goal.DISABLED
        self._halt = False
        self._outputs = 0
        self._target = 0.0
        self._target_counts: int = 0
        self.aimed = math.nan
        self.news = True
        self._at_rest = True             # not following the target
        self._new_set_point = False      # controlword bit 4 is up
        self._set_point: int = 0         # position sent last with bit 4, counts
        self._resetting = False
        self._homing = False
        self._homing_start = False
        self._rpdo: bytes | None = None
        self._word: int = -1             # controlword of the last RPDO1 if that only adds the target, -1 if not
        self.dirty = True

    @property
    def target(self) -> float:
        """Commanded speed or position, ``config.unit``; clamped to max_speed or the software limits.

        It is sent only while the drive reports OPERATION_ENABLED. Before that the drive gets 0, in position mode the
        actual position. Setting NaN or an infinity raises ValueError and changes nothing.
        """
        return self._target

    @target.setter
    def target(self, value: float) -> None:
        self.aim(value)

    def aim(self, value: float) -> None:
        """Set ``target``; an unchanged value costs a comparison (compare ``aimed`` first to save even the call)."""
        if value == self.aimed:
            return
        aimed = value
        if not self._low <= value <= self._high:
            if not -_INF < value < _INF:
                raise ValueError(f"{self.config.name}: target {value} is not a number")
            value = self._low if value < self._low else self._high
        self.aimed = aimed
        self._target = value
        counts = floor(value * self._per_unit + 0.5)
        if counts != self._target_counts:
            self._target_counts = counts
            if not self.dirty:
                self.dirty = _RETARGETED

    @property
    def goal(self) -> Goal:
        """Commanded power state: a level, reached one transition per scan."""
        return self._goal

    @goal.setter
    def goal(self, goal: Goal) -> None:
        if goal is self._goal and not self.inhibited:
            return
        self._goal = goal
        if goal is not Goal.ENABLED:
            self.inhibited = False
        self.dirty = True

    @property
    def halt(self) -> bool:
        """Whether an enabled axis is to pause (controlword bit 8, 0x605D): it ramps down and stays enabled."""
        return self._halt

    @halt.setter
    def halt(self, halt: bool) -> None:
        if halt is not self._halt:
            self._halt = halt
            self.dirty = True

    @property
    def outputs(self) -> int:
        """Commanded digital outputs, bits of 0x60FE:01; sent with the next scan after a change."""
        return self._outputs

    @outputs.setter
    def outputs(self, bits: int) -> None:
        if not 0 <= bits <= _IO_MAX:
            raise ValueError(f"{self.config.name}: outputs {bits:#x} do not fit 32 bits")
        self._outputs = bits

    def reached(self) -> bool:
        """Return whether the drive reports its target reached (bit 10).

        In position mode the bit counts only for the present target. A velocity has no
        handshake: for two scans after a change the bit still belongs to the target before.
        """
        if self._at_rest or not self.statusword & _TARGET_REACHED:
            return False
        return not self._position_mode or (not self._new_set_point and self._set_point == self._target_counts)

    @property
    def remote(self) -> bool:
        """Whether the drive obeys the bus (bit 9, where its make has it); without it the axis is not enabled."""
        return self.statusword & self._remote_bit == self._remote_bit

    def emit(self, sync: bool) -> bytes | None:
        """Return RPDO1 for this scan, None while there is nothing to command; ``sync``: a SYNC follows."""
        if self.dirty == _RETARGETED and self._word >= 0:
            self.dirty = False
            pack = self._pack  # an attribute that is called as a method is looked up anew (CPython 3.11)
            self._rpdo = pack(self._word, self._target_counts)
        elif self.dirty:
            self._compose()
        rpdo = self._rpdo
        if self._resetting and sync:        # a synchronous RPDO acts at the SYNC: the drive has seen the edge
            self._resetting = False
            self.dirty = True
        return rpdo

    def set_homing(self, active: bool, start: bool = False) -> None:
        """Set whether the device is in homing mode, and whether to start homing (controlword bit 4).

        ``homing_scans`` counts the scans sent with the start bit.
        """
        self._homing = active
        self._homing_start = start
        self.homing_scans = 0
        self.dirty = True

    def take_statusword(self, statusword: int) -> None:
        """Act on a statusword that differs from the last one."""
        state = cia402.decode(statusword)
        previous = self.state
        if state is not previous or (statusword ^ self.statusword) & cia402.REMOTE:
            self.state = state
            self.news = True
            if (state is not previous and self._goal is Goal.ENABLED and previous in _STOPPED_BY_ITSELF
                    and state is not State.OPERATION_ENABLED):
                self.inhibited = True
        self.statusword = statusword
        self.dirty = True

    def _request_reset(self) -> None:
        """Raise controlword bit 7 once, up to the next SYNC; the drive then stays disabled."""
        self.inhibited = True
        self._resetting = True
        self.dirty = self.news = True

    def _hold_still(self, raw: int) -> None:
        """Make the present position (counts), or standstill, the target."""
        self._raw = raw
        self._target_counts = raw if self._position_mode else 0
        self._target = raw / self._per_unit if self._position_mode else 0.0
        self.aimed = math.nan
        self.dirty = True

    def _compose(self) -> None:
        """Compose RPDO1 from the goal, the target and the last statusword."""
        self.dirty = False
        self._word = -1
        if not self.connected:
            self._rpdo = None
            return
        goal = self._goal
        if self.lost and goal is not _FREE:
            goal = _QUICK_STOP
        remote = self._remote_bit
        if goal is _ENABLED and (self.inhibited or self.statusword & remote != remote):
            goal = _DISABLED
        word = cia402.controlword(self.state, goal)
        if self._resetting:
            if self.state is State.FAULT:
                word |= cia402.FAULT_RESET
            else:
                self._resetting = False      # the drive has left FAULT
        if goal is _ENABLED and self.state is _OPERATING:
            self._rpdo = self._compose_motion(word | cia402.HALT if self._halt else word)
            return
        self._at_rest = True
        self._rpdo = self._pack(word, self._raw if self._position_mode else 0)

    def _compose_motion(self, word: int) -> bytes:
        """Return RPDO1 of an axis in operation."""
        if self._homing:
            if self._homing_start:
                word |= cia402.HOMING_START
                self.homing_scans += 1
                self.dirty = True           # count every scan
            return _RPDO1(word, self._raw if self._position_mode else 0)
        if not self._position_mode:
            self._at_rest = False
            self._word = word = word | self._motion_bits
            return self._pack(word, self._target_counts)
        if self._at_rest:
            self._at_rest = False
            self._new_set_point = False
            self._set_point = self._raw      # first hold the axis where it is
        acknowledged = self.statusword & cia402.SET_POINT_ACKNOWLEDGED != 0
        if self._new_set_point:
            self._new_set_point = not acknowledged
        elif not acknowledged and self._target_counts != self._set_point:
            self._new_set_point = True
            self._set_point = self._target_counts
        word |= cia402.CHANGE_IMMEDIATELY
        if self._new_set_point:
            word |= cia402.NEW_SET_POINT
        return _RPDO1(word, self._set_point)
