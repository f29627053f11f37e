"""Results of the paper as its readers ask for them: each a row of the papers' first table, made of items."""

from __future__ import annotations

from typing import Final

from tester.analysis.papers import PaperRow

WHEEL_ROWS: Final = (
    PaperRow("Table 1 formulations", ("Table 1",)),
    PaperRow("Table 2", ("Table 2",)),
    PaperRow("Eqs 7-9", ("Eq 7", "Eq 8", "Eq 9")),
    PaperRow("Table 3 from A", ("Table 3",)),
    PaperRow("appendix A, B values, Figs 6, 9 (load x T)", ("Appendix B: the largest", "Fig 6", "Fig 9", "Fig 14")),
    PaperRow("Figs 7, 10 (slip x T)", ("Fig 7", "Fig 10")),
    PaperRow("Figs 8, 11 (angle)", ("Fig 8", "Fig 8c", "Fig 11")),
    PaperRow("Figs 12, 13 (footprint, deformation by T)", ("Fig 12", "Fig 13")),
    PaperRow("Figs 14, 15", ("Fig 14", "Fig 15")),
    PaperRow('"errors within 5 %"', ("Abstract, 4.2, 5 (3)",)),
    PaperRow("quoted errors 4.2", ("4.2: errors of",)),
    PaperRow("peak near 70 degC; falls with load, rises with slip",
             ("3.4, 4.1, 5 (2)", "5 (2): mu falls", "5 (2): mu rises")),
    PaperRow("the same from the twin's Table 2", ("5 (2): ... as steeply",)),
)  # fmt: skip
