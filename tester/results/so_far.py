"""A condition's coefficient as it grows: after each of its repeats, and in the repeat under way.

Every output that shows a value before its condition has ended takes it from here. After the last repeat it is the
condition's row in the table, to the last digit. U needs a scatter to be computed from: that of the condition's own
repeats, or that of conditions that have ended. Without either there is none.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite

from tester.analysis.blocks import blocks_from_samples
from tester.analysis.left_out import combining_of
from tester.analysis.measurand import with_budget
from tester.analysis.reduce import reduce_repeat
from tester.analysis.results import RepeatStatus
from tester.analysis.stability import Window
from tester.base.quantities import KEY
from tester.results.conditions_table import ConditionRow
from tester.results.run_results import RunResults, combined, surroundings_of
from tester.results.table_rows import Measured
from tester.store.run_reader import RunReader


@dataclass(frozen=True, slots=True)
class OpenRepeat:
    """The repeat under way: its coefficient as measured so far, over ``revolutions`` whole accepted blocks."""

    condition: int
    repeat: int
    mu: float
    revolutions: int


def growth(reader: RunReader, results: RunResults, row: ConditionRow) -> list[ConditionRow]:
    """Return a condition's row of the table after its first repeat, its second ...; the last is ``row`` itself.

    Each is what the record now shows of those repeats: the drift judged over all of them, the scatter pooled over all
    conditions that have ended, exclusions by a person. Repeats without a coefficient give no row. Raises StoreError.
    """
    measured = row.measured
    if measured is None or not measured.repeats:
        return []
    rows = [*_before(reader, results, row, measured), row]
    return [one for one in rows if isfinite(one.result.mu)]


def _before(reader: RunReader, results: RunResults, row: ConditionRow, measured: Measured) -> list[ConditionRow]:
    """Return the rows after fewer repeats than there are."""
    if len(measured.repeats) < 2:
        return []
    run, every = results.run, list(results.conditions())
    surroundings = surroundings_of(reader, run, every, results.pieces, results.checks)
    combining = combining_of(run.info.metadata)
    found: list[ConditionRow] = []
    for count in range(1, len(measured.repeats)):
        repeats = measured.repeats[:count]
        result = combined(replace(measured.condition, status=None), repeats, measured.by_hand, combining)
        result = with_budget(result, surroundings.of(measured.info, repeats, result))
        found.append(replace(row, result=result, measured=replace(measured, repeats=repeats, result=result)))
    return found


def open_repeat(reader: RunReader) -> OpenRepeat | None:
    """Return the repeat under way from the samples that are on record; None before its first whole block.

    It is reduced as at its end: means over whole blocks, after the transient. Raises StoreError.
    """
    last = max(reader.repeats(attempts=True), key=lambda repeat: repeat.key, default=None)
    if last is None or last.result.status is not RepeatStatus.OPEN:
        return None
    info = next(stored.info for stored in reader.conditions() if stored.info.condition == last.condition)
    samples = reader.samples(last.condition, last.repeat, last.attempt)
    if not len(samples[KEY]):
        return None
    blocks = blocks_from_samples(samples, reader.quantities())
    found = reduce_repeat(blocks, Window(info.window_revolutions, info.window_s), rolling=True)
    if not isfinite(found.mu_resultant):
        return None
    return OpenRepeat(last.condition, last.repeat, found.mu_resultant, found.revolutions)
