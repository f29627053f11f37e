"""The points of a sweep: every combination of the values of rig-file parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from tester.base.trouble import MisuseError

_OPENING, _CLOSING, _QUOTES = "[{(", "]})", "\"'"


class GridError(MisuseError):
    """A text does not describe an axis of a sweep; the message gives the reason."""


@dataclass(frozen=True, slots=True)
class SweepAxis:
    """A key of the rig file and the texts of its values, in the given order."""

    key: str
    values: tuple[str, ...]


def axis_of(text: str) -> SweepAxis:
    """Return the axis of ``key=v1,v2,...``; a comma inside brackets or quotes does not separate. Raises GridError."""
    key, equals, values = text.partition("=")
    parts = [part.strip() for part in _separated(values)]
    if not equals or not key.strip() or not all(parts):
        raise GridError(f"--set {text}: expected key=value,value,...")
    if len(set(parts)) < len(parts):
        raise GridError(f"--set {text}: a value appears twice")
    return SweepAxis(key.strip(), tuple(parts))


def axes_of(texts: Sequence[str]) -> tuple[SweepAxis, ...]:
    """Return the axes of several texts; raises GridError, also for a repeated key."""
    axes = tuple(axis_of(text) for text in texts)
    keys = [axis.key for axis in axes]
    for key in keys:
        if keys.count(key) > 1:
            raise GridError(f"--set {key}: appears twice; put its values into one --set, separated by commas")
    return axes


def points_of(axes: Sequence[SweepAxis]) -> list[tuple[str, ...]]:
    """Return every combination of values, one for each axis; the last axis changes fastest. Without axes: one point."""
    return list(product(*(axis.values for axis in axes)))


def overrides_of(axes: Sequence[SweepAxis], point: Sequence[str]) -> tuple[str, ...]:
    """Return a point as overrides of the rig file (``key=value``)."""
    return tuple(f"{axis.key}={value}" for axis, value in zip(axes, point, strict=True))


def _separated(text: str) -> list[str]:
    """Return the parts of a text between commas outside brackets and quotes."""
    parts, depth, quote = [""], 0, ""
    for c in text:
        if quote:
            quote = "" if c == quote else quote
        elif c in _QUOTES:
            quote = c
        elif c in _OPENING:
            depth += 1
        elif c in _CLOSING:
            depth -= 1
        elif c == "," and depth == 0:
            parts.append("")
            continue
        parts[-1] += c
    return parts
