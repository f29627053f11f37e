"""Abort, stop, hold, emergency stop and kill at every scan of a short recipe."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

from tests.campaigns.faults.campaign import Tally
from tests.campaigns.faults.judge import Case, Judge, Verdict
from tests.campaigns.faults.moments import Moment, Twins, rehearse, visit

NAME = "short"
"""The recipe (tests.campaigns.faults.recipes)."""
EVENTS = ("operator abort", "operator fast stop", "process killed", "emergency stop pressed", "operator hold")
ASKED_FOR = 5000
"""Injection points for each of abort, stop and kill."""


def scans() -> int:
    """Return how many ticks the short recipe has, from its first to the end of its run, power off."""
    return rehearse(NAME)[1].ticks


@dataclass(frozen=True, slots=True)
class Share:
    """Ticks of the recipe at which one process injects."""

    ticks: tuple[int, ...]
    events: tuple[str, ...]


def do_share(share: Share) -> list[Verdict]:
    """Run the recipe once and inject every event at each of the ticks."""
    verdicts: list[Verdict] = []

    def look(moment: Moment, twins: Twins) -> None:
        for event in share.events:
            case = Case(NAME, moment.tick, moment.place, (event,))
            verdicts.append(twins.do(lambda twin, case=case: Judge(twin, case).run()))

    visit(NAME, [Moment(NAME, tick, "scan", str(tick)) for tick in share.ticks], look)
    return verdicts


def conduct(ticks: Sequence[int], events: Sequence[str] = EVENTS, jobs: int = 1) -> dict[str, Tally]:
    """Inject every event at every one of the ticks; return a tally for each event."""
    parts = max(jobs, 1) * (1 if len(ticks) < 200 else 4)
    size = -(-len(ticks) // parts)
    shares = [Share(tuple(ticks[start : start + size]), tuple(events)) for start in range(0, len(ticks), size)]
    tallies = {event: Tally(f"{event} at every scan") for event in events}
    for verdicts in _results(shares, jobs):
        for verdict in verdicts:
            tallies[verdict.case.faults[0]].verdicts.append(verdict)
    return tallies


def _results(shares: Sequence[Share], jobs: int) -> Iterable[list[Verdict]]:
    if jobs == 1:
        yield from map(do_share, shares)
        return
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(do_share, shares)
