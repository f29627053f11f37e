"""The conversation that connects a drive (CiA 402-2, CiA 301), for ``CanMaster.start``.

Every value written is read back and kept in ``drive.parameters``. Refusals of the drive are collected, so that
``drive.refused`` reports all of them at once; ``drive.plan`` lists the objects that are done without. A missing answer
ends the conversation.
"""

from __future__ import annotations

from collections.abc import Callable, Generator

from drivers import cia402
from drivers.axis import DeviceIdentity
from drivers.canopen import heartbeat
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
from drivers.canopen.messages import state_name
from drivers.canopen.objects import NmtCommand
from drivers.canopen.sdo import NO_OBJECT, NO_SUB_INDEX, TIMED_OUT
from drivers.cia402 import State
from drivers.drive_settings import NO_STATE_CHANGE, RATED_TORQUE_SHARE, DrivePlan, plan, tried
from drivers.drives.drive_model import Key
from drivers.process_data import PdoSetting, actual_of, mode_of, target_of
from drivers.servo_axis import ServoAxis
from drivers.servo_talk import (
    POLL_S,
    Read,
    SetupRefusedError,
    Step,
    apply,
    compare,
    keep,
    set_mode,
    write,
    write_where_present,
)

BOOT_TIMEOUT_S = 2.0        # a servo's restart of its communication takes well under a second [A]
START_TIMEOUT_S = 1.0       # NMT start to the first OPERATIONAL heartbeat: 20 periods of 50 ms
STOP_TIMEOUT_S = 10.0       # the slowest ramp from full speed [A]

COB_ID_COMPARED = o.COB_INVALID | o.COB_ID_MASK     # devices may answer any bit 30


def connect(drive: ServoAxis, pc_node_id: int) -> Conversation:
    """Bring a drive from any state to OPERATIONAL and SWITCH_ON_DISABLED with all commands zero.

    A drive in FAULT is connected in that state: only ``reset_fault`` resets a fault.
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
        drive.refused = str(error)
        yield SendNmt(NmtCommand.PRE_OPERATIONAL)      # the drive takes no process data there


def _boot() -> Step:
    yield SendNmt(NmtCommand.RESET_COMMUNICATION)
    booted = yield Until(AwaitedCondition.BOOTED, BOOT_TIMEOUT_S)
    if booted:
        return
    try:
        yield from read_number(o.DEVICE_TYPE)      # the boot-up message can be missed; an answer cannot
    except RequestError as error:
        raise SetupRefusedError(f"no boot-up message within {BOOT_TIMEOUT_S:g} s; {error}") from error


def _identify(drive: ServoAxis) -> Step:
    """Check that the drive is the configured one: nothing is written to any other."""
    config = drive.config
    wrong: list[str] = []
    device_type = yield from keep(drive, o.DEVICE_TYPE)
    if device_type & 0xFFFF != o.DEVICE_PROFILE:
        raise SetupRefusedError(f"{describe(o.DEVICE_TYPE, 0)}: read 0x{device_type:08X}, no CiA 402 drive")
    highest = yield from keep(drive, o.IDENTITY)
    values = [0, 0, 0, 0]
    for sub in range(1, min(highest, 4) + 1):
        values[sub - 1] = yield from keep(drive, o.IDENTITY, sub)
    drive.identity = DeviceIdentity(device_type, *values)
    for sub, expected in ((1, config.vendor_id), (2, config.product_code), (4, config.serial_number)):
        if expected and values[sub - 1] != expected:
            wrong.append(f"{describe(o.IDENTITY, sub)}: read 0x{values[sub - 1]:08X}, "
                         f"the configuration has 0x{expected:08X}: wrong or swapped drive")
    if not wrong:
        modes = yield from keep(drive, o.SUPPORTED_MODES)
        if not modes >> (mode_of(config) - 1) & 1:
            wrong.append(f"{describe(o.SUPPORTED_MODES, 0)}: read 0x{modes:08X}, without {mode_of(config).name}")
    if wrong:
        raise SetupRefusedError("; ".join(wrong))


def _make_quiet(drive: ServoAxis) -> Step:
    """Switch the power off before anything is changed; a fault stays as it is."""
    statusword = yield from read_number(o.STATUSWORD)
    state = cia402.decode(statusword)
    if state in (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE):
        yield SdoWrite(o.CONTROLWORD, 0, cia402.QUICK_STOP)
        yield from _await(_is_stopped, STOP_TIMEOUT_S)
    yield from write(drive, o.CONTROLWORD, 0, cia402.DISABLE_VOLTAGE)
    yield from _await(_is_off, START_TIMEOUT_S)


def _is_off(statusword: int) -> bool:
    return cia402.decode(statusword) in (State.SWITCH_ON_DISABLED, State.FAULT)


def _is_stopped(statusword: int) -> bool:
    """Return whether the power is off, or a quick stop that holds the axis (0x605A = 5..8) has come to rest."""
    if cia402.decode(statusword) is State.QUICK_STOP_ACTIVE:
        return statusword & cia402.TARGET_REACHED != 0
    return _is_off(statusword)


def _await(condition: Callable[[int], bool], timeout_s: float) -> Read:
    """Return the statusword that fulfils the condition; raises SetupRefusedError after ``timeout_s``."""
    for _ in range(round(timeout_s / POLL_S)):
        statusword = yield from read_number(o.STATUSWORD)
        if condition(statusword):
            return statusword
        yield Pause(POLL_S)
    statusword = yield from read_number(o.STATUSWORD)
    raise SetupRefusedError(f"{describe(o.STATUSWORD, 0)}: read 0x{statusword:04X} "
                       f"({cia402.decode(statusword).name}), not SWITCH_ON_DISABLED after {timeout_s:g} s")


def _configure(drive: ServoAxis, pc_node_id: int) -> Step:
    """Write all settings; raise SetupRefusedError with everything that was refused."""
    config = drive.config
    made = yield from _plan(drive)
    refused = list(made.refused)
    # SYNC comes with the tick: it has no period to watch.
    yield from _collect(refused, write_where_present(drive, o.SYNC_PERIOD, 0, 0))
    # Without our heartbeat the drive stops by 0x6007 and stays OPERATIONAL: its TPDOs show how it stops.
    yield from _collect(refused, write_where_present(drive, o.ERROR_BEHAVIOUR, 1, NO_STATE_CHANGE))
    for setting in made.settings:
        yield from _collect(refused, apply(drive, setting))
    if made.rated_torque:
        yield from _collect(refused, _check_rated_torque(drive))
    yield from _collect(refused, set_mode(drive, mode_of(config)))
    if config.mode == "position":
        yield from _collect(refused, _aim_where_it_stands(drive))
    else:
        yield from _collect(refused, write(drive, *target_of(config), 0))
    for one in made.pdos:
        yield from _collect(refused, _map(drive, one))
    yield from _collect(refused, write(drive, o.PRODUCER_HEARTBEAT, 0, round(config.heartbeat_s * 1000)))
    if refused:
        raise SetupRefusedError("; ".join(refused))
    if made.watched:
        # Last: the drive's watch begins with our next heartbeat. We have sent heartbeats since the first service.
        watched = heartbeat.consumer_entry(pc_node_id, config.consumer_heartbeat_s)
        yield from write(drive, o.CONSUMER_HEARTBEAT, 1, watched)


def _plan(drive: ServoAxis) -> Generator[Request, Reply, DrivePlan]:
    """Return the plan of writes, after asking the drive for the objects that may be absent."""
    absent: list[Key] = []
    for index, sub in tried(drive.config):
        try:
            yield from read_number(index, sub)
        except RequestError as error:
            if error.code not in (NO_OBJECT, NO_SUB_INDEX):
                raise
            absent.append((index, sub))
    drive.plan = plan(drive.config, absent)
    return drive.plan


def _collect(refused: list[str], step: Step) -> Step:
    """Run a step and collect its refusal; a drive that does not answer ends the conversation."""
    try:
        yield from step
    except SetupRefusedError as error:
        refused.append(str(error))
    except RequestError as error:
        if error.code == TIMED_OUT:
            raise
        refused.append(str(error))


def _check_rated_torque(drive: ServoAxis) -> Step:
    """Compare 0x6076: torques are per mille of it, so another value than the rig file's would make them all wrong."""
    counts = yield from keep(drive, o.RATED_TORQUE)
    config = drive.config
    expected = config.rated_torque_counts
    if counts and abs(counts - expected) > max(RATED_TORQUE_SHARE * expected, 1.0):
        unit = config.drive.units.rated_torque_nm
        raise SetupRefusedError(
            f"{describe(o.RATED_TORQUE, 0)}: read {counts}, {counts * unit * config.gear:.4g} N m at the shaft; "
            f"the configuration's rated_torque is {config.rated_torque_nm:g} N m")


def _aim_where_it_stands(drive: ServoAxis) -> Step:
    position = yield from read_number(o.POSITION_ACTUAL)
    yield from write(drive, o.TARGET_POSITION, 0, position)


def _map(drive: ServoAxis, one: PdoSetting) -> Step:
    """Change a PDO in the order of CiA 301 (7.5.2.36): off, map empty, map, count, type, on."""
    limits = drive.config.drive.pdo
    settable = limits.cob_ids == "set"
    if settable:
        yield from write(drive, one.communication, 1, o.COB_INVALID | one.cob_id, COB_ID_COMPARED)
    elif one.mapped is not None:
        yield from compare(drive, one.communication, 1, one.cob_id, COB_ID_COMPARED)
    if one.mapped is None:
        if not settable and limits.mapping == "free":
            yield from write(drive, one.mapping, 0, 0)      # nothing mapped: nothing is sent or taken
        return
    entries = one.mapped.parameters()
    if limits.mapping == "free":
        yield from write(drive, one.mapping, 0, 0)
        for sub, entry in enumerate(entries, start=1):
            try:
                yield from write(drive, one.mapping, sub, entry)
            except RequestError as error:
                index, inner, _ = one.mapped.fields[sub - 1]
                raise RequestError(f"{error}: {describe(index, inner)}", error.code) from error
        yield from write(drive, one.mapping, 0, len(entries))
    else:
        yield from compare(drive, one.mapping, 0, len(entries))
        for sub, entry in enumerate(entries, start=1):
            yield from compare(drive, one.mapping, sub, entry)
    yield from write(drive, one.communication, 2, one.kind)
    if settable:
        yield from write(drive, one.communication, 1, one.cob_id, COB_ID_COMPARED)


def _start(drive: ServoAxis) -> Step:
    config = drive.config
    yield SendNmt(NmtCommand.START)
    started = yield Until(AwaitedCondition.OPERATIONAL, START_TIMEOUT_S)
    if not started:
        last = f"the heartbeat reports {state_name(drive.nmt_state)}" if drive.nmt_state >= 0 else "no heartbeat"
        raise SetupRefusedError(f"not OPERATIONAL within {START_TIMEOUT_S:g} s of NMT start: {last}")
    statusword = yield from _await(_is_off, START_TIMEOUT_S)
    raw = yield from read_number(*actual_of(config))
    inputs = 0
    if config.digital_io:
        inputs = config.io.from_drive((yield from read_number(o.DIGITAL_INPUTS)))
    drive.finish_connect(statusword, raw, inputs)
