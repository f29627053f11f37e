"""The last bit of a digital sensor."""

from __future__ import annotations

from math import floor

PATTERN = (0.0, 0.5, 1.0, 0.5)
"""Offsets in counts of four readings in a row, before rounding down. A value at rest then changes by exactly one count
within four readings, as that of a real converter does, and their mean is within a quarter of a count."""


def quantise(value: float, scale: float, phase: int) -> int:
    """Return ``value`` in counts of ``scale``; ``phase`` is the number of the reading."""
    return floor(value / scale + PATTERN[phase & 3])
