"""Settings that a run measures several times: references, replicates, conditions that a grid measures again.

The measurements of each are held against each other (``tester.analysis.settings``); what is found is worded here, once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

from tester.analysis.difference import Difference
from tester.analysis.measurand import Surroundings
from tester.analysis.repeats import ConditionResult
from tester.analysis.settings import (
    LEVEL,
    SettingAgreement,
    SettingMeasurement,
    agreement,
    difference_of,
    measurement,
)
from tester.base.axes import AxisValue, Setpoint, condition_words
from tester.base.words import coefficient
from tester.store.records import ConditionInfo, StoredRepeat

DIFFERENCES_SHOWN = 3
"""Differences from the first measurement that a line gives; further ones are in the JSON."""


@dataclass(frozen=True, slots=True)
class RepeatedSetting:
    """A setting with its measurements, in the order in which they were made, and whether they agree.

    ``found`` None: fewer than two of them have a value with a known uncertainty.
    """

    held: Setpoint
    measurements: tuple[SettingMeasurement, ...]
    found: SettingAgreement | None

    @property
    def disagrees(self) -> bool:
        """Return whether the measurements differ by more than their uncertainties allow."""
        return self.found is not None and not self.found.kept

    @property
    def conditions(self) -> frozenset[int]:
        """Return the numbers of its conditions."""
        return frozenset(one.condition for one in self.measurements)

    @property
    def first(self) -> SettingMeasurement:
        """Return the measurement from which the others differ: the first with a known uncertainty, if there is any."""
        return self.found.measurements[0] if self.found is not None else self.measurements[0]

    def differences(self) -> Iterator[tuple[SettingMeasurement, SettingMeasurement, Difference]]:
        """Yield the first measurement that is usable and each later one, with the later less the first."""
        for one in self.found.measurements[1:] if self.found is not None else ():
            yield self.first, one, difference_of(self.first, one)

    def lines(self, worn: str) -> Iterator[str]:
        """Yield the verdict, then the differences, for people; ``worn``: what they call a piece."""
        held = f"{condition_words(self.held)}: {len(self.measurements)} measurements"
        if self.found is None:
            yield f"{held}, not held against each other: fewer than two have a known uncertainty"
            return
        test = f"chi-squared {self.found.chi2:.1f}, limit {self.found.limit:.1f} at {100.0 * LEVEL:g} %"
        if self.found.kept:
            yield f"{held} agree ({test})"
        else:
            yield f"{held} do not agree ({test}){self._outstanding()}"
        listed = [_difference(*one, worn) for one in self.differences()]
        more = len(listed) - DIFFERENCES_SHOWN
        yield "; ".join([*listed[:DIFFERENCES_SHOWN], *([f"{more} more"] if more > 0 else [])])

    def _outstanding(self) -> str:
        """Return which measurement stands out most, in words; of two it cannot be told."""
        found = self.found
        if found is None or found.outstanding is None:
            return ""
        i = found.outstanding
        one, off = found.measurements[i], found.off[i]
        percent, u_percent = (100.0 * value / (one.mu - off) for value in (off, 2.0 * found.off_standard[i]))
        what = f"condition {one.condition} stands out most, mu {coefficient(one.mu)}"
        return f": {what}, {percent:+.1f} ± {u_percent:.1f} % off what the others give"


def _difference(first: SettingMeasurement, second: SettingMeasurement, off: Difference, worn: str) -> str:
    on = f"on one {worn}" if first.piece == second.piece else f"between {worn}s"
    told = f"condition {second.condition} less {first.condition}, {on}"
    return f"{told}: {off.value:+.3f} ± {off.expanded:.3f}"


class SettingsOf:
    """Gathers the conditions of a run by their settings; ``add`` each with the budget that it comes with."""

    def __init__(self) -> None:
        """Know no setting yet."""
        self._found: dict[tuple[str, tuple[AxisValue, ...]], list[SettingMeasurement]] = {}
        self._held: dict[tuple[str, tuple[AxisValue, ...]], Setpoint] = {}

    def add(
        self, info: ConditionInfo, repeats: Sequence[StoredRepeat], result: ConditionResult, by: Surroundings
    ) -> None:
        """Take a condition in, with its result and what the uncertainty of that comes from."""
        held = info.setpoint
        setting = held.compound, tuple(axis.of(held) for axis in held.axes)
        self._held.setdefault(setting, held)
        if not (result.ok and isfinite(result.mu)):
            return
        pieces = [one.piece for one in repeats if one.result.valid]
        found = measurement(info.condition, pieces[-1] if pieces else 0, result, by)
        self._found.setdefault(setting, []).append(found)

    def repeated(self) -> tuple[RepeatedSetting, ...]:
        """Return the settings that were measured several times, in the order of the table."""
        return tuple(
            RepeatedSetting(self._held[setting], in_order, agreement(in_order))
            for setting, listed in self._found.items()
            if len(listed) > 1
            for in_order in (tuple(sorted(listed, key=lambda one: one.condition)),)
        )


def in_doubt(settings: Sequence[RepeatedSetting]) -> Mapping[int, RepeatedSetting]:
    """Return the conditions, by number, whose setting does not agree with itself."""
    return {number: one for one in settings if one.disagrees for number in one.conditions}
