"""Settings that a run measures several times: references, replicates, conditions that a grid measures again.

The measurements of each are compared with each other (``tester.analysis.repeated_settings``); this module words the
result.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import isfinite

from tester.analysis.difference import Difference
from tester.analysis.measurand import Surroundings
from tester.analysis.repeated_settings import (
    LEVEL,
    SettingAgreement,
    SettingMeasurement,
    agreement,
    difference_of,
    measurement,
)
from tester.base.axes import AxisValue, Setpoint, condition_words
from tester.base.words import coefficient
from tester.results.table_rows import Measured

DIFFERENCES_SHOWN = 3
"""Most differences from the first measurement in a line; further ones are in the JSON."""


@dataclass(frozen=True, slots=True)
class RepeatedSetting:
    """A setting with its measurements, in order of time, and whether they agree.

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
        return frozenset(measurement.condition for measurement in self.measurements)

    @property
    def first(self) -> SettingMeasurement:
        """Return the measurement that the others are compared with: the first with a known uncertainty, if there is
        any."""
        return self.found.measurements[0] if self.found is not None else self.measurements[0]

    def differences(self) -> Iterator[tuple[SettingMeasurement, SettingMeasurement, Difference]]:
        """Yield the first usable measurement and each later one, with the difference, later less first."""
        for later in self.found.measurements[1:] if self.found is not None else ():
            yield self.first, later, difference_of(self.first, later)

    def lines(self, worn: str) -> Iterator[str]:
        """Yield the verdict, then the differences, for people; ``worn``: the kind's word for a piece."""
        opening = f"{condition_words(self.held)}: {len(self.measurements)} measurements"
        if self.found is None:
            yield f"{opening}, not held against each other: fewer than two have a known uncertainty"
            return
        test = f"chi-squared {self.found.chi2:.1f}, limit {self.found.limit:.1f} at {100.0 * LEVEL:g} %"
        if self.found.kept:
            yield f"{opening} agree ({test})"
        else:
            yield f"{opening} do not agree ({test}){self._outstanding()}"
        listed = [_difference(*difference, worn) for difference in self.differences()]
        more = len(listed) - DIFFERENCES_SHOWN
        yield "; ".join([*listed[:DIFFERENCES_SHOWN], *([f"{more} more"] if more > 0 else [])])

    def _outstanding(self) -> str:
        """Return the most deviant measurement, in words; "" for two, where neither can be singled out."""
        agreed = self.found
        if agreed is None or agreed.outstanding is None:
            return ""
        i = agreed.outstanding
        deviant, off = agreed.measurements[i], agreed.off[i]
        percent, u_percent = (100.0 * value / (deviant.mu - off) for value in (off, 2.0 * agreed.off_standard[i]))
        what = f"condition {deviant.condition} stands out most, mu {coefficient(deviant.mu)}"
        return f": {what}, {percent:+.1f} ± {u_percent:.1f} % off what the others give"


def _difference(first: SettingMeasurement, second: SettingMeasurement, off: Difference, worn: str) -> str:
    on = f"on one {worn}" if first.piece == second.piece else f"between {worn}s"
    named = f"condition {second.condition} less {first.condition}, {on}"
    return f"{named}: {off.value:+.3f} ± {off.expanded:.3f}"


def settings_of(conditions: Iterable[tuple[Measured, Surroundings]]) -> tuple[RepeatedSetting, ...]:
    """Return the settings that conditions measure several times, in the order of the table.

    Each condition, its result with budgets, comes with the sources of its uncertainty.
    """
    setpoints: dict[tuple[str, tuple[AxisValue, ...]], Setpoint] = {}
    measurements: defaultdict[tuple[str, tuple[AxisValue, ...]], list[SettingMeasurement]] = defaultdict(list)
    for measured, by in conditions:
        info, result = measured.info, measured.result
        setting = info.setpoint.key()
        setpoints.setdefault(setting, info.setpoint)
        if result.ok and isfinite(result.mu):
            measurements[setting].append(measurement(info.condition, measured.last_piece, result, by))
    return tuple(
        RepeatedSetting(setpoints[setting], in_order, agreement(in_order))
        for setting, listed in measurements.items()
        if len(listed) > 1
        for in_order in (tuple(sorted(listed, key=lambda made: made.condition)),)
    )
