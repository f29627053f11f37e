"""Conversations with a connected drive, outside the scan: homing, fault diagnosis, restart, release.

Each function is a conversation for ``CanMaster.start``.
"""

from __future__ import annotations

from drivers.axis import Diagnosis
from drivers.canopen import objects as o
from drivers.canopen.conversation import AwaitedCondition, Conversation, RequestError, SendNmt, Until, read_number
from drivers.canopen.objects import NmtCommand, OperationMode
from drivers.cia402 import Goal, State
from drivers.process_data import mode_of
from drivers.servo_axis import ServoAxis
from drivers.servo_setup import START_TIMEOUT_S, STOP_TIMEOUT_S
from drivers.servo_talk import SetupRefusedError, Step, apply, set_mode, write

ENABLE_TIMEOUT_S = 3.0      # time for brake release and power stage [A]


def home(drive: ServoAxis) -> Conversation:
    """Find the reference of a positioning axis (mode 6), then return to the axis' own mode, disabled.

    It sets the goal itself (DISABLED, ENABLED, DISABLED); another goal from the caller meanwhile ends the homing.
    """
    config = drive.config
    drive.refused = None
    drive.homed = False
    modes = drive.parameters.get((o.SUPPORTED_MODES, 0), 0)
    if not (drive.online and config.feedback == "position" and modes >> (OperationMode.HOMING - 1) & 1):
        text = "homing needs a drive online, with position feedback and homing mode"
        drive.refused = text
        return
    failure: Exception | None = None
    try:
        yield from _power_off(drive)
        for setting in drive.plan.homing:
            yield from apply(drive, setting)
        yield from set_mode(drive, OperationMode.HOMING)
        yield from _run_homing(drive)
    except (RequestError, SetupRefusedError) as error:
        failure = error
        drive.goal = Goal.QUICK_STOP
    try:
        yield from _power_off(drive)
        drive.set_homing(active=False)
        yield from set_mode(drive, mode_of(config))
        raw = yield from read_number(o.POSITION_ACTUAL)
        if failure is None:
            drive.finish_homing(raw)
    except (RequestError, SetupRefusedError) as error:
        drive.disconnect()                    # a drive in an unknown mode must not get commands
        failure = failure or error
    if failure is not None:
        drive.refused = str(failure)


def _power_off(drive: ServoAxis) -> Step:
    if drive.goal is Goal.ENABLED:
        drive.goal = Goal.DISABLED
    done = yield Until(AwaitedCondition.DISABLED, STOP_TIMEOUT_S)
    if not done:
        raise SetupRefusedError(f"still {drive.state.name} {STOP_TIMEOUT_S:g} s after the stop command")


def _run_homing(drive: ServoAxis) -> Step:
    drive.set_homing(active=True)
    drive.goal = Goal.DISABLED                # ends an earlier inhibition
    drive.goal = Goal.ENABLED
    enabled = yield Until(AwaitedCondition.ENABLED, ENABLE_TIMEOUT_S)
    if not enabled:
        raise SetupRefusedError(f"homing: {drive.state.name} instead of OPERATION_ENABLED after {ENABLE_TIMEOUT_S:g} s")
    drive.set_homing(active=True, start=True)
    ended = yield Until(AwaitedCondition.HOMING_ENDED, drive.config.home_timeout_s)
    if not ended:
        raise SetupRefusedError(f"homing: not finished within {drive.config.home_timeout_s:g} s")
    if not (drive.state is State.OPERATION_ENABLED and drive.homing_succeeded):
        raise SetupRefusedError(f"homing failed: statusword 0x{drive.statusword:04X} ({drive.state.name})")


def diagnose(drive: ServoAxis) -> Conversation:
    """Read 0x603F, 0x1001 and 0x1003 into ``drive.diagnosis``, for the journal, before a reset."""
    error_code = 0
    register = 0
    history: list[int] = []
    failed: str | None = None
    try:
        error_code = yield from read_number(o.ERROR_CODE)
        register = yield from read_number(o.ERROR_REGISTER)
        count = yield from read_number(o.ERROR_HISTORY)
        for sub in range(1, min(count, 8) + 1):
            history.append((yield from read_number(o.ERROR_HISTORY, sub)))
    except RequestError as error:
        failed = str(error)
    drive.diagnosis = Diagnosis(error_code, register, tuple(history), failed)


def ask(drive: ServoAxis) -> Conversation:
    """Read the statusword of a connected drive that sends no process data at present."""
    try:
        drive.take_statusword((yield from read_number(o.STATUSWORD)))
    except RequestError as error:
        drive.refused = str(error)


def start_again(drive: ServoAxis) -> Conversation:
    """Return a connected drive to OPERATIONAL; it is still configured, and its goal decides what it does then."""
    yield SendNmt(NmtCommand.START)
    yield Until(AwaitedCondition.OPERATIONAL, START_TIMEOUT_S)


def release(drive: ServoAxis) -> Conversation:
    """Release a drive: power off, its watch on our heartbeat ended, PRE-OPERATIONAL, nothing commanded.

    Without this a drive reports the end of our program as a fault. A drive whose power stays on keeps its watch,
    and ``refused`` reports this.
    """
    drive.refused = None
    try:
        yield from _power_off(drive)
        if (o.CONSUMER_HEARTBEAT, 1) in drive.parameters:
            yield from write(drive, o.CONSUMER_HEARTBEAT, 1, 0)
    except (RequestError, SetupRefusedError) as error:
        drive.refused = str(error)
        return
    drive.disconnect()
    yield SendNmt(NmtCommand.PRE_OPERATIONAL)
