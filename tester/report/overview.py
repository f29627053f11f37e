"""A campaign at a glance: conditions in order of time, a strip for the coefficient and one for each varied axis."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isfinite

from tester.analysis.pressure import pressure_kpa
from tester.base.axes import condition_words
from tester.base.words import coefficient
from tester.report.chart import Chart, ChartPanel, Look, Mark, Series, series_of
from tester.report.layout import labelled, second_scale
from tester.results.run_results import RunResults
from tester.results.table_rows import Measured
from tester.store.records import StoredRepeat

MINUTES = 1.0 / 60.0


@dataclass(frozen=True, slots=True)
class _Placed:
    """A condition of a run, with the minute of its beginning and its duration; minutes of all runs in a row."""

    at: float
    half: float
    origin: float
    run: str
    measured: Measured


def overview_chart(runs: Sequence[tuple[str, RunResults]]) -> Chart | None:
    """Return the conditions of runs (name and results), one run after the other by rig time; None where none began.

    The bar of a coefficient is U of the mounted piece; repeats that were refused, left out by hand or made up appear
    beside it. Below it is a strip for each numeric axis that varied.
    """
    placed = [*_placed(runs)]
    if not placed:
        return None
    several = len(runs) > 1
    axes = placed[0].measured.info.setpoint.axes
    varied = axes.differing(condition.measured.info.setpoint for condition in placed)
    areas = {pressure_kpa(1.0, results.run.info.metadata) for _, results in runs}
    kpa_per_n = areas.pop() if len(areas) == 1 else None
    strips = [ChartPanel("", tuple(_coefficients(placed, several)), "coefficient")]
    for axis in (each for each in varied if each.plotted and not each.textual):
        marks = [
            Mark(c.at, axis.number(c.measured.info.setpoint), width=c.half, name=_words(c, several)) for c in placed
        ]
        series = series_of("", marks, "measured", 0)
        strips.append(ChartPanel("", (series,), labelled(axis), y_second=second_scale(axis, kpa_per_n)))
    title = f"{'runs, one after the other' if several else 'the run'}: {len(placed)} conditions in order of time"
    note = "bars: U (95 %) of what was mounted; along: from begin to end of a condition"
    name = "overview-of-runs" if several else "overview"
    return Chart(name, title, "rig time (min)", "coefficient", tuple(strips), note, from_zero=False, stacked=True)


def _placed(runs: Sequence[tuple[str, RunResults]]) -> Iterator[_Placed]:
    origin = 0.0
    for name, results in runs:
        for condition in sorted(results.conditions(), key=lambda found: found.condition.started_s):
            begin, end = condition.condition.started_s, condition.condition.ended_s
            if isfinite(begin):
                end = end if isfinite(end) else begin
                yield _Placed(
                    origin + 0.5 * (begin + end) * MINUTES, 0.5 * (end - begin) * MINUTES, origin, name, condition
                )
        origin += results.run.rig_seconds * MINUTES


def _words(placed: _Placed, several: bool) -> str:
    result = placed.measured.result
    of = f"{placed.run}: " if several else ""
    setpoints = f"{of}condition {placed.measured.info.condition}, {condition_words(placed.measured.info.setpoint)}"
    if not result.ok:
        return setpoints
    return f"{setpoints}: {coefficient(result.mu)}\u00a0±\u00a0{coefficient(result.budget.expanded)}"


def _coefficients(placed: Sequence[_Placed], several: bool) -> Iterator[Series]:
    """Yield the coefficients, a series for each compound, then single repeats that are left out or make-ups."""
    compounds = sorted({condition.measured.info.compound for condition in placed})
    for style, compound in enumerate(compounds):
        of_compound = [
            Mark(condition.at, result.mu, result.budget.expanded, condition.half, _words(condition, several))
            for condition in placed
            if condition.measured.info.compound == compound and (result := condition.measured.result).ok
        ]
        if of_compound:
            yield series_of(compound, of_compound, "measured", style)
    style = len(compounds)
    out = [(c, repeat) for c in placed for repeat in c.measured.repeats if c.measured.exclusion(repeat)]
    made_up = [(c, repeat) for c in placed for repeat in c.measured.make_ups if not c.measured.exclusion(repeat)]
    looks: tuple[tuple[str, list[tuple[_Placed, StoredRepeat]], Look], ...] = (
        ("make-up repeat", made_up, "published"),
        ("repeat left out", out, "left out"),
    )
    for label, listed, look in looks:
        marks = [
            Mark(c.origin + result.ended_s * MINUTES, result.mu_resultant, name=_of_repeat(c.measured, repeat))
            for c, repeat in listed
            if isfinite((result := repeat.result).mu_resultant)
        ]
        if marks:
            yield series_of(label, marks, look, style)
            style += 1


def _of_repeat(measured: Measured, repeat: StoredRepeat) -> str:
    reason = measured.exclusion(repeat)
    value = f"repeat {repeat.condition}/{repeat.repeat}: {coefficient(repeat.result.mu_resultant)} as measured"
    return f"{value}, {reason}" if reason else f"{value}, a make-up"
