"""Checks an axis against a drive's data sheet: refusals at connecting, and missing objects that it accepts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from drivers.canopen.data_sheet import DataSheet, SheetEntry
from drivers.canopen.dictionary import KNOWN, describe
from drivers.canopen.objects import BITS, DataType
from drivers.drive_settings import USED, DrivePlan, Setting, plan, tried
from drivers.drives.drive_model import Key
from drivers.process_data import PdoSetting, actual_of, mode_of, target_of

_READ: Final = ((o.DEVICE_TYPE, 0), (o.IDENTITY, 1), (o.SUPPORTED_MODES, 0), (o.STATUSWORD, 0), (o.MODE_DISPLAY, 0),
                (o.ERROR_CODE, 0), (o.ERROR_REGISTER, 0))


@dataclass(frozen=True, slots=True)
class SheetVerdict:
    """Result for an axis on a drive with this data sheet, in sentences."""

    refused: tuple[str, ...]
    without: tuple[str, ...]
    noted: tuple[str, ...]


def check_sheet(config: AxisConfig, sheet: DataSheet) -> SheetVerdict:
    """Return the refusals and the missing functions of a connect of the axis, with a drive as in its data sheet."""
    absent = [key for key in tried(config) if key not in sheet.objects]
    made = plan(config, absent)
    refused: dict[str, str] = {}             # once for each object, with the first reason
    for one in (*made.refused, *_identity(config, sheet), *_objects(config, sheet, made)):
        refused.setdefault(one[:len(describe(0, 0))], one)
    unused = [key for key in config.drive.missing if key in USED and key in sheet.objects]
    noted = [f"{describe(*key)}: the drive has it, the profile {config.profile} does without" for key in sorted(unused)]
    return SheetVerdict(tuple(refused.values()), tuple(made.without), tuple(noted))


def _identity(config: AxisConfig, sheet: DataSheet) -> Iterator[str]:
    for sub, name, expected, stated in (
        (1, "vendor id", config.vendor_id, sheet.vendor_id),
        (2, "product code", config.product_code, sheet.product_code),
    ):
        if expected and stated and expected != stated:
            yield (f"{describe(o.IDENTITY, sub)}: the data sheet has the {name} 0x{stated:08X}, "
                   f"the configuration 0x{expected:08X}")
    modes = sheet.objects.get((o.SUPPORTED_MODES, 0))
    if modes is not None and modes.default and not modes.default >> (mode_of(config) - 1) & 1:
        yield f"{describe(o.SUPPORTED_MODES, 0)}: 0x{modes.default:08X}, without {mode_of(config).name}"


def _objects(config: AxisConfig, sheet: DataSheet, made: DrivePlan) -> Iterator[str]:
    position = config.mode == "position"
    read = [*_READ, actual_of(config), *([(o.RATED_TORQUE, 0)] if made.rated_torque else [])]
    for key in read:
        yield from _readable(sheet, key)
    for setting in (*made.settings, *(made.homing if position else ())):
        yield from _setting(sheet, setting)
    written = [(o.CONTROLWORD, 0), (o.MODE, 0), target_of(config),
               (o.PRODUCER_HEARTBEAT, 0), *([(o.CONSUMER_HEARTBEAT, 1)] if made.watched else [])]
    for key in written:
        yield from _writable(sheet, key)
    for one in made.pdos:
        yield from _pdo(config, sheet, one)


def _readable(sheet: DataSheet, key: Key) -> Iterator[str]:
    entry = sheet.objects.get(key)
    if entry is None:
        yield f"{describe(*key)}: the drive does not have it"
    elif not entry.readable:
        yield f"{describe(*key)}: it cannot be read (access {entry.access})"


def _writable(sheet: DataSheet, key: Key, kind: DataType | None = None) -> Iterator[str]:
    entry = sheet.objects.get(key)
    if entry is None:
        yield f"{describe(*key)}: the drive does not have it"
        return
    if not entry.writable:
        yield f"{describe(*key)}: it cannot be written (access {entry.access})"
    known = KNOWN.get(key)
    due = kind or (known.type if known is not None else None)
    if due is not None and BITS.get(due) != _bits(entry):
        yield f"{describe(*key)}: it has {_bits(entry) or 'an unknown number of'} bits, {BITS.get(due)} are written"


def _bits(entry: SheetEntry) -> int:
    return BITS.get(DataType(entry.type), 0) if entry.type in (*DataType,) else 0


def _setting(sheet: DataSheet, setting: Setting) -> Iterator[str]:
    found = list(_writable(sheet, setting.key, setting.type))
    hint = f" ({setting.name})" if setting.name else ""
    yield from (one + hint for one in found)
    entry = sheet.objects.get(setting.key)
    if found or entry is None:
        return
    value, instead = setting.value, setting.substitute
    if instead is not None:
        reference = 0
        if instead.per_mille_of is not None:
            stated = sheet.objects.get(instead.per_mille_of)
            yield from _readable(sheet, instead.per_mille_of)
            if stated is None or not stated.default:
                return                       # the value to write is known only at the drive
            reference = stated.default
        value = instead.value(value, reference)
    if (entry.low is not None and entry.low > value) or (entry.high is not None and entry.high < value):
        yield f"{describe(*setting.key)}: {value} is not within {entry.low}..{entry.high}{hint}"


def _pdo(config: AxisConfig, sheet: DataSheet, one: PdoSetting) -> Iterator[str]:
    limits = config.drive.pdo
    if limits.cob_ids == "set":
        yield from _writable(sheet, (one.communication, 1))
    else:
        yield from _readable(sheet, (one.communication, 1))
    if one.mapped is None:
        return
    yield from _writable(sheet, (one.communication, 2))
    entries = one.mapped.parameters()
    for sub in range(len(entries) + 1):
        found = _writable if limits.mapping == "free" else _readable
        yield from found(sheet, (one.mapping, sub))
    count = sheet.objects.get((one.mapping, 0))
    if count is not None and count.high is not None and count.high < len(entries):
        yield f"{describe(one.mapping, 0)}: at most {count.high} objects, {len(entries)} are needed"
    for index, sub, bits in one.mapped.fields:
        entry = sheet.objects.get((index, sub))
        if entry is None:
            yield f"{describe(index, sub)}: the drive does not have it"
        elif not entry.mappable:
            yield f"{describe(index, sub)}: it cannot be mapped into a PDO"
        elif _bits(entry) != bits:
            yield f"{describe(index, sub)}: it has {_bits(entry)} bits, {bits} are mapped"
