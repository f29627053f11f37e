"""What is said to a drive once, outside the scan: bring-up, homing, fault diagnosis (CiA 402-2, CiA 301).

Each function is a conversation for ``CanMaster.start``. Everything written is read back and kept in
``drive.parameters``; the first object that reads otherwise ends the conversation with ``drive.refused``.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import TYPE_CHECKING

from drivers import cia402
from drivers.axis import AxisConfig, DeviceIdentity, Diagnosis
from drivers.canopen import heartbeat, nmt, pdo
from drivers.canopen import objects as o
from drivers.canopen.conversation import (
    AwaitedCondition,
    Conversation,
    Pause,
    Reply,
    Request,
    RequestError,
    SdoWrite,
    SendNmt,
    Until,
    read_number,
)
from drivers.canopen.dictionary import describe
from drivers.canopen.objects import NmtCommand, OperationMode
from drivers.canopen.pdo import PdoMap
from drivers.canopen.sdo import NO_OBJECT, NO_SUB_INDEX
from drivers.cia402 import Goal, State

if TYPE_CHECKING:
    from drivers.servo import ServoDrive

BOOT_TIMEOUT_S = 2.0        # a servo's restart of its communication takes well under a second [A]
START_TIMEOUT_S = 1.0       # NMT start to the first heartbeat that says OPERATIONAL: 20 periods of 50 ms
ENABLE_TIMEOUT_S = 3.0      # brake release and power stage [A]
STOP_TIMEOUT_S = 10.0       # the slowest ramp from full speed [A]
MODE_TIMEOUT_S = 0.5
POLL_S = 0.02               # between two reads of an object that is waited for

ABORT_CONNECTION_QUICK_STOP = 3     # 0x6007: heartbeat lost -> quick stop
NO_STATE_CHANGE = 1                 # 0x1029:01: a communication error leaves the NMT state alone
STATUS_INHIBIT_100_US = 50             # 0x1801:03: 5 ms between two statuswords sent by themselves [A]
OUTPUT_MASK = 0xFFFF_0000           # 0x60FE:02: the manufacturer's outputs, bits 16..31, may be set
COB_ID_COMPARED = o.COB_INVALID | o.COB_ID_MASK     # devices are free to answer bit 30 as they like

Step = Generator[Request, Reply, None]
Read = Generator[Request, Reply, int]


class SetupRefusedError(Exception):
    """The device is not what the configuration says, or does not do as told."""


def connect(drive: ServoDrive, pc_node_id: int) -> Conversation:
    """Bring a drive from any state to OPERATIONAL and SWITCH_ON_DISABLED with all commands zero.

    A drive that stands in FAULT is connected as it is: a fault is only ever reset by ``reset_fault``.
    """
    drive.begin_connect()
    try:
        yield from _boot()
        yield from _identify(drive)
        yield from _make_quiet(drive)
        yield from _configure(drive, pc_node_id)
        yield from _start(drive)
    except (RequestError, SetupRefusedError) as error:
        drive.disconnect()
        drive.refused = _refusal(drive, error)
        yield SendNmt(NmtCommand.PRE_OPERATIONAL)      # where it takes no process data


def _refusal(drive: ServoDrive, error: Exception) -> str:
    return f"{drive.config.name} (node {drive.node_id}): {error}"


def _boot() -> Step:
    yield SendNmt(NmtCommand.RESET_COMMUNICATION)
    booted = yield Until(AwaitedCondition.BOOTED, BOOT_TIMEOUT_S)
    if booted:
        return
    try:
        yield from read_number(o.DEVICE_TYPE)      # a boot-up can be missed; an answer cannot
    except RequestError as error:
        raise SetupRefusedError(f"no boot-up message within {BOOT_TIMEOUT_S:g} s; {error}") from error


def _identify(drive: ServoDrive) -> Step:
    config = drive.config
    device_type = yield from _keep(drive, o.DEVICE_TYPE)
    if device_type & 0xFFFF != o.DEVICE_PROFILE:
        raise SetupRefusedError(f"{describe(o.DEVICE_TYPE, 0)}: read 0x{device_type:08X}, no CiA 402 drive")
    highest = yield from _keep(drive, o.IDENTITY)
    values = [0, 0, 0, 0]
    for sub in range(1, min(highest, 4) + 1):
        values[sub - 1] = yield from _keep(drive, o.IDENTITY, sub)
    drive.identity = DeviceIdentity(device_type, *values)
    for sub, expected in ((1, config.vendor_id), (2, config.product_code), (4, config.serial_number)):
        if expected and values[sub - 1] != expected:
            raise SetupRefusedError(f"{describe(o.IDENTITY, sub)}: read 0x{values[sub - 1]:08X}, "
                               f"the configuration has 0x{expected:08X}: wrong or swapped drive")
    modes = yield from _keep(drive, o.SUPPORTED_MODES)
    if not modes >> (_mode(config) - 1) & 1:
        raise SetupRefusedError(f"{describe(o.SUPPORTED_MODES, 0)}: read 0x{modes:08X}, without {_mode(config).name}")


def _make_quiet(drive: ServoDrive) -> Step:
    """Have the power off before anything is changed; a fault stays as it is."""
    statusword = yield from read_number(o.STATUSWORD)
    state = cia402.decode(statusword)
    if state in (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE):
        yield SdoWrite(o.CONTROLWORD, 0, cia402.QUICK_STOP)
        yield from _await(_is_stopped, STOP_TIMEOUT_S)
    yield from _write(drive, o.CONTROLWORD, 0, cia402.DISABLE_VOLTAGE)
    yield from _await(_is_off, START_TIMEOUT_S)


def _is_off(statusword: int) -> bool:
    return cia402.decode(statusword) in (State.SWITCH_ON_DISABLED, State.FAULT)


def _is_stopped(statusword: int) -> bool:
    """Whether the power is off, or a quick stop that holds the axis (0x605A = 5..8) has come to rest."""
    if cia402.decode(statusword) is State.QUICK_STOP_ACTIVE:
        return statusword & cia402.TARGET_REACHED != 0
    return _is_off(statusword)


def _await(condition: Callable[[int], bool], timeout_s: float) -> Read:
    """Return the statusword once the condition holds for it; raises RefusedError after ``timeout_s``."""
    for _ in range(round(timeout_s / POLL_S)):
        statusword = yield from read_number(o.STATUSWORD)
        if condition(statusword):
            return statusword
        yield Pause(POLL_S)
    statusword = yield from read_number(o.STATUSWORD)
    raise SetupRefusedError(f"{describe(o.STATUSWORD, 0)}: read 0x{statusword:04X} "
                       f"({cia402.decode(statusword).name}), not SWITCH_ON_DISABLED after {timeout_s:g} s")


def _configure(drive: ServoDrive, pc_node_id: int) -> Step:
    config = drive.config
    # SYNC comes with the tick: no period to watch.
    yield from _write_where_present(drive, o.SYNC_PERIOD, 0, 0)
    # Without our heartbeat the drive stops by 0x6007 and stays OPERATIONAL: its TPDOs show how it stops.
    yield from _write_where_present(drive, o.ERROR_BEHAVIOUR, 1, NO_STATE_CHANGE)
    for index, sub, value in settings(config):
        yield from _write(drive, index, sub, value)
    yield from _keep(drive, o.RATED_TORQUE)
    yield from _set_mode(drive, _mode(config))
    position = 0
    if config.mode == "position":
        position = yield from read_number(o.POSITION_ACTUAL)
        yield from _write(drive, o.TARGET_POSITION, 0, position)
    else:
        yield from _write(drive, o.TARGET_VELOCITY, 0, 0)
    for communication, mapping_index, cob_id, kind, mapped in pdo_settings(config):
        yield from _map(drive, communication, mapping_index, cob_id, kind, mapped)
    yield from _write(drive, o.PRODUCER_HEARTBEAT, 0, round(config.heartbeat_s * 1000))
    # Last: the watch on us begins with our next heartbeat, and those have been sent since the first service.
    watched = heartbeat.consumer_entry(pc_node_id, config.consumer_heartbeat_s)
    yield from _write(drive, o.CONSUMER_HEARTBEAT, 1, watched)


def settings(config: AxisConfig) -> list[tuple[int, int, int]]:
    """Return (index, sub-index, value) of the drive parameters that follow from the configuration."""
    per = config.velocity_increments
    speed = round(config.max_speed * per)
    deceleration = round(config.deceleration * per)
    values = [
        (o.ABORT_CONNECTION_OPTION, 0, ABORT_CONNECTION_QUICK_STOP),
        (o.QUICK_STOP_OPTION, 0, 2),             # quick stop ramp, then SWITCH_ON_DISABLED
        (o.SHUTDOWN_OPTION, 0, 0),               # power off; never sent from operation
        (o.DISABLE_OPERATION_OPTION, 0, 1),      # slow down ramp, then power off
        (o.HALT_OPTION, 0, 1),                   # slow down ramp, stay enabled
        (o.FAULT_REACTION_OPTION, 0, 2),         # quick stop ramp
        (o.PROFILE_ACCELERATION, 0, round(config.acceleration * per)),
        (o.PROFILE_DECELERATION, 0, deceleration),
        (o.QUICK_STOP_DECELERATION, 0, round(config.quick_stop_deceleration * per)),
        (o.MAX_TORQUE, 0, config.max_torque_per_mille),
        (o.MAX_MOTOR_SPEED, 0, speed),
    ]
    if config.mode == "position":
        values.append((o.PROFILE_VELOCITY, 0, speed))
        if config.software_limits is not None:
            low, high = config.software_limits
            values.append((o.SOFTWARE_LIMIT, 1, round(low * config.position_increments)))
            values.append((o.SOFTWARE_LIMIT, 2, round(high * config.position_increments)))
        if config.position_window:
            values.append((o.POSITION_WINDOW, 0, round(config.position_window * config.position_increments)))
    if config.speed_zero:
        values.append((o.VELOCITY_THRESHOLD, 0, round(config.speed_zero * per)))
        values.append((o.VELOCITY_THRESHOLD_TIME, 0, 0))
        # 65 bits in 5 ms: a statusword that chatters takes 3 % of a 500 kbit/s bus.
        values.append((o.TPDO_COMMUNICATION + 1, 3, STATUS_INHIBIT_100_US))
    if config.digital_io:
        values.append((o.DIGITAL_OUTPUTS, 2, OUTPUT_MASK))
        values.append((o.DIGITAL_OUTPUTS, 1, 0))
        # An event comes once, and a lost frame is not repeated: the timer shows that the inputs still arrive.
        values.append((o.TPDO_COMMUNICATION + 1, 5, round(config.inputs_period_s * 1000)))
    if config.rpdo_deadline_s:
        values.append((o.RPDO_COMMUNICATION, 5, round(config.rpdo_deadline_s * 1000)))
    return values


def pdo_settings(config: AxisConfig) -> list[tuple[int, int, int, int, PdoMap | None]]:
    """Return (communication index, mapping index, COB-ID, transmission type, map) per PDO; None: PDO off."""
    node = config.node_id
    rpdo1 = pdo.RPDO1_POSITION if config.mode == "position" else pdo.RPDO1_VELOCITY
    tpdo1 = pdo.TPDO1_POSITION if config.feedback == "position" else pdo.TPDO1_VELOCITY
    io = config.digital_io
    return [
        (o.RPDO_COMMUNICATION, o.RPDO_MAPPING, o.RPDO1_BASE + node, pdo.SYNCHRONOUS, rpdo1),
        (o.RPDO_COMMUNICATION + 1, o.RPDO_MAPPING + 1, o.RPDO2_BASE + node, pdo.EVENT_DRIVEN,
         pdo.RPDO2_OUTPUTS if io else None),
        (o.TPDO_COMMUNICATION, o.TPDO_MAPPING, o.COB_NO_RTR | o.TPDO1_BASE + node, pdo.SYNCHRONOUS, tpdo1),
        (o.TPDO_COMMUNICATION + 1, o.TPDO_MAPPING + 1, o.COB_NO_RTR | o.TPDO2_BASE + node, pdo.EVENT_DRIVEN,
         pdo.TPDO2_INPUTS if io else pdo.TPDO2_STATUS if config.speed_zero else None),
    ]


def _map(drive: ServoDrive, communication: int, mapping_index: int, cob_id: int, kind: int,
         mapped: PdoMap | None) -> Step:
    """Change a PDO in the order CiA 301 (7.5.2.36) asks: off, map empty, map, count, type, on."""
    yield from _write(drive, communication, 1, o.COB_INVALID | cob_id, COB_ID_COMPARED)
    if mapped is None:
        return
    entries = mapped.parameters()
    yield from _write(drive, mapping_index, 0, 0)
    for sub, entry in enumerate(entries, start=1):
        yield from _write(drive, mapping_index, sub, entry)
    yield from _write(drive, mapping_index, 0, len(entries))
    yield from _write(drive, communication, 2, kind)
    yield from _write(drive, communication, 1, cob_id, COB_ID_COMPARED)


def _start(drive: ServoDrive) -> Step:
    config = drive.config
    yield SendNmt(NmtCommand.START)
    started = yield Until(AwaitedCondition.OPERATIONAL, START_TIMEOUT_S)
    if not started:
        said = f"the heartbeat says {nmt.state_name(drive.nmt_state)}" if drive.nmt_state >= 0 else "no heartbeat"
        raise SetupRefusedError(f"not OPERATIONAL within {START_TIMEOUT_S:g} s of NMT start: {said}")
    statusword = yield from _await(_is_off, START_TIMEOUT_S)
    raw = yield from read_number(o.POSITION_ACTUAL if config.feedback == "position" else o.VELOCITY_ACTUAL)
    inputs = 0
    if config.digital_io:
        inputs = yield from read_number(o.DIGITAL_INPUTS)
    drive.finish_connect(statusword, raw, inputs)


def home(drive: ServoDrive) -> Conversation:
    """Find the reference of an axis with a position (mode 6), then go back to its own mode, disabled.

    Sets the goal itself (DISABLED, ENABLED, DISABLED); a caller who sets another meanwhile ends the homing.
    """
    config = drive.config
    drive.refused = None
    drive.homed = False
    modes = drive.parameters.get((o.SUPPORTED_MODES, 0), 0)
    if not (drive.online and config.feedback == "position" and modes >> (OperationMode.HOMING - 1) & 1):
        text = "homing needs a drive online, with position feedback and homing mode"
        drive.refused = _refusal(drive, SetupRefusedError(text))
        return
    failure: Exception | None = None
    try:
        yield from _power_off(drive)
        for index, sub, value in homing_settings(config):
            yield from _write(drive, index, sub, value)
        yield from _set_mode(drive, OperationMode.HOMING)
        yield from _run_homing(drive)
    except (RequestError, SetupRefusedError) as error:
        failure = error
        drive.goal = Goal.QUICK_STOP
    try:
        yield from _power_off(drive)
        drive.set_homing(active=False)
        yield from _set_mode(drive, _mode(config))
        raw = yield from read_number(o.POSITION_ACTUAL)
        if failure is None:
            drive.finish_homing(raw)
    except (RequestError, SetupRefusedError) as error:
        drive.disconnect()                    # in an unknown mode it must not be commanded
        failure = failure or error
    if failure is not None:
        drive.refused = _refusal(drive, failure)


def homing_settings(config: AxisConfig) -> list[tuple[int, int, int]]:
    """Return (index, sub-index, value) of the homing parameters."""
    per = config.velocity_increments
    return [
        (o.HOMING_METHOD, 0, config.homing_method),
        (o.HOMING_SPEED, 1, round((config.homing_speed or config.max_speed / 5) * per)),
        (o.HOMING_SPEED, 2, round((config.homing_zero_speed or config.max_speed / 20) * per)),
        (o.HOMING_ACCELERATION, 0, round(config.acceleration * per)),
        (o.HOME_OFFSET, 0, round(config.home_offset * config.position_increments)),
    ]


def _power_off(drive: ServoDrive) -> Step:
    if drive.goal is Goal.ENABLED:
        drive.goal = Goal.DISABLED
    done = yield Until(AwaitedCondition.DISABLED, STOP_TIMEOUT_S)
    if not done:
        raise SetupRefusedError(f"still {drive.state.name} {STOP_TIMEOUT_S:g} s after it was told to stop")


def _run_homing(drive: ServoDrive) -> Step:
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


def diagnose(drive: ServoDrive) -> Conversation:
    """Read 0x603F, 0x1001 and 0x1003 into ``drive.diagnosis``, for the journal, before anybody resets."""
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


def release(drive: ServoDrive) -> Conversation:
    """Leave a drive: power off, its watch on our heartbeat ended, PRE-OPERATIONAL, nothing commanded.

    Without this a drive reports the end of our program as a fault. While its power is on it keeps watching,
    and ``refused`` says so.
    """
    drive.refused = None
    try:
        yield from _power_off(drive)
        yield from _write(drive, o.CONSUMER_HEARTBEAT, 1, 0)
    except (RequestError, SetupRefusedError) as error:
        drive.refused = _refusal(drive, error)
        return
    drive.disconnect()
    yield SendNmt(NmtCommand.PRE_OPERATIONAL)


def _mode(config: AxisConfig) -> OperationMode:
    return OperationMode.PROFILE_POSITION if config.mode == "position" else OperationMode.PROFILE_VELOCITY


def _keep(drive: ServoDrive, index: int, sub: int = 0) -> Read:
    """Read an object and keep it with the drive's parameters."""
    value = yield from read_number(index, sub)
    drive.parameters[index, sub] = value
    return value


def _write(drive: ServoDrive, index: int, sub: int, value: int, mask: int = -1) -> Step:
    """Write an object and read it back; only bits of ``mask`` are compared."""
    yield SdoWrite(index, sub, value)
    back = yield from _keep(drive, index, sub)
    if back & mask != value & mask:
        raise SetupRefusedError(f"{describe(index, sub)}: wrote {value}, read {back}")


def _write_where_present(drive: ServoDrive, index: int, sub: int, value: int) -> Step:
    """Write an optional object and read it back; a device without it has nothing to be told."""
    try:
        yield from _write(drive, index, sub, value)
    except RequestError as error:
        if error.code not in (NO_OBJECT, NO_SUB_INDEX):
            raise


def _set_mode(drive: ServoDrive, mode: OperationMode) -> Step:
    """Select a mode of operation and see it confirmed by 0x6061."""
    yield from _write(drive, o.MODE, 0, mode)
    shown = yield from _keep(drive, o.MODE_DISPLAY)
    for _ in range(round(MODE_TIMEOUT_S / POLL_S)):
        if shown == mode:
            return
        yield Pause(POLL_S)
        shown = yield from _keep(drive, o.MODE_DISPLAY)
    if shown != mode:
        raise SetupRefusedError(f"{describe(o.MODE_DISPLAY, 0)}: wrote mode {int(mode)} ({mode.name}), read {shown}")
