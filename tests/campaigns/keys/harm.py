"""Runs at the limits: control has a nonsense value in its rig file, the machine is as packaged."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context

from tester.base.source import InvalidSource
from tester.base.trouble import TroubleError
from tests.campaigns.faults import limits, track
from tests.campaigns.faults.campaign import all_cases, sample
from tests.campaigns.faults.judge import Case, Judge, Verdict
from tests.campaigns.faults.moments import Moment, Twins, moments_of, stage_of, visit
from tests.campaigns.keys.nonsense import Nonsense

RECIPES = {"sim": limits.SHORT_CORNER, "grosch": "slow track", "pin-on-disc": "disc"}
"""The recipe at the limits of each rig."""
MOST_S = 3600.0
"""A run that never gets ready is watched for this long, s of rig time."""


@dataclass(frozen=True, slots=True)
class Tried:
    """A run with a nonsense value: how it ended without a fault, and its harm, with faults and without."""

    nonsense: Nonsense
    ended: str
    cases: int = 0
    harm: tuple[str, ...] = field(default=())


def tried(accepted: Iterable[Nonsense], cases: int, jobs: int) -> Iterator[Tried]:
    """Yield the result of each value; ``cases``: faults that begin in a run with it."""
    work = [(one, cases) for one in accepted]
    if jobs == 1:
        yield from map(_try, work)
        return
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        yield from pool.map(_try, work)


def _try(work: tuple[Nonsense, int]) -> Tried:
    nonsense, cases = work
    recipe, believed = RECIPES[nonsense.rig], (nonsense.text,)
    try:
        stage = stage_of(recipe, believed=believed)
        moments = moments_of(recipe, stage, cooled=False, most_s=MOST_S)
    except (InvalidSource, TroubleError) as error:
        return Tried(nonsense, f"refused: {error}")
    found = [f"no fault: {name}, {text}" for name, text in stage.observer.found.items()]
    verdicts = _faulty(recipe, moments, cases, believed)
    found += [
        f"{' + '.join(one.case.faults)} at {one.case.place}: {text}"
        for one in verdicts
        for text in one.failures
        if text.startswith(("harm", "not safe"))
    ]
    return Tried(nonsense, stage.run.reason or "no trip", len(verdicts), tuple(found))


def _faulty(recipe: str, moments: list[Moment], cases: int, believed: tuple[str, ...]) -> list[Verdict]:
    """Return the harm from faults that begin at moments of such a run."""
    wheel = recipe == limits.SHORT_CORNER
    faults = limits.faults() if wheel else [name for name in track.FAULTS if track.fits(recipe, name)]
    by_moment: dict[Moment, list[tuple[str, ...]]] = {}
    for moment, names in sample(all_cases(moments, faults), cases):
        by_moment.setdefault(moment, []).append(names)
    verdicts: list[Verdict] = []

    def look(moment: Moment, twins: Twins) -> None:
        for names in by_moment[moment]:
            case = Case(recipe, moment.tick, moment.place, names)
            verdicts.append(twins.do(lambda twin, case=case: Judge(twin, case, budgets=False).run()))

    visit(recipe, by_moment, look, believed=believed)
    return verdicts
