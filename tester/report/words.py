"""Names and times as a report writes them; numbers are those of ``tester.base.words``."""

from __future__ import annotations

import re

from tester.base.axes import Axis
from tester.base.words import NONE
from tester.results.columns import unit_of


def day(utc: str) -> str:
    """Return the day and the minute of a wall-clock text, in UTC."""
    return f"{utc[:10]} {utc[11:16]} UTC" if len(utc) > 15 and utc[10:11] == "T" else utc or NONE


def file_name(source: str) -> str:
    """Return where something was read from without its folders, which are nobody's business but its maker's."""
    return re.split(r"[/\\]", source.rstrip("/\\"))[-1]


def name_of(axis: Axis) -> str:
    """Return what an axis is called."""
    return axis.name.replace("_", " ")


def labelled(axis: Axis) -> str:
    """Return an axis with its unit in brackets."""
    return f"{name_of(axis)} ({unit_of(axis)})" if axis.unit else name_of(axis)
