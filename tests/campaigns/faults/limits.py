"""The campaign at the limits: every fault at the corners of the rig's range.

First each corner runs without a fault: no trip, every row measured, no harm. Then faults begin in it, at begin, middle
and end of heating, pre-grinding, soak, repeat and lift.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

from tests.campaigns.faults.campaign import Tally, all_cases, conduct, faults_of_campaign, sample
from tests.campaigns.faults.corners import Corner, corners
from tests.campaigns.faults.moments import Moment, rehearse
from tests.campaigns.faults.parametric import PARAMETRIC

CASES = 5200
"""Cases at the limits."""
ASKED_FOR = 5000
"""Cases at the limits at least."""
SHORT_CORNER = "3#, stiffness +30%, friction heat +30%"
"""The corner of the short sample: most friction, the stiffest rubber, the most heat."""
SHORT_CASES = 70
HEADER = ("corner", "load", "slip", "temp.", "outcome", "rows", "force", "hub", "surface", "slip power", "rig time")


WIDTHS = (38, 5, 8, 7, 7, 6, 5, 8, 9, 10, 8)


@dataclass(frozen=True, slots=True)
class Fine:
    """A corner without a fault: its result, and its moments."""

    corner: Corner
    moments: tuple[Moment, ...]
    outcome: str
    rows: int
    planned: int
    wrong: tuple[str, ...]
    force_n: float
    hub_c: float
    surface_c: float
    power_w: float
    seconds: float

    @property
    def well(self) -> bool:
        """No trip, no harm, every row measured."""
        return self.outcome == "done" and self.rows == self.planned and not self.wrong

    def cells(self) -> tuple[str, ...]:
        """Return the corner's line of the table, as HEADER."""
        c = self.corner
        asked = (f"{c.load_n} N", f"{c.slip_mm_s} mm/s", f"{c.temperature_c} degC")
        found = (f"{self.force_n:.0f} N", f"{self.hub_c:.0f} degC", f"{self.surface_c:.1f} degC")
        rows, power, seconds = f"{self.rows} of {self.planned}", f"{self.power_w:.0f} W", f"{self.seconds:.0f} s"
        return (c.name, *asked, self.outcome, rows, *found, power, seconds)


def fault_free(name: str) -> Fine:
    """Run a corner to the beginning of its cool-down without a fault."""
    moments, stage = rehearse(name, cooled=False)
    seen, trips = stage.observer, tuple(f"tripped by {trip}" for trip in stage.ledger.trips)
    wrong = trips + tuple(seen.found.values()) + tuple(stage.invariants.broken.values())
    outcome = "done" if stage.run.engine.executor.finished and not stage.run.reason else stage.mode
    return Fine(
        corners()[name], tuple(moments), outcome, stage.ledger.committed,
        len(list(stage.plan.conditions())), wrong,
        seen.most_n, seen.most_hub_c, seen.most_contact_c, seen.most_power_w, stage.next_s,
    )  # fmt: skip


def rehearse_all(names: Iterable[str], jobs: int) -> Iterable[Fine]:
    """Run corners without a fault, on ``jobs`` processors."""
    if jobs == 1:
        yield from map(fault_free, names)
        return
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(fault_free, names)


def line(cells: Sequence[str]) -> str:
    """Return a line of the table of corners without a fault."""
    return "  ".join(cell.ljust(width) for cell, width in zip(cells, WIDTHS, strict=True)).rstrip()


def faults() -> list[str]:
    """Return every fault to try: those of the catalogue, and those with a range at half of it in both directions."""
    single = [name for name in faults_of_campaign(everything=False) if name not in PARAMETRIC]
    signs = [row.text(row.between(end, 0.5)) for row in PARAMETRIC.values() for end in row.ends]
    return single + signs


def attempt(corners_run: Sequence[Fine], cases: int, jobs: int, texts: Sequence[str] = ("",)) -> Tally:
    """Try a sample of ``cases`` of every fault with one of these texts at every moment of these corners."""
    moments = [moment for one in corners_run for moment in one.moments]
    tried = [name for name in faults() if any(text in name for text in texts)]
    return conduct("limits", sample(all_cases(moments, tried), cases), jobs, parts=1)
