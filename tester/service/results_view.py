"""The message ``results``: what the conditions of the run under way have given, and the present one as it grows."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ConditionValue:
    """What a condition has given, as every table has it. ``text``: mu with its mark and U, or its status where it has
    no value. ``u``: expanded uncertainty of what is mounted. ``over``: whether the run has ended it.
    """

    condition: int
    mu: float | None
    u: float | None
    text: str
    doubt: str
    over: bool


@dataclass(frozen=True, slots=True)
class GrownValue:
    """A condition after its first ``repeats`` repeats; ``u`` is None where there is no scatter to compute it from."""

    repeats: int
    mu: float | None
    u: float | None
    text: str


@dataclass(frozen=True, slots=True)
class OpenValue:
    """The repeat under way: mu as measured over its ``revolutions`` whole accepted blocks; its end alone gives a U."""

    repeat: int
    mu: float
    revolutions: int


@dataclass(frozen=True, slots=True)
class GrowingView:
    """The condition under way: its set points in words, repeats asked for, its value after each repeat, the repeat
    under way.
    """

    condition: int
    words: str
    asked: int
    grown: tuple[GrownValue, ...]
    open: OpenValue | None


@dataclass(frozen=True, slots=True)
class GivenResults:
    """The results of a run: conditions that have begun, by number; ``over``: whether no process works on the run."""

    run: str
    conditions: tuple[ConditionValue, ...]
    growing: GrowingView | None
    over: bool

    def of(self, condition: int) -> ConditionValue | None:
        """Return what a condition has given; None for one that has not begun."""
        return next((one for one in self.conditions if one.condition == condition), None)
