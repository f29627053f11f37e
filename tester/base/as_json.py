"""What JSON can hold."""

from __future__ import annotations

from math import isfinite

Json = str | int | float | bool | None | list["Json"] | dict[str, "Json"]


def finite(value: float) -> float | None:
    """Return a number, None (JSON's null) for what is not finite."""
    return value if isfinite(value) else None
