"""Results of the two papers as their readers ask for them: each a row of the papers' first table, made of items."""

from __future__ import annotations

from typing import Final

from tester.analysis.papers import PaperRow

GROSCH_ROWS: Final = (
    PaperRow("WLF", ("4: log10 aT",)),
    PaperRow("Eqs 1-4", ("Eq 1", "Eq 2", "Eq 3", "Eq 4")),
    PaperRow("Figs 3, 4 (speeds x temperatures -> one curve)", ("Figs 3, 4",)),
    PaperRow("Figs 5-7 (glass, SiC, talc; SBR, ABR, butyl)", ("Figs 5, 6", "Fig 7")),
    PaperRow("peak rules 6 nm, 150 um", ("4: the peak on a rough", "4: the peak on a smooth", "4: both ratios")),
    PaperRow("load without influence to 55 kPa", ("4: no influence",)),
    PaperRow("Fig 8 (mu falls, 1 to 7 bar)", ("4, Fig 8",)),
    PaperRow("P(q) proportional to pressure", ("8: area in contact",)),
    PaperRow("storage x 3 halves the peak in place (Figs 16, 17)", ("Figs 16, 17",)),
    PaperRow("lower q1: lower, faster peak", ("8: a lower q1",)),
    PaperRow("Fig 11 (strain dependence), 13-15 (measured spectrum, moduli)",
             ("Fig 11", "7, Fig 13", "Fig 14", "Fig 15")),
)  # fmt: skip
GRETA_ROWS: Final = (
    PaperRow("Eqs 8-13", ("Eqs 8, 9", "Eq 10, Fig 8", "Eqs 11 to 13", "Eq 13", "Eq 12")),
    PaperRow("Eqs 20-22", ("Eq 20", "Eq 21", "Eq 22, Fig 10")),
    PaperRow("Figs 11-15 (stress)", ("Fig 11, 14a", "Fig 12", "Fig 13", "Fig 14b", "Fig 15")),
    PaperRow("Fig 16 mu over speed and pressure", ("Fig 16",)),
    PaperRow("Fig 17 T, E'", ("Fig 17a", "Fig 17b")),
    PaperRow("Fig 18 Ra", ("Fig 18",)),
    PaperRow("Fig 21 (3M tape Ra 27 um, 40 degC, 10/20 N, 0.05-2 m/s, dry/wet)", ("Fig 21",)),
)
