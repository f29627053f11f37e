"""Reads drive profiles: one TOML file for each make of drive.

``drive_profile("maxon_epos4")`` reads a file of drivers/profiles/drives, ``drive_profile("my_drive.toml")`` a file of
your own. A new drive is a new file, not a new class. ``look_up_with`` sets the look-up of names that are neither.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from drivers.canopen import objects as o
from drivers.canopen.objects import DataType
from drivers.drives.drive_model import DriveProfile, FurtherObject, Key, PdoLimits, Substitute, Units
from drivers.profiles.model import ProfileError
from drivers.profiles.table import ProfileTable, read_table

GENERIC = "cia402"
"""Profile of an axis that names none."""
_FOLDER = Path(__file__).parent.parent / "profiles" / "drives"
_PACKAGED = {path.stem: path for path in sorted(_FOLDER.glob("*.toml"))}
LookUp = Callable[[str], str]
"""Returns the TOML text of a profile by its name; raises ValueError with the reason."""
_ADDRESS = re.compile(r"([0-9A-Fa-f]{4})(?::([0-9A-Fa-f]{2}))?")
_TYPES = {kind.name.lower(): kind for kind in DataType if kind is not DataType.TEXT}
_CHOICES = {"cob_ids": ("set", "fixed"), "mapping": ("free", "fixed")}
_LEAST, _MOST = -(2**31), 2**32 - 1
"""Least and greatest value of a 32-bit object, with or without a sign."""
Section = TypeVar("Section", Units, PdoLimits)
_OPTIONS: dict[Key, tuple[int, ...]] = {
    (0x6007, 0): (1, 3),        # a lost connection: fault (then 0x605E counts), quick stop
    (0x605A, 0): (2,),          # quick stop: on its own ramp, then power off
    (0x605B, 0): (0, 1),        # shutdown: never sent from operation
    (0x605C, 0): (1,),          # disable operation: on the usual ramp; with 0 the axis would coast
    (0x605D, 0): (1, 2),        # halt: on the usual ramp or that of a quick stop
    (0x605E, 0): (1, 2),        # fault: on the usual ramp or that of a quick stop
}
"""Option objects that a profile may set, and the allowed values: with each of them the drive stops the axis."""


def _nobody(name: str) -> str:
    raise ValueError("no other package is asked")


_look_up: LookUp = _nobody


def drive_profile_names() -> list[str]:
    """Return the names of the drive profiles that come with the program."""
    return list(_PACKAGED)


def makers_profiles(vendor_id: int) -> list[str]:
    """Return the names of the packaged profiles of a maker, by its vendor id in 0x1018:01."""
    return [name for name in _PACKAGED if vendor_id and _from_file(name).vendor_id == vendor_id]


def look_up_with(found: LookUp) -> None:
    """Call ``found`` for every name that is neither a packaged profile nor a path."""
    global _look_up
    _look_up = found


def drive_profile(name: str = GENERIC) -> DriveProfile:
    """Return the profile of this name, or from this path when it ends in ``.toml``; raises ProfileError.

    No other profile can take the name of a packaged one.
    """
    if name.endswith(".toml") or _PACKAGED.get(name) is not None:
        return _from_file(name)
    known = ", ".join(_PACKAGED)
    try:
        text = _look_up(name)
    except ValueError as error:
        raise ProfileError(f"no drive profile {name!r} (there are {known}); {error}") from error
    return _from_text(name, text)


@cache
def _from_file(name: str) -> DriveProfile:
    path = Path(name) if name.endswith(".toml") else _PACKAGED[name]
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise ProfileError(f"no drive profile {name!r} (there are {', '.join(_PACKAGED)})") from error
    return read_drive_profile(path.stem, text)


@cache
def _from_text(name: str, text: str) -> DriveProfile:
    return read_drive_profile(name, text)


def read_drive_profile(name: str, text: str) -> DriveProfile:
    """Return the profile that a text in TOML describes; raises ProfileError, whose text names file and key."""
    table = read_table(f"{name}.toml", text)
    objects = table.table("objects")
    status = table.table("statusword")
    options = objects.table("options")
    instead = objects.table("instead")
    writes = table.table("writes")
    inverter = table.choice("velocity_mode", ("pv", "vl"), "pv") == "vl"
    profile = DriveProfile(
        name=name,
        title=table.text("title"),
        checked=table.text("checked"),
        vendor_id=table.integer("vendor_id", 0, _MOST, 0),
        velocity_mode="vl" if inverter else "pv",
        missing=_keys(objects, "missing"),
        optional=_keys(objects, "optional"),
        substitutes={_key(instead, key): _substitute(instead.table(key)) for key in instead.keys()},  # noqa: SIM118
        options={_key(options, key): options.integer(key, _LEAST, _MOST) for key in options.keys()},  # noqa: SIM118
        parameters={key: _parameter(writes.table(key)) for key in writes.keys()},  # noqa: SIM118
        units=_section(table, "units", Units),
        pdo=_section(table, "pdo", PdoLimits),
        remote=status.flag("remote", True),
        standstill=status.flag("standstill", not inverter) and not inverter,
    )
    for one in (objects, status, table):
        one.end()
    for key, value in profile.options.items():
        if value not in _OPTIONS.get(key, ()):
            known = ", ".join(map(str, _OPTIONS.get(key, ()))) or "no value"
            raise ProfileError(f"{name}.toml: objects.options: {key[0]:04X} = {value} (a profile may choose {known})")
    if profile.inverter and (o.TORQUE_ACTUAL, 0) in profile.optional:
        raise ProfileError(f"{name}.toml: objects.optional: 6077 (the process data of velocity mode follow from it:"
                           " state in objects.missing whether these drives lack it)")
    for key in profile.substitutes:
        if not profile.lacks(key):
            raise ProfileError(f"{name}.toml: objects.instead: {key[0]:04X}:{key[1]:02X} is not among objects.missing")
    return profile


def _substitute(table: ProfileTable) -> Substitute:
    reference = table.text("per_mille_of", "")
    found = Substitute(
        key=_key(table, table.text("object")),
        type=_type(table),
        factor=table.number("factor", 1.0),
        per_mille_of=_key(table, reference) if reference else None,
        reference=table.integer("simulated", 1, _MOST, 1000),
    )
    if found.factor == 0.0:
        raise table.error("factor", "must not be 0")
    table.end()
    return found


def _parameter(table: ProfileTable) -> FurtherObject:
    found = FurtherObject(
        key=_key(table, table.text("object")),
        type=_type(table),
        value=table.integer("value", _LEAST, _MOST) if "value" in table else None,
        text=table.text("text", ""),
    )
    table.end()
    return found


def _type(table: ProfileTable) -> DataType:
    return _TYPES[table.choice("type", tuple(_TYPES))]


def _key(table: ProfileTable, text: str) -> Key:
    """Return the address in a text: ``6072`` or ``1400:05``."""
    match = _ADDRESS.fullmatch(text)
    if match is None:
        raise table.error(text, 'is no object: expected an address such as "6072" or "1400:05"')
    return int(match[1], 16), int(match[2] or "0", 16)


def _keys(table: ProfileTable, key: str) -> frozenset[Key]:
    """Return a list of addresses from the table."""
    return frozenset(_key(table, str(one)) for one in table.items(key))


def _section(table: ProfileTable, key: str, kind: type[Section]) -> Section:
    """Return a table as a dataclass whose fields all have defaults; its numbers must be above 0."""
    inner = table.table(key)
    found: dict[str, Any] = {}
    for one in fields(kind):
        default = cast("object", one.default)
        if isinstance(default, bool):
            found[one.name] = inner.flag(one.name, default)
        elif isinstance(default, str):
            found[one.name] = inner.choice(one.name, _CHOICES[one.name], default)
        elif isinstance(default, int):
            found[one.name] = inner.integer(one.name, 1, _MOST, default)
        else:
            found[one.name] = inner.number(one.name, cast("float", default))
            if not found[one.name] > 0.0:
                raise inner.error(one.name, f"must be above 0, not {found[one.name]!r}")
    inner.end()
    return kind(**found)
