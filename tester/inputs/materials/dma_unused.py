"""Columns of a file of moduli that become none of ours: named, and of the strain its range is kept.

A filled rubber's modulus falls with the strain of the test (Payne): at 0.1 % it may be three times that of 10 %. Laws
here take moduli for those of small strain, so a table of several strains is doubted.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Set
from math import isfinite
from typing import Final

from tester.inputs.materials.finding import Findings
from tester.inputs.materials.layout import DmaLayout
from tester.inputs.materials.moduli import ALIKE

_STRAIN: Final = re.compile(r"(dyn(amic)?|shear|tensile|oscillation)?\W*(strain|deformation)\b(?!\W*rate)", re.I)
_PERCENT: Final = re.compile(r"%|per\s?cent", re.I)


def tell_unused(layout: DmaLayout, used: Set[int], result: Findings) -> None:
    """Note the columns that are not used; note a strain's range, and doubt a table of several strains."""
    unused = [(at, text) for at, text in enumerate(layout.headings) if text and at not in used]
    if unused:
        result.notes.append("columns not used: " + ", ".join(f'"{text}"' for _, text in unused))
    for at, text in unused:
        if _STRAIN.match(text):
            _tell_strain(layout, at, text, result)


def _tell_strain(layout: DmaLayout, at: int, text: str, result: Findings) -> None:
    values = sorted(_values(layout, at))
    if not values:
        return
    below = layout.units[at] if layout.units is not None and at < len(layout.units) else ""
    unit = " %" if _PERCENT.search(text + below) else ""
    low, high = values[0], values[-1]
    phrase = f"{low:g}{unit}" if low == high else f"{low:g} to {high:g}{unit}"
    result.notes.append(f'strain: {phrase}, from "{text}"' + ("" if unit else ", whose unit is not said"))
    if high > ALIKE * low:
        result.doubt(
            (layout.at + 1, 1),
            f"measured at strains of {phrase}: moduli of filled rubber fall with strain, and laws take them for one",
            lasting=True,
        )


def _values(layout: DmaLayout, at: int) -> Iterator[float]:
    for _, cells in layout.rows():
        cell = cells[at] if at < len(cells) else ""
        try:
            value = abs(float(cell if layout.delimiter == "," else cell.replace(",", ".")))
        except ValueError:
            continue
        if isfinite(value):
            yield value
