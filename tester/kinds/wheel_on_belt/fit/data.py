"""The paper's appendices as packaged: every row has a word on its quality.

Polymers 2024, 16(5), 596, doi 10.3390/polym16050596 (CC BY 4.0). Parts of the printed tables are illegible. ``ok``
rows are legible, ``reconstructed`` rows follow from others (see the column ``note``), ``suspect`` rows contradict
others, ``missing`` rows are illegible. ``inferred`` rows have a value that was chosen to match the paper's own results;
the column ``printed`` has the printed text. They are no evidence, and are left out unless a reading includes them.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from enum import Enum
from importlib.resources import files
from typing import Final

from tester.analysis.fit.fit_law import FitPoint, Source, Sourced

APPENDICES: Final[Mapping[str, str]] = {"appendix-a": "appendix_a.csv", "appendix-b": "appendix_b.csv"}
"""Names of the packaged sources, and their files."""
READABLE: Final = frozenset({"ok", "reconstructed"})
INFERRED: Final = "inferred"
_AGAIN: Final = "_dupT"
"""Suffix of the group of rows that the paper prints a second time."""


class Reading(Enum):
    """The treatment of inferred rows."""

    WITHOUT = "without"
    """They are left out. Every verdict uses this reading."""
    PRINTED = "as printed"
    INFERRED = "as inferred"
    """They have a value that matches the paper's own results: for comparison, never as evidence."""


def rows(name: str) -> list[dict[str, str]]:
    """Return the rows of a packaged appendix unchanged; raises KeyError for an unknown name."""
    place = files("tester.kinds.wheel_on_belt.fit").joinpath("data", APPENDICES[name])
    return list(csv.DictReader(place.read_text(encoding="utf-8").splitlines()))


def inferred_rows() -> list[dict[str, str]]:
    """Return the rows of both appendices that have an inferred value."""
    return [row for name in APPENDICES for row in rows(name) if row["quality"] == INFERRED]


def appendix(name: str, reading: Reading = Reading.WITHOUT) -> Sourced:
    """Return the conditions of an appendix that a law can be fitted to, and the reasons for leaving out others.

    Laws have no sideslip; rows that the paper repeats count once. Raises KeyError for an unknown name.
    """
    source = Source(name)
    points: list[FitPoint] = []
    left_out: list[tuple[str, str]] = []
    for row in rows(name):
        reason = _reason(row, reading)
        if reason:
            left_out.append((row["row_id"], reason))
            continue
        held = (float(row["temp_C"]), float(row["load_N"]), 1e-3 * float(row["slip_mm_s"]))
        points.append(FitPoint(row["row_id"], row["formula"], held, held, _value(row, reading), source))
    return Sourced(tuple(points), tuple(left_out))


def _value(row: Mapping[str, str], reading: Reading) -> float:
    return float(row["printed"] if row["quality"] == INFERRED and reading is Reading.PRINTED else row["mu"])


def _reason(row: Mapping[str, str], reading: Reading) -> str:
    """Return why a row is left out, "" where it is not."""
    taken = row["quality"] in READABLE or (row["quality"] == INFERRED and reading is not Reading.WITHOUT)
    if not taken:
        return f"quality: {row['quality']}"
    if float(row["angle_deg"]) != 0.0:
        return "sideslip: the laws know none"
    if row["group"].endswith(_AGAIN):
        return "printed twice"
    return ""
