"""Numbers and names as a report writes them."""

from __future__ import annotations

from math import isfinite

from tester.analysis.results import NAN
from tester.axes import Axis

NONE = "–"
"""Stands where there is no value."""


def number(value: float | None, digits: int = 3) -> str:
    """Return a number with so many decimals; a dash for what is not known."""
    return f"{value + 0.0:.{digits}f}" if value is not None and isfinite(value) else NONE


def short(value: float | None, digits: int = 3) -> str:
    """Return a number with so many significant digits; a dash for what is not known."""
    return f"{value + 0.0:.{digits}g}" if value is not None and isfinite(value) else NONE


def percent(share: float, digits: int = 1) -> str:
    """Return a share of 1 in per cent."""
    return f"{100.0 * share:.{digits}f}\u00a0%" if isfinite(share) else NONE


def relative(u: float, mu: float) -> float:
    """Return an uncertainty as a share of what it is of; NaN for none."""
    return u / abs(mu) if mu else NAN


def day(utc: str) -> str:
    """Return the day and the minute of a wall-clock text, in UTC."""
    return f"{utc[:10]} {utc[11:16]} UTC" if len(utc) > 15 and utc[10:11] == "T" else utc or NONE


def unit_of(axis: Axis) -> str:
    """Return the unit of an axis as it is printed."""
    return {"degC": "°C", "deg": "°"}.get(axis.unit, axis.unit)


def name_of(axis: Axis) -> str:
    """Return what an axis is called."""
    return axis.name.replace("_", " ")


def labelled(axis: Axis) -> str:
    """Return an axis with its unit in brackets."""
    return f"{name_of(axis)} ({unit_of(axis)})" if axis.unit else name_of(axis)


def counted(n: int, one: str, more: str = "") -> str:
    """Return a number of things in words: ``1 condition``, ``3 conditions``."""
    return f"{n} {one if n == 1 else more or f'{one}s'}"
