"""The campaign: every fault at begin, middle and end of every step of four recipes; samples and pairs of it."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from itertools import combinations

from tests.campaigns.faults.judge import Case, Judge, Verdict
from tests.campaigns.faults.moments import Moment, Twins, rehearse, visit
from tests.campaigns.faults.parametric import ASSEMBLY
from tests.campaigns.faults.recipes import GRID, language_of

SEED = 402
PAIRS = 720
"""Pairs of faults in the full campaign; at least 700 are required."""
PARTS = 8
"""Maximum number of shares of a recipe's cases."""

SAME_AGAIN = (
    "camber", "sideslip drive data", "sideslip drive of", "sideslip drive SDO", "sideslip drive without",
    "wheel drive without", "wheel drive of", "wheel drive SDO", "wheel drive off the bus", "wheel drive reports",
    "press drive of", "press drive SDO", "press drive reports",
    "thermometer garbage", "thermometer replies cut", "thermometer replies of", "thermometer CRC errors",
    "thermometer without", "thermometer line", "jacket garbage", "jacket replies cut", "jacket replies of",
    "jacket CRC errors", "jacket without", "jacket reply late once", "jacket CRC error once",
    "thermometer reply late once", "thermometer CRC error once",
    "sideslip drive heartbeat", "sideslip drive reboots", "wheel drive reboots", "wheel drive heartbeat",
    "wheel drive data",
    "press drive off the bus", "press drive without", "press drive reboots", "press drive following",
    "belt drive reports",
    "load cell replies of", "load cell replies cut", "load cell without", "jacket replies late", "thermometer reset",
    "thermometer exception", "jacket exception", "wheel drive following", "wheel drive torque", "load cell saturated",
    "press drive data", "wheel drive mode", "press drive mode", "thermometer replies merged",
    "thermometer replies split", "jacket replies split", "common cabinet air",
)  # fmt: skip
"""Faults whose phrase begins like this repeat those of another axis or device: left out of the sample, not of the full
grid."""


@dataclass(slots=True)
class Tally:
    """The results of a campaign."""

    name: str
    verdicts: list[Verdict] = field(default_factory=list[Verdict])

    @property
    def failed(self) -> list[Verdict]:
        """Failed cases."""
        return [verdict for verdict in self.verdicts if verdict.failures]

    @property
    def unsafe(self) -> list[Verdict]:
        """Cases with harm, or without a safe end state in time."""
        return [v for v in self.failed if any(not text.startswith("missed budget") for text in v.failures)]

    @property
    def late(self) -> list[Verdict]:
        """Cases that missed a reaction budget."""
        return [v for v in self.failed if any(text.startswith("missed budget") for text in v.failures)]

    def causes(self) -> list[tuple[int, str]]:
        """Return how often each fault failed, with its first failure, most frequent first."""
        counts: Counter[str] = Counter()
        first: dict[str, str] = {}
        for verdict in self.failed:
            name = " + ".join(verdict.case.faults)
            counts[name] += 1
            first.setdefault(name, f"{verdict.case.recipe} {verdict.case.place}: {verdict.failures[0]}")
        return [(count, f"{name}: {first[name]}") for name, count in counts.most_common()]


def all_cases(moments: Iterable[Moment], faults: Sequence[str]) -> list[tuple[Moment, tuple[str, ...]]]:
    """Return every fault at every moment; assembly faults begin at the start only."""
    return [
        (moment, (fault,)) for moment in moments for fault in faults
        if moment.step.startswith("0 ") or not fault.startswith(ASSEMBLY)
    ]  # fmt: skip


def sample(cases: list[tuple[Moment, tuple[str, ...]]], count: int) -> list[tuple[Moment, tuple[str, ...]]]:
    """Return ``count`` cases that together contain every fault and every moment, evenly spread; always the same."""
    chosen = list(cases)
    random.Random(SEED).shuffle(chosen)
    faults: Counter[tuple[str, ...]] = Counter()
    moments: Counter[Moment] = Counter()
    picked: list[tuple[Moment, tuple[str, ...]]] = []
    quota_f = -(-count // max(len({c[1] for c in cases}), 1)) + 1
    quota_m = -(-count // max(len({c[0] for c in cases}), 1)) + 1
    for moment, names in chosen:
        if len(picked) == count:
            break
        if faults[names] < quota_f and moments[moment] < quota_m:
            faults[names] += 1
            moments[moment] += 1
            picked.append((moment, names))
    return picked


def pairs(moments: Sequence[Moment], faults: Sequence[str], count: int) -> list[tuple[Moment, tuple[str, ...]]]:
    """Return ``count`` pairs of faults, every fault about equally often, each at some moment; always the same."""
    chooser = random.Random(SEED)
    every = list(combinations(faults, 2))
    chooser.shuffle(every)
    quota = -(-2 * count // len(faults)) + 1
    used: Counter[str] = Counter()
    picked: list[tuple[Moment, tuple[str, ...]]] = []
    for one, other in every:
        if len(picked) == count:
            break
        if used[one] < quota and used[other] < quota:
            used[one] += 1
            used[other] += 1
            picked.append((chooser.choice(moments), (one, other)))
    return picked


def rehearsals(recipes: Iterable[str] = GRID) -> list[Moment]:
    """Return the moments of these recipes."""
    return [moment for recipe in recipes for moment in rehearse(recipe)[0]]


def faults_of_campaign(*, everything: bool) -> list[str]:
    """Return the faults of the catalogue; without ``everything`` only one of those that differ only in axis or
    device."""
    return [name for name in language_of(GRID[0]).catalogue if everything or not name.startswith(SAME_AGAIN)]


@dataclass(frozen=True, slots=True)
class Share:
    """The part of a campaign that one process does: cases of one recipe."""

    recipe: str
    cases: tuple[tuple[Moment, tuple[str, ...]], ...]
    overrides: tuple[str, ...] = ()
    budgets: bool = True


def do_share(share: Share) -> list[Verdict]:
    """Run the recipe of a share once and judge each of its cases on a copy made during the run."""
    by_tick: dict[Moment, list[tuple[str, ...]]] = {}
    for moment, names in share.cases:
        by_tick.setdefault(moment, []).append(names)
    verdicts: list[Verdict] = []

    def look(moment: Moment, twins: Twins) -> None:
        for names in by_tick[moment]:
            case = Case(share.recipe, moment.tick, moment.place, names)
            verdicts.append(twins.do(lambda twin, case=case: Judge(twin, case, budgets=share.budgets).run()))

    visit(share.recipe, by_tick, look, share.overrides)
    return verdicts


def conduct(
    name: str,
    cases: Sequence[tuple[Moment, tuple[str, ...]]],
    jobs: int = 1,
    overrides: tuple[str, ...] = (),
    *,
    budgets: bool = True,
    parts: int = PARTS,
) -> Tally:
    """Judge every case, on ``jobs`` processors; each share of a recipe, at most ``parts``, runs the recipe again."""
    tally = Tally(name)
    shares = [replace(share, budgets=budgets) for share in _shares(cases, overrides, parts)]
    results = _in_turn(shares) if jobs == 1 else _at_once(shares, jobs)
    for verdicts in results:
        tally.verdicts += verdicts
    return tally


def _shares(
    cases: Sequence[tuple[Moment, tuple[str, ...]]], overrides: tuple[str, ...], parts: int
) -> Iterable[Share]:
    """Cut a campaign into shares of a few dozen moments, so that processors can take turns."""
    by_recipe: dict[str, list[tuple[Moment, tuple[str, ...]]]] = {}
    for case in cases:
        by_recipe.setdefault(case[0].recipe, []).append(case)
    for recipe, mine in by_recipe.items():
        mine.sort(key=_moment_tick)
        size = max(40, -(-len(mine) // parts))
        for start in range(0, len(mine), size):
            yield Share(recipe, tuple(mine[start : start + size]), overrides)


def _moment_tick(case: tuple[Moment, tuple[str, ...]]) -> int:
    return case[0].tick


def _in_turn(shares: Iterable[Share]) -> Iterable[list[Verdict]]:
    for share in shares:
        yield do_share(share)


def _at_once(shares: Sequence[Share], jobs: int) -> Iterable[list[Verdict]]:
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(do_share, shares)

