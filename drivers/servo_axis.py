"""A servo drive's readings and commands: engineering units in, CAN bytes out, and back."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from typing import Final

from drivers import cia402
from drivers.axis import AxisConfig, DeviceIdentity, Diagnosis
from drivers.axis_command import AxisCommand
from drivers.canopen import objects as o
from drivers.canopen.conversation import AwaitedCondition
from drivers.canopen.heartbeat import HeartbeatMonitor
from drivers.canopen.messages import Emergency, decode_emergency
from drivers.cia402 import Goal, State
from drivers.drive_settings import DrivePlan

# Layouts (drivers.canopen.pdo): statusword, velocity or position, torque; an inverter's velocity has 16 bits.
_TPDO1: Final = struct.Struct("<Hih").unpack
_INVERTER_UNPACK: Final = struct.Struct("<Hhh").unpack
_IO_PACK: Final = struct.Struct("<I").pack
_IO_UNPACK: Final = struct.Struct("<I").unpack
_IO_SIZE: Final = 4
_STATUS_UNPACK: Final = struct.Struct("<H").unpack
_STATUS_SIZE: Final = 2
_MAX_EMERGENCIES: Final = 64     # kept between two calls of take_emergencies, for the journal
OUTPUTS_AGAIN_S: Final = 0.1       # RPDO2 is sent again until its effect shows: a frame may be lost [A]
_HOMING_SCANS: Final = 3         # until the statusword surely answers the start bit: sent, sampled, reported
_HOMED: Final = cia402.HOMING_ATTAINED | cia402.TARGET_REACHED


def _no_torque(data: bytes) -> tuple[int, int, int]:
    """Return the fields of an inverter that reports no torque, with a torque of 0 counts."""
    fields: tuple[int, int, int] = _INVERTER_UNPACK(data + b"\0\0")
    return fields


class ServoAxis(AxisCommand):
    """One drive: readings as of the last frames, commands for the next scan.

    Torque is in N m. ``target`` and ``actual`` have the unit ``config.unit``: a speed, or with position feedback a
    position in rad, m, mm, deg (``actual`` is TPDO1's field). ``stamp_s`` is the arrival of the last TPDO1, -inf before
    the first; the user of a reading decides how old it may be. ``changed_s`` is the arrival of the last TPDO1 with
    another ``actual``, or of an inverter, whose speeds are coarse, with anything else. ``actual`` and ``torque_nm`` are
    NaN before the first reading; so is the torque of a drive without 0x6077 always.

    ``online``: configured, OPERATIONAL and with a heartbeat. ``lost``: the heartbeat stopped, or the drive booted while
    in use (``rebooted``). This stays until the next connect, and until then the drive is sent a quick stop unless
    ``goal`` is FREE (nothing, once rebooted). ``refused`` is the reason why connect or home failed. ``emergency`` is
    the last EMCY that was neither reset by the device nor acknowledged. ``parameters`` holds the values read back from
    the device, by (index, sub-index). Since connect ``plan`` lists the objects that the drive lacks, and the loss by
    that (``without``). ``inputs`` and ``outputs`` have the program's bits (drivers.digital_io). ``inputs_stamp_s`` is
    the arrival of the last TPDO2, -inf before the first. A caller that sees no effect of the outputs sets
    ``outputs_unanswered``: they are then sent again. ``machine_late``: a simulated machine's latest reports that its
    own computer was late: arrival in s, lateness in ms. ``stands``: between two SYNCs the drive reported standstill;
    the caller clears it.

    The master calls the methods ``on_...``, ``emit...``, ``check_heartbeat`` and ``holds``.
    """

    __slots__ = ("_coarse", "_nm_per_mille", "_outputs_again_s", "_outputs_sent", "_raw_per_unit", "_unpack",
                 "actual", "changed_s", "diagnosis", "emergencies_dropped", "emergency", "emergency_log", "homed",
                 "identity", "inputs", "inputs_stamp_s", "machine_late", "outputs_unanswered", "parameters", "plan",
                 "rebooted", "stands", "torque_nm")

    def __init__(self, config: AxisConfig) -> None:
        super().__init__(config)
        by_position = config.feedback == "position"
        self._raw_per_unit = config.position_increments if by_position else config.velocity_increments
        self._nm_per_mille = config.rated_torque_nm / 1000.0 / config.drive.units.torque
        self._coarse = False
        self._unpack: Callable[[bytes], tuple[int, int, int]] = _TPDO1
        if config.drive.inverter:
            torque = self._coarse = config.drive.torque
            self._unpack = _INVERTER_UNPACK if torque else _no_torque
            self._nm_per_mille = self._nm_per_mille if torque else math.nan
        self.diagnosis: Diagnosis | None = None
        self.emergency_log: list[Emergency] = []
        self.emergencies_dropped = 0
        self._forget()

    def _forget(self) -> None:
        """Reset everything to the state before the drive's first answer."""
        self.clear_commands()
        self.actual = math.nan
        self.torque_nm = math.nan
        self.inputs: int = 0
        self.stands = False
        self.stamp_s = self.changed_s = -math.inf
        self.inputs_stamp_s = -math.inf
        self.tpdo1_data = b""
        self.online = False
        self.rebooted = False
        self.homed = False
        self.booted = False
        self.nmt_state = -1
        self.heartbeat = HeartbeatMonitor(self.config.heartbeat_s)
        self.usual_heartbeat = b""
        self.emergency: Emergency | None = None
        self.machine_late: list[tuple[float, int]] = []
        self.identity: DeviceIdentity | None = None
        self.refused = None
        self.parameters: dict[tuple[int, int], int] = {}
        self.plan = DrivePlan()
        self._outputs_sent = 0
        self._outputs_again_s = math.inf
        self.outputs_unanswered = False

    # --- verbs ----------------------------------------------------------------------------------------------

    def reset_fault(self) -> None:
        """Acknowledge: forget the last emergency and, in FAULT, raise bit 7 once with the next scan.

        The drive then stays in SWITCH_ON_DISABLED: ENABLED counts only after another goal was set.
        """
        self.emergency = None
        self.news = True
        if self.state is State.FAULT:
            self._request_reset()

    def take_emergencies(self) -> list[Emergency]:
        """Return the emergencies since the last call, oldest first, and forget them.

        At most 64 are kept in between; ``emergencies_dropped`` counts the rest.
        """
        taken = self.emergency_log
        self.emergency_log = []
        return taken

    # --- statusword bits ------------------------------------------------------------------------------------

    @property
    def warning(self) -> bool:
        """Bit 7: the drive reports a warning."""
        return self.statusword & cia402.WARNING != 0

    @property
    def deviation(self) -> bool:
        """Bit 13: following error (position) or too much slippage (velocity)."""
        return self.statusword & cia402.FOLLOWING_ERROR != 0

    @property
    def homing_succeeded(self) -> bool:
        """Whether, in homing mode, the reference is found and the axis is at rest (bits 12 and 10, not 13)."""
        return self.statusword & (_HOMED | cia402.HOMING_ERROR) == _HOMED

    # --- methods for the master -----------------------------------------------------------------------------

    def on_tpdo1(self, t: float, data: bytes) -> None:
        """Decode a TPDO1 that arrived at ``t``; one of a wrong length is counted and ignored."""
        if not self.connected:
            return
        unpack = self._unpack  # an attribute that is called as a method is looked up anew (CPython 3.11)
        try:
            fields: tuple[int, int, int] = unpack(data)
        except struct.error:
            self.malformed += 1
            return
        statusword, raw, torque = fields
        if statusword != self.statusword:
            self.take_statusword(statusword)
        if self._at_rest and self._position_mode:
            self.dirty = True
        if raw != self._raw or self._coarse:
            self.changed_s = t
        self._raw = raw
        self.actual = raw / self._raw_per_unit
        self.torque_nm = torque * self._nm_per_mille
        self.stamp_s = t
        self.tpdo1_data = data

    def on_tpdo2(self, t: float, data: bytes) -> None:
        """Decode a TPDO2 that arrived at ``t``: the digital inputs, or a changed statusword."""
        if self.config.standstill_by_pdo:
            self._on_status(t, data)
        elif len(data) != _IO_SIZE:
            self.malformed += 1
        elif self.connected:
            fields: tuple[int] = _IO_UNPACK(data)
            inputs = self.config.io.from_drive(fields[0])
            self.inputs_stamp_s = t
            if inputs != self.inputs:
                self.inputs = inputs
                self.news = True

    def _on_status(self, t: float, data: bytes) -> None:
        """Process a statusword sent by event: it reports standstill now, not with the next SYNC."""
        if len(data) != _STATUS_SIZE:
            self.malformed += 1
        elif self.connected:
            fields: tuple[int] = _STATUS_UNPACK(data)
            statusword = fields[0]
            stood = self.statusword & cia402.SPEED_ZERO
            if statusword != self.statusword:
                self.take_statusword(statusword)
            if statusword & cia402.SPEED_ZERO and not stood:
                self._raw = 0
                self.actual = 0.0
                self.stamp_s = t
                self.tpdo1_data = b""
                self.stands = self.news = True

    def on_heartbeat(self, t: float, nmt_state: int) -> None:
        """Record a heartbeat or boot-up message that arrived at ``t``."""
        self.nmt_state = nmt_state
        if nmt_state == o.NmtState.BOOT_UP:
            self.booted = True
            if self.connected:
                self.rebooted = True
                self.lost = True
                self.disconnect()
        self.heartbeat.arrived(t)
        self.news = True
        self.online = self.connected and not self.lost and nmt_state == o.NmtState.OPERATIONAL

    def on_emergency(self, t: float, data: bytes) -> None:
        """Record an EMCY message that arrived at ``t``."""
        emergency = decode_emergency(data, t)
        if emergency.code == o.MACHINE_LATE and emergency.vendor[2:] == o.MACHINE_LATE_MARK:
            # No fault of the drive: the run continues as long as its own limits hold.
            self.machine_late.append((t, int.from_bytes(emergency.vendor[:2], "little")))
            del self.machine_late[:-_MAX_EMERGENCIES]
            return
        self.emergency = None if emergency.is_reset else emergency
        self.news = True
        if len(self.emergency_log) < _MAX_EMERGENCIES:
            self.emergency_log.append(emergency)
        else:
            self.emergencies_dropped += 1

    def check_heartbeat(self, now: float) -> None:
        """Mark the drive as lost when its heartbeat is overdue."""
        if self.heartbeat.expired(now):
            self.lost = True
            self.online = False
            self.usual_heartbeat = b""
            self.dirty = self.news = True

    def emit_outputs(self, now: float) -> bytes | None:
        """Return RPDO2 if the outputs have changed, or show no effect after a while; else None.

        A lost drive is sent zeros.
        """
        wanted = 0 if self.lost else self._outputs
        if wanted == self._outputs_sent and not (self.outputs_unanswered and now >= self._outputs_again_s):
            return None
        if not self.connected:
            return None
        self._outputs_sent = wanted
        self._outputs_again_s = now + OUTPUTS_AGAIN_S
        return _IO_PACK(self.config.io.to_drive(wanted))

    def holds(self, condition: AwaitedCondition) -> bool:
        """Return whether a condition that a conversation waits for is true."""
        if condition is AwaitedCondition.BOOTED:
            return self.booted
        if condition is AwaitedCondition.OPERATIONAL:
            return self.nmt_state == o.NmtState.OPERATIONAL
        if condition is AwaitedCondition.DISABLED:
            return self.state in (State.SWITCH_ON_DISABLED, State.FAULT)
        if condition is AwaitedCondition.ENABLED:
            return self.state is State.OPERATION_ENABLED
        if self.state is not State.OPERATION_ENABLED:
            return True
        return self.homing_scans >= _HOMING_SCANS and (self.deviation or self.homing_succeeded)

    # --- methods for the conversations (servo_setup, servo_service) ------------------------------------------------

    def begin_connect(self) -> None:
        """Forget the device: nothing is commanded until finish_connect."""
        self._forget()

    def finish_connect(self, statusword: int, raw: int, inputs: int) -> None:
        """Accept a device that is configured and OPERATIONAL; ``raw`` is TPDO1's field in counts."""
        self.connected = True
        self.news = True
        self.online = self.nmt_state == o.NmtState.OPERATIONAL
        self.heartbeat.arm()
        self.take_statusword(statusword)
        self.inputs = inputs
        self._goal = Goal.DISABLED
        self._outputs = 0
        self._take_position(raw)

    def disconnect(self) -> None:
        """Send no commands any more; the readings stay, and age."""
        self.connected = False
        self.online = False
        self.tpdo1_data = self.usual_heartbeat = b""
        self.heartbeat.disarm()
        self.dirty = self.news = True

    def finish_homing(self, raw: int) -> None:
        """Use the position of a homed axis, counts, as reading and as target."""
        self.homed = True
        self._take_position(raw)

    def _take_position(self, raw: int) -> None:
        self._hold_still(raw)
        self.actual = raw / self._raw_per_unit
