"""Steps of a conversation with a drive: read and keep an object, write and read it back, or compare it."""

from __future__ import annotations

from collections.abc import Generator

from drivers.canopen import objects as o
from drivers.canopen.conversation import Pause, Reply, Request, RequestError, SdoWrite, read_number
from drivers.canopen.dictionary import describe
from drivers.canopen.objects import DataType, OperationMode
from drivers.canopen.sdo import NO_OBJECT, NO_SUB_INDEX
from drivers.drive_settings import Setting
from drivers.servo_axis import ServoAxis

MODE_TIMEOUT_S = 0.5
POLL_S = 0.02               # between two reads of an object that is waited for

Step = Generator[Request, Reply, None]
Read = Generator[Request, Reply, int]


class SetupRefusedError(Exception):
    """The device differs from the configuration, or does not follow a command."""


def keep(drive: ServoAxis, index: int, sub: int = 0, kind: DataType | None = None) -> Read:
    """Read an object and keep it with the drive's parameters."""
    value = yield from read_number(index, sub, kind)
    drive.parameters[index, sub] = value
    return value


def write(drive: ServoAxis, index: int, sub: int, value: int, mask: int = -1, kind: DataType | None = None) -> Step:
    """Write an object and read it back; only bits of ``mask`` are compared."""
    yield SdoWrite(index, sub, value, kind)
    back = yield from keep(drive, index, sub, kind)
    if back & mask != value & mask:
        raise SetupRefusedError(f"{describe(index, sub)}: wrote {value}, read {back}")


def compare(drive: ServoAxis, index: int, sub: int, value: int, mask: int = -1) -> Step:
    """Read an object that cannot be set and compare it; only bits of ``mask`` count."""
    back = yield from keep(drive, index, sub)
    if back & mask != value & mask:
        raise SetupRefusedError(f"{describe(index, sub)}: read 0x{back:X}, 0x{value:X} is needed and cannot be set")


def write_where_present(drive: ServoAxis, index: int, sub: int, value: int) -> Step:
    """Write an optional object and read it back; a device without the object needs no write."""
    try:
        yield from write(drive, index, sub, value)
    except RequestError as error:
        if error.code not in (NO_OBJECT, NO_SUB_INDEX):
            raise


def apply(drive: ServoAxis, setting: Setting) -> Step:
    """Write one setting, or its substitute."""
    value, instead = setting.value, setting.substitute
    if instead is not None:
        reference = 0
        if instead.per_mille_of is not None:
            index, sub = instead.per_mille_of
            reference = yield from keep(drive, index, sub, DataType.U32)
            if reference <= 0:
                raise SetupRefusedError(f"{describe(index, sub)}: reads {reference}, and {describe(*setting.key)} "
                                        f"({setting.name}) is a share of it")
        value = instead.value(value, reference)
    try:
        yield from write(drive, setting.index, setting.sub, value, kind=setting.type)
    except RequestError as error:
        hint = f" ({setting.name})" if setting.name else ""
        raise RequestError(f"{error}{hint}", error.code) from error


def set_mode(drive: ServoAxis, mode: OperationMode) -> Step:
    """Select a mode of operation and wait until 0x6061 confirms it."""
    yield from write(drive, o.MODE, 0, mode)
    shown = yield from keep(drive, o.MODE_DISPLAY)
    for _ in range(round(MODE_TIMEOUT_S / POLL_S)):
        if shown == mode:
            return
        yield Pause(POLL_S)
        shown = yield from keep(drive, o.MODE_DISPLAY)
    if shown != mode:
        raise SetupRefusedError(f"{describe(o.MODE_DISPLAY, 0)}: wrote mode {int(mode)} ({mode.name}), read {shown}")
