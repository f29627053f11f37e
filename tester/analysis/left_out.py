"""Which repeats of a condition are left out of its mean, and why; and how many were requested, made and valid.

A repeat is left out automatically only on objective grounds: a gate or the drift test (module ``judge``) made it
invalid, or it fluctuates in excess, by Cochran's C (1 %) and by a variation within its window of more than three times
its siblings' median and of more than 1 %. A value far from the others is flagged and stays: leaving out values that
disagree makes any machine look precise (the closest two of three show a third of the true scatter). Repeats that a
person leaves out, with the reason on record, are flagged ``excluded``.

The paper's mean of the closest two of three repeats is used only on request (``combine: paper``): Polymers 2024, 16(5),
596, doi 10.3390/polym16050596 (CC BY 4.0), 2.2.2. It looks more precise but is less precise: it scatters 1.38 times as
much as the mean of all, and those two differ by a third of the true scatter. So the deviation between repeats stays
that of all three, and the uncertainty of the mean is that of this mean.

Every count in the program comes from this module. The counted items are those that make a value: repeats; pairs of
repeats where both directions are measured; replicates for the row of their mean.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from statistics import median
from types import MappingProxyType
from typing import Final, Literal

from tester.analysis.quantiles import f_quantile
from tester.analysis.results import RepeatResult

COCHRAN_ALPHA = 0.01
"""Level at which ISO 5725-2 calls a variance an outlier."""

EXCESS_FACTOR = 3.0
"""A repeat fluctuates in excess if it varies by more than this times its siblings' median [A] ..."""

EXCESS_PERCENT = 1.0
"""... and by more than this, per cent: on a quiet rig three times a negligible variation is negligible [A]."""

BY_HAND = "excluded by hand"
"""Begins the reason of a person's exclusion."""
NOT_CLOSEST = "not one of the closest two of three"
"""Why a valid repeat is in no mean where the recipe combines the paper's way."""

NONE_BY_HAND: Mapping[int, str] = MappingProxyType({})

OUTLIER_SIGMAS = 3.5
REPEATABILITY = 0.02
"""Historic standard deviation between repeats as a share of the coefficient [A]."""

Combining = Literal["mean", "paper"]

COMBINE: Final = "combine"
"""Key of a run's metadata that stores the recipe's choice."""
CLOSEST_OF: Final = 3
"""With this number of repeats the closest two are averaged, with any other number all of them."""
CLOSEST_STANDARD: Final = 0.798
"""Standard deviation of the mean of the closest two of three normal values, relative to that of a single value (400,000
draws); for the mean of all three it is 0.577."""


@dataclass(frozen=True, slots=True)
class Exclusion:
    """A repeat left out of the mean: its position in the sequence, from 0, and the reason."""

    position: int
    reason: str


def cochran_critical(groups: int, df: float, alpha: float = COCHRAN_ALPHA) -> float:
    """Return the critical value of Cochran's C for ``groups`` (>= 2) variances of ``df`` degrees of freedom."""
    f = f_quantile(1.0 - alpha / groups, df, (groups - 1) * df)
    return f / (f + groups - 1.0)


def excess_fluctuation(results: Sequence[RepeatResult]) -> int | None:
    """Return the position of the repeat that fluctuates in excess of its siblings, None if there is none.

    Needs three repeats: of two, neither can be identified as the odd one.
    """
    spreads = [result.fluctuation_percent * result.mu_resultant for result in results]
    df = min((result.batches for result in results), default=0) - 1
    if len(results) < 3 or df < 1 or not all(map(isfinite, spreads)):
        return None
    worst = max(range(len(spreads)), key=spreads.__getitem__)
    total = sum(spread * spread for spread in spreads)
    if total <= 0.0 or spreads[worst] ** 2 / total <= cochran_critical(len(spreads), df):
        return None
    siblings = [result.fluctuation_percent for i, result in enumerate(results) if i != worst]
    limit = max(EXCESS_FACTOR * median(siblings), EXCESS_PERCENT)
    return worst if results[worst].fluctuation_percent > limit else None


def counting(results: Sequence[RepeatResult]) -> list[int]:
    """Return the positions of the repeats that count: valid, and not fluctuating in excess of the others."""
    left_out = {exclusion.position for exclusion in exclusions(results)}
    return [i for i in range(len(results)) if i not in left_out]


def exclusions(results: Sequence[RepeatResult], by_hand: Mapping[int, str] = NONE_BY_HAND) -> list[Exclusion]:
    """Return the repeats that do not count, in order, each with the reason.

    ``by_hand``: positions that a person has left out, each with the person's reason.
    """
    excluded = [Exclusion(i, f"{BY_HAND}: {reason}") for i, reason in by_hand.items()]
    excluded += [
        Exclusion(i, f"{result.status.value}{': ' + result.reason if result.reason else ''}")
        for i, result in enumerate(results)
        if not result.valid and i not in by_hand
    ]
    kept = [i for i, result in enumerate(results) if result.valid and i not in by_hand]
    # Excess fluctuation is relative to the siblings, so the test is repeated after each exclusion.
    while True:
        worst = excess_fluctuation([results[i] for i in kept])
        if worst is None:
            return sorted(excluded, key=lambda exclusion: exclusion.position)
        position = kept.pop(worst)
        percent = results[position].fluctuation_percent
        excluded.append(Exclusion(position, f"fluctuates by {percent:.1f} %, in excess of the other repeats"))


def outliers(values: Sequence[float]) -> list[int]:
    """Return the positions of values more than 3.5 historic standard deviations from the median."""
    if len(values) < 3:
        return []
    middle = median(values)
    limit = OUTLIER_SIGMAS * REPEATABILITY * abs(middle)
    return [i for i, value in enumerate(values) if abs(value - middle) > limit]


def combining_of(metadata: Mapping[str, str]) -> Combining:
    """Return how the recipe of a run combines its repeats."""
    return "paper" if metadata.get(COMBINE) == "paper" else "mean"


def taken(values: Sequence[float], combining: Combining) -> list[int]:
    """Return the positions of the values that enter the mean: all of three where their distances are equal."""
    every = list(range(len(values)))
    if combining != "paper" or len(values) != CLOSEST_OF:
        return every
    low, middle, high = sorted(every, key=values.__getitem__)
    below, above = values[middle] - values[low], values[high] - values[middle]
    if below == above:
        return every
    return sorted((low, middle) if below < above else (middle, high))


REPEATS: Final = "repeats"
PAIRS: Final = "pairs"
REPLICATES: Final = "replicates"


@dataclass(frozen=True, slots=True)
class Counts:
    """Counts of a condition: ``made`` is always ``valid`` plus ``left_out``.

    ``asked``: the least number that the recipe requests. ``valid``: those in the mean. ``make_ups``: places among
    ``made``, from 0, of those that replace refused ones.
    """

    asked: int = 0
    made: int = 0
    valid: int = 0
    make_ups: tuple[int, ...] = ()
    of: str = REPEATS

    @property
    def left_out(self) -> int:
        """Return how many are in no mean: refused, left out by hand, or not chosen."""
        return self.made - self.valid

    @property
    def made_up(self) -> int:
        """Return how many were made in place of refused ones."""
        return len(self.make_ups)

    @property
    def words(self) -> str:
        """Return valid of requested, as text: ``3 of 3``."""
        return f"{self.valid} of {self.asked}"


NO_COUNTS: Final = Counts()


def make_ups_of(asked: int, made: int, refused: Collection[int]) -> tuple[int, ...]:
    """Return the places, from 0, of make-ups among ``made``: each replaces a refused one before it.

    Repeats beyond ``asked`` that replace none serve precision or the drift test: they are no make-ups.
    """
    owed, make_ups = 0, list[int]()
    for place in range(made):
        if place >= asked and owed:
            owed -= 1
            make_ups.append(place)
        owed += place in refused
    return tuple(make_ups)
