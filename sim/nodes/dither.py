"""The last bit of a digital sensor."""

from __future__ import annotations

from typing import Final

PATTERN: Final = (0.0, 0.5, 1.0, 0.5)
"""What readings in a row add to a value in counts before it is rounded down. A value at rest then changes by exactly
one count within four readings, as that of a real converter does, and their mean is within a quarter of a count."""
