"""Reads a drive's electronic data sheet (EDS) or device configuration file (DCF), CiA 306-1."""

from __future__ import annotations

import configparser
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from drivers.canopen.objects import BITS, DataType
from drivers.drives.drive_model import Key

_SECTION: Final = re.compile(r"([0-9a-f]{4})(?:sub([0-9a-f]{1,2}))?", re.IGNORECASE)
_WRITABLE: Final = frozenset({"rw", "rww", "rwr", "wo"})
_READABLE: Final = frozenset({"rw", "rww", "rwr", "ro", "const"})
_SIGNED: Final = frozenset({DataType.I8, DataType.I16, DataType.I32})
_COUNTED_BY: Final = DataType.U8


class DataSheetError(ValueError):
    """A file that is no data sheet; the message names the error and its place."""


@dataclass(frozen=True, slots=True)
class SheetEntry:
    """One object of a data sheet; None where the sheet gives no value."""

    name: str
    type: int
    """Data type by its CiA 301 index; others than ``DataType`` knows are possible."""
    access: str
    mappable: bool
    default: int | None
    low: int | None
    high: int | None

    @property
    def writable(self) -> bool:
        """Whether an SDO may write it."""
        return self.access in _WRITABLE

    @property
    def readable(self) -> bool:
        """Whether an SDO may read it."""
        return self.access in _READABLE


@dataclass(frozen=True, slots=True)
class DataSheet:
    """A device as its maker describes it."""

    title: str
    vendor_id: int
    product_code: int
    objects: Mapping[Key, SheetEntry]


def read_data_sheet(path: Path, node_id: int = 1) -> DataSheet:
    """Return a file's description of the device with this node id; raises DataSheetError, and OSError."""
    parser = configparser.RawConfigParser(strict=False, allow_no_value=True, delimiters=("=",), comment_prefixes=(";",))
    try:
        parser.read_string(path.read_bytes().decode("latin-1"), path.name)
    except configparser.Error as error:
        raise DataSheetError(f"{path.name}: no data sheet: {error.message}") from error
    sections = {name.lower(): dict(parser[name]) for name in parser.sections()}
    objects: dict[Key, SheetEntry] = {}
    for name, keys in sections.items():
        match = _SECTION.fullmatch(name)
        if match is None:
            continue
        index, sub = int(match[1], 16), int(match[2] or "0", 16)
        if keys.get("datatype"):
            where = f"{path.name}: [{name}]"
            entry = _entry(where, keys, node_id)
            compact = _number(where, keys.get("compactsubobj"), node_id)
            if match[2] is None and compact:
                objects[index, 0] = SheetEntry("number of entries", _COUNTED_BY, "ro", False, compact, None, None)
                objects.update({(index, number): entry for number in range(1, compact + 1)})
            else:
                objects[index, sub] = entry
    if not objects:
        raise DataSheetError(f"{path.name}: no data sheet: it has no object, such as a section [1000]")
    device = sections.get("deviceinfo", {})
    title = " ".join(one for key in ("vendorname", "productname") if (one := (device.get(key) or "").strip()))
    vendor, product = (_number(f"{path.name}: [DeviceInfo]", device.get(key), node_id) or 0
                       for key in ("vendornumber", "productnumber"))
    identity = objects.get((0x1018, 1))
    if not vendor and identity is not None:
        vendor = identity.default or 0
    return DataSheet(title or path.stem, vendor, product, objects)


def _entry(where: str, keys: Mapping[str, str | None], node_id: int) -> SheetEntry:
    kind = _number(where, keys.get("datatype"), node_id) or 0
    text = kind not in (*DataType,) or kind == DataType.TEXT
    value = keys.get("parametervalue") or keys.get("defaultvalue")
    default, low, high = (
        None if text else _number(where, one, node_id) for one in (value, keys.get("lowlimit"), keys.get("highlimit"))
    )
    if kind in _SIGNED:
        low, high, default = (_signed(one, BITS[DataType(kind)]) for one in (low, high, default))
    return SheetEntry(
        name=(keys.get("parametername") or "").strip(),
        type=kind,
        access=(keys.get("accesstype") or "").strip().lower(),
        mappable=(keys.get("pdomapping") or "0").strip() in ("1", "0x1", "0x01"),
        default=default,
        low=low,
        high=high,
    )


def _signed(value: int | None, bits: int) -> int | None:
    """Return a signed number from its bits: files write negative numbers as 0x80000000 and the like."""
    return value - (1 << bits) if value is not None and value >= 1 << bits - 1 else value


def _number(where: str, text: str | None, node_id: int) -> int | None:
    """Return a number from a data sheet's notation, which includes ``$NODEID+0x200``; None for an empty text."""
    text = (text or "").split(";")[0].strip()
    if not text:
        return None
    total = 0
    for part in text.upper().split("+"):
        one = part.strip()
        if one == "$NODEID":
            total += node_id
            continue
        try:
            total += int(one, 16) if one.startswith("0X") else int(one)
        except ValueError as error:
            raise DataSheetError(f"{where}: {text!r} is no number") from error
    return total
