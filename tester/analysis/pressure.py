"""The nominal pressure of a load, where a recipe or a rig file states the area under the rubber."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

LOAD: Final = "load"
"""Name of the axis of loads, N."""
AREA_MM2: Final = "contact_area_mm2"
"""Key of the nominal area in a run's metadata."""
AREA_SOURCE: Final = "contact_area_source"
"""Key of where it comes from."""


def area_metadata(area_mm2: float, source: str) -> dict[str, str]:
    """Return an area, mm2, and its source ("" for none) as a run's metadata."""
    return {AREA_MM2: f"{area_mm2:g}", **({AREA_SOURCE: source} if source else {})}


def pressure_kpa(load_n: float, metadata: Mapping[str, str]) -> float | None:
    """Return the nominal pressure of a load (N) in a run, kPa; None where no area is known."""
    area_mm2 = metadata.get(AREA_MM2)
    return None if area_mm2 is None else 1e3 * load_n / float(area_mm2)
