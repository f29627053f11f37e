"""Whether a repeat has collected what it needs."""

from __future__ import annotations

from tester.analysis.blocks import BlockCounter
from tester.analysis.drift import fit_drift
from tester.analysis.reduce import counted
from tester.analysis.stability import filled


def collected(
    counter: BlockCounter, revolutions: float | None, seconds: float | None, extend_to: float, *, alone: bool
) -> bool:
    """Return whether a repeat is complete; one of ``revolutions`` and ``seconds`` is the window, the other is None.

    ``extend_to``: the most it collects, in the window's unit. ``alone``: it has no siblings to be judged with, so it is
    extended until its drift is shown to be small.
    """
    blocks = counter.blocks
    have = float(len(blocks)) if revolutions is not None else counter.seconds
    if have >= extend_to:
        return True
    if not filled(blocks, revolutions, seconds):
        return False
    if not alone:
        return True
    return fit_drift([counted(blocks, revolutions, seconds)], revolutions, seconds).stable
