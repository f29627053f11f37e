"""Strict reader for a table of a profile's file, of Modbus devices and of drives alike."""

from __future__ import annotations

import tomllib
from typing import Any, cast

from drivers.profiles.model import ProfileError

UNKNOWN = "unknown"
"""Placeholder in a profile for an unknown value of the manufacturer; the profile cannot be used with it."""


def read_table(where: str, text: str) -> ProfileTable:
    """Return a text in TOML as a table; ``where`` names it in errors. Raises ProfileError."""
    try:
        return ProfileTable(where, tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise ProfileError(f"{where}: {error}") from error


class ProfileTable:
    """A table of the file: every key is taken once, with its type, and none may be left."""

    def __init__(self, where: str, data: dict[str, Any]) -> None:
        """Wrap ``data``; ``where``: the file, and the keys that lead to this table."""
        self.where = where
        self._data = dict(data)

    def __contains__(self, key: str) -> bool:
        return key in self._data

    def error(self, key: str, text: str) -> ProfileError:
        """Return an error that names the key and its place."""
        return ProfileError(f"{self.where}: {key}: {text}")

    def _take(self, key: str, default: object) -> object:
        value = self._data.pop(key, default)
        if value is None:
            raise self.error(key, "is missing")
        if value == UNKNOWN:
            raise self.error(key, "is not known to us: take it from the manual, in a profile of your own")
        return value

    def text(self, key: str, default: str | None = None) -> str:
        """Take a string."""
        value = self._take(key, default)
        if not isinstance(value, str):
            raise self.error(key, f"must be a text, not {value!r}")
        return value

    def choice(self, key: str, allowed: tuple[str, ...], default: str | None = None) -> str:
        """Take one of a few words."""
        value = self.text(key, default)
        if value not in allowed:
            raise self.error(key, f"must be one of {', '.join(allowed)}, not {value!r}")
        return value

    def integer(self, key: str, least: int, greatest: int, default: int | None = None) -> int:
        """Take a whole number within bounds."""
        value = self._take(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= greatest:
            raise self.error(key, f"must be a whole number {least}..{greatest}, not {value!r}")
        return value

    def number(self, key: str, default: float | None = None) -> float:
        """Take a number."""
        value = self._take(key, default)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.error(key, f"must be a number, not {value!r}")
        return float(value)

    def share(self, key: str, default: float | None) -> float | None:
        """Take a number above 0 and at most 1, or nothing."""
        if key not in self:
            return default
        value = self.number(key)
        if not 0.0 < value <= 1.0:
            raise self.error(key, f"must be above 0 and at most 1, not {value:g}")
        return value

    def flag(self, key: str, default: bool) -> bool:
        """Take true or false."""
        value = self._take(key, default)
        if not isinstance(value, bool):
            raise self.error(key, f"must be true or false, not {value!r}")
        return value

    def items(self, key: str) -> list[object]:
        """Take a list, empty when absent."""
        value = self._take(key, [])
        if not isinstance(value, list):
            raise self.error(key, f"must be a list, not {value!r}")
        return cast(list[object], value)

    def table(self, key: str, required: bool = False) -> ProfileTable:
        """Take a table, empty when absent."""
        value = self._take(key, None if required else {})
        if not isinstance(value, dict):
            raise self.error(key, f"must be a table, not {value!r}")
        return ProfileTable(f"{self.where}: {key}", cast(dict[str, Any], value))

    def tables(self, key: str) -> list[ProfileTable]:
        """Take a list of tables, empty when absent."""
        found: list[ProfileTable] = []
        for place, item in enumerate(self.items(key), 1):
            if not isinstance(item, dict):
                raise self.error(key, f"must hold tables, not {item!r}")
            found.append(ProfileTable(f"{self.where}: {key} {place}", cast(dict[str, Any], item)))
        return found

    def keys(self) -> list[str]:
        """Return the keys that were not taken."""
        return list(self._data)

    def end(self) -> None:
        """Refuse the keys that were not taken."""
        if self._data:
            keys = "is not a key" if len(self._data) == 1 else "are not keys"
            raise self.error(", ".join(self._data), f"{keys} of such a profile")
