"""The paper that this machine comes from, item by item."""

from __future__ import annotations

from typing import Final

from tester.analysis.papers import Paper
from tester.kinds.wheel_on_belt.papers.equations import EQUATIONS, TABLE_3
from tester.kinds.wheel_on_belt.papers.figures import FIGURES
from tester.kinds.wheel_on_belt.papers.machine import DRAWINGS, MACHINE, PROCEDURE
from tester.kinds.wheel_on_belt.papers.statements import APPENDICES_ITEMS, CONCLUSIONS, ERRORS, TEXT
from tester.kinds.wheel_on_belt.papers.table_rows import WHEEL_ROWS

PAPERS: Final = (
    Paper(
        "Wheel on a belt",
        "A Study of the Friction Characteristics of Rubber Thermo-Mechanical Coupling, *Polymers* 2024, 16(5), 596, "
        "[doi 10.3390/polym16050596](https://doi.org/10.3390/polym16050596) (CC BY 4.0).",
        (*MACHINE, *PROCEDURE, *TABLE_3, *EQUATIONS, *FIGURES, *DRAWINGS, *TEXT, *ERRORS, *APPENDICES_ITEMS,
         *CONCLUSIONS),
        WHEEL_ROWS,
    ),
)  # fmt: skip
