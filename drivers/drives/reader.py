"""Reads drive profiles: one TOML file for each make of drive.

``drive_profile("maxon_epos4")`` reads a file of drivers/profiles/drives, ``drive_profile("my_drive.toml")`` one of your
own. A new drive is a new file, not a new class.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from drivers.canopen.objects import DataType
from drivers.drives.model import DriveProfile, FurtherObject, Key, PdoLimits, Substitute, Units
from drivers.profiles.model import ProfileError

GENERIC = "cia402"
"""The profile of an axis that names none."""
_FOLDER = Path(__file__).parent.parent / "profiles" / "drives"
_ADDRESS = re.compile(r"([0-9A-Fa-f]{4})(?::([0-9A-Fa-f]{2}))?")
_TYPES = {kind.name.lower(): kind for kind in DataType if kind is not DataType.TEXT}
Section = TypeVar("Section", Units, PdoLimits)
_OPTIONS: dict[Key, tuple[int, ...]] = {
    (0x6007, 0): (1, 3),        # a lost connection: fault (then 0x605E counts), quick stop
    (0x605A, 0): (2,),          # quick stop: on its own ramp, then power off
    (0x605B, 0): (0, 1),        # shutdown: never sent from operation
    (0x605C, 0): (1,),          # disable operation: on the usual ramp; 0 would let the axis coast
    (0x605D, 0): (1, 2),        # halt: on the usual ramp or that of a quick stop
    (0x605E, 0): (1, 2),        # fault: on the usual ramp or that of a quick stop
}
"""Option objects that a profile may set, and values with which the drive stops the axis: no others can be chosen."""


def drive_profile_names() -> list[str]:
    """Return the names of the drive profiles that come with the program."""
    return sorted(path.stem for path in _FOLDER.glob("*.toml"))


@cache
def drive_profile(name: str = GENERIC) -> DriveProfile:
    """Return the profile of this name, or from this path when it ends in ``.toml``; raises ProfileError."""
    path = Path(name) if name.endswith(".toml") else _FOLDER / f"{name}.toml"
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError, ValueError) as error:
        known = ", ".join(drive_profile_names())
        raise ProfileError(f"no drive profile {name!r} (there are {known})") from error
    return read_drive_profile(path.stem, text)


def read_drive_profile(name: str, text: str) -> DriveProfile:
    """Return the profile that a text in TOML describes; raises ProfileError, which names file and key."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ProfileError(f"{name}.toml: {error}") from error
    table = _ProfileTable(f"{name}.toml", data)
    objects = table.table("objects")
    status = table.table("statusword")
    profile = DriveProfile(
        name=name,
        title=table.take("title", str),
        checked=table.take("checked", str),
        vendor_id=table.take("vendor_id", int, 0),
        missing=objects.keys_of("missing"),
        optional=objects.keys_of("optional"),
        substitutes={objects.key(key): _substitute(one) for key, one in objects.tables("instead")},
        options={objects.key(key): objects.whole(key, value) for key, value in objects.values("options")},
        parameters={key: _parameter(one) for key, one in table.tables("writes")},
        units=table.section("units", Units),
        pdo=_pdo_limits(table),
        remote=status.take("remote", bool, True),
        standstill=status.take("standstill", bool, True),
    )
    for one in (objects, status, table):
        one.end()
    for key, value in profile.options.items():
        if value not in _OPTIONS.get(key, ()):
            known = ", ".join(map(str, _OPTIONS.get(key, ()))) or "no value"
            raise ProfileError(f"{name}.toml: objects.options: {key[0]:04X} = {value} (a profile may choose {known})")
    for key in profile.substitutes:
        if not profile.lacks(key):
            raise ProfileError(f"{name}.toml: objects.instead: {key[0]:04X}:{key[1]:02X} is not among objects.missing")
    return profile


def _substitute(table: _ProfileTable) -> Substitute:
    reference = table.take("per_mille_of", str, "")
    found = Substitute(
        key=table.key(table.take("object", str)),
        type=table.type(),
        factor=table.number("factor", 1.0),
        per_mille_of=table.key(reference) if reference else None,
        reference=table.take("simulated", int, 1000),
    )
    if found.factor == 0.0:
        raise table.error("factor", "must not be 0")
    table.end()
    return found


def _parameter(table: _ProfileTable) -> FurtherObject:
    has_value = "value" in table
    found = FurtherObject(
        key=table.key(table.take("object", str)),
        type=table.type(),
        value=table.take("value", int, 0) if has_value else None,
        text=table.take("text", str, ""),
    )
    table.end()
    return found


def _pdo_limits(table: _ProfileTable) -> PdoLimits:
    limits = table.section("pdo", PdoLimits)
    for name, words in (("cob_ids", ("set", "fixed")), ("mapping", ("free", "fixed"))):
        if getattr(limits, name) not in words:
            raise table.error(f"pdo.{name}", f"must be one of {', '.join(words)}")
    return limits


class _ProfileTable:
    """A table of the file: every key is taken once, with its type, and none may be left."""

    def __init__(self, where: str, data: Mapping[str, Any]) -> None:
        self.where = where
        self._data = dict(data)

    def __contains__(self, key: str) -> bool:
        return key in self._data

    def error(self, key: str, text: str) -> ProfileError:
        return ProfileError(f"{self.where}: {key}: {text}")

    def take(self, key: str, kind: type[Any], default: object = None) -> Any:
        """Take a value of a type."""
        value = self._data.pop(key, default)
        if value is None:
            raise self.error(key, "is missing")
        if not isinstance(value, kind) or (kind is not bool and isinstance(value, bool)):
            raise self.error(key, f"must be {_WORDS[kind]}, not {value!r}")
        return value

    def number(self, key: str, default: float) -> float:
        return float(self.take(key, cast("type[Any]", int | float), default))

    def type(self) -> DataType:
        """Take the key ``type``."""
        word = self.take("type", str)
        if word not in _TYPES:
            raise self.error("type", f"must be one of {', '.join(_TYPES)}, not {word!r}")
        return _TYPES[word]

    def key(self, text: str) -> Key:
        """Return the address that a text says: ``6072`` or ``1400:05``."""
        match = _ADDRESS.fullmatch(text)
        if match is None:
            raise self.error(text, 'is no object: expected an address such as "6072" or "1400:05"')
        return int(match[1], 16), int(match[2] or "0", 16)

    def keys_of(self, key: str) -> frozenset[Key]:
        """Take a list of addresses."""
        return frozenset(self.key(str(one)) for one in self.take(key, list, []))

    def table(self, key: str) -> _ProfileTable:
        return _ProfileTable(f"{self.where}: {key}", self.take(key, dict, {}))

    def tables(self, key: str) -> list[tuple[str, _ProfileTable]]:
        """Take a table of tables."""
        outer = self.table(key)
        return [(name, outer.table(name)) for name in list(outer._data)]

    def values(self, key: str) -> list[tuple[str, object]]:
        return list(self.take(key, dict, {}).items())

    def whole(self, key: str, value: object) -> int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise self.error(key, f"must be a whole number, not {value!r}")
        return value

    def section(self, key: str, kind: type[Section]) -> Section:
        """Take a table as a dataclass whose fields all have defaults, of which numbers must be above 0."""
        inner = self.table(key)
        found: dict[str, Any] = {}
        for one in fields(kind):
            default = cast("object", one.default)
            if isinstance(default, float):
                found[one.name] = inner.number(one.name, default)
            else:
                found[one.name] = inner.take(one.name, type(default), default)
            if not isinstance(default, bool | str) and not found[one.name] > 0:
                raise inner.error(one.name, f"must be above 0, not {found[one.name]!r}")
        inner.end()
        return kind(**found)

    def end(self) -> None:
        """Refuse what is left."""
        if self._data:
            raise self.error(", ".join(self._data), "unknown key")


_WORDS: dict[object, str] = {
    str: "a text", int: "a whole number", bool: "true or false", list: "a list", dict: "a table",
    int | float: "a number",
}  # fmt: skip
