"""One measured figure with its limit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure, its limit in words, and whether it keeps the limit; ``str`` gives the printed line."""

    name: str
    value: str
    limit: str
    ok: bool

    def __str__(self) -> str:
        """Return the line that is printed."""
        return f"{'ok  ' if self.ok else 'MISS'} {self.name}: {self.value}  [{self.limit}]"


def near(name: str, value: float, expected: float, tolerance: float, unit: str = "", digits: int = 5) -> Figure:
    """Compare with a value within a tolerance; NaN misses."""
    limit = f"{expected:g} +- {tolerance:g} {unit}".rstrip()
    return Figure(name, f"{value:.{digits}f} {unit}".rstrip(), limit, abs(value - expected) <= tolerance)


def at_most(name: str, value: float, limit: float, unit: str = "", digits: int = 3, *, note: str = "") -> Figure:
    """Compare with an upper limit; NaN misses. ``note`` follows the value."""
    text = f"{value:.{digits}f} {unit}".rstrip() + note
    return Figure(name, text, f"at most {limit:g} {unit}".rstrip(), value <= limit)


def at_least(name: str, value: float, limit: float, unit: str = "", digits: int = 0) -> Figure:
    """Compare with a lower limit; NaN misses."""
    return Figure(name, f"{value:.{digits}f} {unit}".rstrip(), f"at least {limit:g} {unit}".rstrip(), value >= limit)


def equal(name: str, value: object, expected: object) -> Figure:
    """Compare with an exact value."""
    return Figure(name, _words(value), _words(expected), value == expected)


def holds(name: str, ok: bool, value: str, limit: str) -> Figure:
    """Return a figure that was compared elsewhere."""
    return Figure(name, value, limit, ok)


def _words(value: object) -> str:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return " ".join(map(str, value)) or "none"
    return str(value)
