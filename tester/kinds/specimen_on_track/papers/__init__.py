"""The papers that the laws persson and greta come from, item by item."""

from __future__ import annotations

from typing import Final

from tester.analysis.papers import Paper
from tester.kinds.specimen_on_track.papers.adhesion import ADHESION_ITEMS
from tester.kinds.specimen_on_track.papers.grosch import GROSCH_ITEMS
from tester.kinds.specimen_on_track.papers.hysteresis import HYSTERESIS_ITEMS
from tester.kinds.specimen_on_track.papers.table_rows import GRETA_ROWS, GROSCH_ROWS
from tester.kinds.specimen_on_track.papers.theory import THEORY_ITEMS

PAPERS: Final = (
    Paper(
        "Grosch and Persson",
        "R. S. Sharp, P. Gruber, E. Fina, Circuit Racing, Track Texture, Temperature and Rubber Friction, *Vehicle"
        " System Dynamics* 54 (2016): paper S.",
        (*GROSCH_ITEMS, *THEORY_ITEMS),
        GROSCH_ROWS,
    ),
    Paper(
        "GrETA",
        "F. Farroni, M. Russo, R. Russo, F. Timpone, A physical-analytical model for a real-time local grip"
        " estimation of tyre rubber in sliding contact with road asperities, *Proc. IMechE Part D* (2014), "
        "[doi 10.1177/0954407014521402](https://doi.org/10.1177/0954407014521402): paper G.",
        (*ADHESION_ITEMS, *HYSTERESIS_ITEMS),
        GRETA_ROWS,
    ),
)
