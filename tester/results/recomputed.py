"""Whether a run's figures follow from its record: every coefficient from its samples, every table from the record."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from io import BytesIO, StringIO
from itertools import zip_longest
from math import isclose, isfinite, isnan
from pathlib import Path

from tester.analysis.blocks import blocks_from_samples
from tester.analysis.flags import ROLLING, flags_in
from tester.analysis.reduce import reduce_repeat
from tester.analysis.results import RepeatResult, RepeatStatus
from tester.analysis.stability import Window
from tester.analysis.swing import swing_of
from tester.analysis.trace import Trace
from tester.results.formats import FORMATS, Record
from tester.store.records import ConditionInfo, StoredRepeat
from tester.store.run_reader import RunReader

TOLERANCE = 1e-9
"""Relative. Doubles are stored exactly, but a mean over a revolution is summed in another order, and times of merged
parts are put back on a grid of a microsecond."""

LOOSER = 1e-3
"""Relative, for figures that depend on the samples' times: the grid of merged parts moves them by less than this."""
_LOOKED_AT = ("change_percent", "swing_percent", "swing_hz", "swing_skewness")
_FIGURES = ("mu_resultant", "mu_longitudinal", "mu_lateral")


def coefficient_problems(reader: RunReader) -> tuple[int, list[str]]:
    """Recompute every repeat that has a coefficient; return how many, and the contradictions.

    A coefficient without samples, as a sweep records them, is a contradiction: nothing supports it. Raises StoreError.
    """
    measured = [repeat for repeat in reader.repeats(attempts=True) if isfinite(repeat.result.mu_resultant)]
    if measured and not reader.count("sample_block", "repeat_id > 0"):
        return 0, [f"run.db: no samples, so that none of {len(measured)} coefficients can be recomputed"]
    infos = {stored.info.condition: stored.info for stored in reader.conditions()}
    problems: list[str] = []
    for repeat_ in measured:
        problems += _differing(repeat_, _recomputed(reader, repeat_, infos[repeat_.condition]))
    return len(measured), problems


def _recomputed(reader: RunReader, stored_repeat: StoredRepeat, info: ConditionInfo) -> RepeatResult:
    samples = reader.samples(stored_repeat.condition, stored_repeat.repeat, stored_repeat.attempt)
    rolling = ROLLING in flags_in(stored_repeat.result.flags)
    trace = Trace(reader.quantities())
    blocks = blocks_from_samples(samples, reader.quantities(), trace)
    swing = None if rolling else swing_of(trace)
    return reduce_repeat(blocks, Window(info.window_revolutions, info.window_s), rolling=rolling, swing=swing)


def _differing(stored_repeat: StoredRepeat, again: RepeatResult) -> Iterator[str]:
    place = f"repeat {stored_repeat.condition}/{stored_repeat.repeat}, attempt {stored_repeat.attempt}"
    if not isfinite(again.mu_resultant):
        yield f"{place}: its samples give no coefficient, on record is {stored_repeat.result.mu_resultant:.6g}"
        return
    on_record, by_samples = _figures(stored_repeat.result), _figures(again)
    for name, stored in on_record.items():
        computed = by_samples[name]
        if not isclose(stored, computed, rel_tol=TOLERANCE, abs_tol=TOLERANCE) and (
            isfinite(stored) or isfinite(computed)
        ):
            yield f"{place}: {name} is {computed:.6g} by its samples, on record is {stored:.6g}"
    for name in _LOOKED_AT:
        stored, computed = getattr(stored_repeat.result, name), getattr(again, name)
        if not isclose(stored, computed, rel_tol=LOOSER, abs_tol=LOOSER) and not (isnan(stored) and isnan(computed)):
            yield f"{place}: {name} is {computed:.6g} by its samples, on record is {stored:.6g}"
    if stored_repeat.result.revolutions != again.revolutions:
        earlier = stored_repeat.result.revolutions
        yield f"{place}: {again.revolutions} revolutions by its samples, on record are {earlier}"
    if stored_repeat.result.status is RepeatStatus.VALID and again.status is not RepeatStatus.VALID:
        yield f"{place}: {again.status.value} by its samples ({again.reason}), on record is valid"


def _figures(result: RepeatResult) -> dict[str, float]:
    return {name: getattr(result, name) for name in _FIGURES} | dict(result.means)


def table_problems(folder: Path, record: Record) -> Iterator[tuple[str, str]]:
    """Yield the tables of a folder that differ from the record, each with a line that describes it."""
    for kind in FORMATS.values():
        path = folder / kind.file
        if kind.kept is not None and path.is_file():
            made = BytesIO()
            kind.write(record, made)
            try:
                difference = _first_difference(path.read_text("utf-8-sig"), made.getvalue().decode("utf-8-sig"))
            except (UnicodeDecodeError, csv.Error):
                difference = "it cannot be read"
            if difference:
                yield kind.file, f"{kind.file}: differs from the record: {difference}"


def _first_difference(there: str, by_record: str) -> str:
    def read(text: str) -> Iterable[list[str]]:
        return csv.reader(StringIO(text))

    for number, (row, expected) in enumerate(zip_longest(read(there), read(by_record)), start=1):
        if row != expected:
            return f"row {number}"
    return ""
