"""The conditions of a run with their results, and the rows of the recipe's table that they make."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite

from tester.analysis.flags import remedy_of
from tester.analysis.repeats import ConditionResult
from tester.analysis.results import ConditionStatus, SoakCheck
from tester.base.axes import condition_words
from tester.store.journal_records import StoredExclusion
from tester.store.records import ConditionInfo, StoredCondition, StoredRepeat


@dataclass(frozen=True, slots=True)
class Measured:
    """One condition of the plan with its repeats and their result."""

    condition: StoredCondition
    repeats: tuple[StoredRepeat, ...]
    result: ConditionResult
    by_hand: Mapping[int, StoredExclusion]
    """Exclusions by a person, by position in ``repeats``."""
    soak: SoakCheck | None = None
    """The surface's thermometer after the soak; None without a record of it."""

    @property
    def info(self) -> ConditionInfo:
        """Return the condition's setpoints."""
        return self.condition.info

    @property
    def begun(self) -> bool:
        """Return whether the run has begun this condition, or ended it without."""
        return isfinite(self.condition.started_s) or self.condition.status is not None

    @property
    def last_piece(self) -> int:
        """Return the piece of the last valid repeat, 0 without one."""
        return next((repeat.piece for repeat in reversed(self.repeats) if repeat.result.valid), 0)

    def exclusion(self, repeat: StoredRepeat) -> str:
        """Return why a repeat is not in the mean, an empty text if it is."""
        position = self.repeats.index(repeat)
        return next((e.reason for e in self.result.excluded if e.position == position), "")

    @property
    def make_ups(self) -> list[StoredRepeat]:
        """Return the repeats made in place of refused ones; of pairs, both repeats of each."""
        each = self.result.repeats_each
        return [repeat for i, repeat in enumerate(self.repeats) if i // each in self.result.counts.make_ups]

    def left_out_by(self, repeat: StoredRepeat) -> StoredExclusion | None:
        """Return a person's exclusion of a repeat, None without one."""
        return self.by_hand.get(self.repeats.index(repeat))


@dataclass(frozen=True, slots=True)
class TableRow:
    """A row of the recipe's table: its replicates, and their value."""

    replicates: tuple[Measured, ...]
    result: ConditionResult

    @property
    def info(self) -> ConditionInfo:
        """Return the setpoints, those of the first replicate."""
        return self.replicates[0].info

    @property
    def tried(self) -> bool:
        """Return whether the run reached this row: a repeat, or the reason for its absence, is on record."""
        return self.result.status is not ConditionStatus.PENDING or any(m.repeats for m in self.replicates)

    def describe(self) -> str:
        """Return the row's setpoints and why it has no value, as a line for people."""
        parts = [self.result.status.value, self.result.reason]
        for measured in self.replicates:
            c = measured.condition
            if not measured.result.ok and isfinite(c.warming_k_s) and not c.reason:
                parts.append(f"warming {c.warming_k_s:.2g} K/s; {c.holdable_band_k:.2g} K of band would do")
        return ": ".join([condition_words(self.info.setpoint), *[part for part in parts if part]])

    def advise(self) -> str:
        """Return the row's problem or doubts, and the remedy, for people."""
        sentence = self.describe()
        if self.result.ok:
            sentence = f"{sentence}: {', '.join(self.result.doubts)}"
        advice = remedy(self.result)
        return f"{sentence}: {advice}" if advice else sentence


_WHAT_TO_DO: Mapping[ConditionStatus, str] = {
    ConditionStatus.CANNOT_HOLD: "a wider temperature_band, a lower load or a lower speed would help",
    ConditionStatus.NOT_REACHED: "check heating and cooling, or allow more time (soak.at_most)",
    ConditionStatus.INSUFFICIENT: "a wider temperature_band or more max_bursts would help",
    ConditionStatus.PENDING: "tester resume continues the run",
}


def remedy(result: ConditionResult) -> str:
    """Return the remedy for a condition without a value, or with one that needs care; "" where none is needed."""
    if not result.ok:
        return _WHAT_TO_DO.get(result.status, "")
    return remedy_of(result.doubts)
