"""A fit in lines for people."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from tester.fit.check import Errors
from tester.fit.joint import GroupFit, Overall
from tester.fit.law import Law, Variable
from tester.fit.part import PublishedTable, TableLine
from tester.fit.trends import Interval, Trend

_HEADER = f"{'errors':<34} rows  mean %  median %   max %  within 5 %  within 10 %"


def error_row(title: str, errors: Errors) -> str:
    """Return a row of the table of errors."""
    if not errors.rows:
        return f"{title:<34}    0       -         -       -           -            -"
    mean, middle, largest = (100.0 * one for one in (errors.mean, errors.median, errors.largest))
    return (
        f"{title:<34} {errors.rows:>4}  {mean:>6.2f}  {middle:>8.2f}  {largest:>6.1f}  "
        f"{errors.near:>10}  {errors.far:>11}"
    )


def group_lines(fit: GroupFit, validation: Errors | None) -> Iterator[str]:
    """Yield what is known of the fit of a group; ``validation``: its errors on other conditions."""
    sources = ", ".join(dict.fromkeys(one.source.name for one in fit.points))
    yield f"{fit.group}: {len(fit.points)} conditions of {sources}"
    yield from _parameter_lines(fit)
    yield f"  {_HEADER}"
    yield f"  {error_row('conditions that were fitted', fit.errors)}"
    kept = f", {fit.cells_kept} kept" if fit.cells_kept else ""
    yield f"  {error_row(f'{_cell_words(fit)} left out{kept}', fit.left_out)}"
    if validation is not None:
        yield f"  {error_row('validation', validation)}"
    yield "  mean residual, measured over fitted:"
    for variable, found in zip(fit.law.variables, fit.residuals, strict=True):
        told = ", ".join(f"{variable.words(one.value)} {100.0 * one.mean:+.1f} % ({one.count})" for one in found)
        yield f"    {told}"
    yield f"  {_lack_words(fit)}"


def _parameter_lines(fit: GroupFit) -> Iterator[str]:
    yield "  parameter        value  95 % interval over conditions"
    for one, value, interval in zip(fit.law.parameters, fit.parameters, fit.intervals, strict=True):
        told = "held" if one.name in fit.held else _interval(interval)
        yield f"  {one.name:<6} {value:>15.6g}  {told} {one.unit}".rstrip()
    if fit.law.table is not None:
        told = ", ".join(f"{name} {value:.5g}" for name, value in fit.law.table(fit.parameters).items())
        yield f"  {fit.law.table_title}: {told}"
        yield f"  {fit.law.caution}"
    drawn = f"{len(fit.resamples.parameters)} of {fit.resamples.drawn} resamples could be fitted"
    yield f"  condition number {fit.condition_number:.3g}; {drawn}"
    if fit.few:
        yield "  few conditions for so many parameters: the intervals are rather too narrow"


def _cell_words(fit: GroupFit) -> str:
    return f"one ({', '.join(fit.law.variables[i].name for i in fit.cells)})"


def _lack_words(fit: GroupFit) -> str:
    lack = fit.lack
    residual = f"residual standard deviation {100.0 * lack.residual:.1f} %"
    if lack.shown is None:
        return f"lack of fit: {residual}; no repeats are known, so how much of it is scatter cannot be told"
    compared = f"F {lack.f:.1f}, 95 % of chance below {lack.critical:.1f}"
    verdict = "the law leaves more than repeats scatter" if lack.shown else "no more than repeats scatter"
    between = f"; between conditions {100.0 * fit.scatter:.1f} %" if lack.shown else ""
    return f"lack of fit: {residual}, of means of repeats {100.0 * lack.repeats:.1f} %: {compared}: {verdict}{between}"


def trend_lines(fits: Sequence[GroupFit]) -> Iterator[str]:
    """Yield peaks, exponents and signs of the trends of all groups."""
    for fit in fits:
        at = ", ".join(v.words(x) for v, x in zip(fit.law.variables, fit.trends.at, strict=True))
        yield f"{fit.group}, at {at} but for what is varied (95 % intervals):"
        for trend in fit.trends.each:
            yield f"  {trend.variable.name:<12} {trend.word}"
            yield f"  {'':<12} {_peak_words(trend)}; {_slope_words(trend)}"


def _peak_words(trend: Trend) -> str:
    v = trend.variable
    between = f"between {v.words(trend.low)} and {v.words(trend.high)}"
    if trend.peak != trend.peak:
        return f"no peak {between}" + (f" (in {trend.inside:.0%} of resamples)" if trend.inside else "")
    low, high = trend.peak_interval
    told = f"peak at {v.scale * trend.peak:.4g} {v.unit} ({v.scale * low:.4g} to {v.scale * high:.4g})"
    return told if trend.inside >= 1.0 else f"{told}, inside the range in {trend.inside:.0%} of resamples"


def _slope_words(trend: Trend) -> str:
    if trend.variable.ratio:
        return f"exponent {trend.exponent:+.3f} {_paired(trend.exponent_interval, 1.0, '.3f')}"
    per_cent = 100.0 / trend.variable.scale
    interval = _paired(trend.exponent_interval, per_cent, ".2f")
    return f"{per_cent * trend.exponent:+.2f} %/{_difference(trend.variable)} {interval}"


def _difference(variable: Variable) -> str:
    return {"degC": "K"}.get(variable.unit, variable.unit)


def _paired(interval: Interval, scale: float, digits: str) -> str:
    low, high = interval
    return f"({scale * low:+{digits}} to {scale * high:+{digits}})"


def _interval(interval: Interval) -> str:
    return f"{interval[0]:.5g} to {interval[1]:.5g}"


def law_line(law: Law) -> str:
    """Return a law in a line."""
    return f"{law.name}: {law.title}: {law.formula}"


def all_lines(every: Overall) -> Iterator[str]:
    """Yield the errors over all groups."""
    yield _HEADER
    yield error_row("conditions that were fitted", every.fitted)
    yield error_row("one cell left out", every.left_out)
    if every.validation is not None:
        yield error_row("validation", every.validation)


def table_lines(table: PublishedTable) -> Iterator[str]:
    """Yield the table of a publication with the verdict."""
    yield table.title
    for name in ("validation", "fitted"):
        yield "on rows that were not fitted:" if name == "validation" else "on the rows that were fitted:"
        yield _HEADER.replace("errors", "      ")
        yield from _table_rows(table.lines, name)
        for how, lines in table.compared.items():
            yield f"  {how}, for comparison:"
            yield from _table_rows(lines, name)
    yield "asked:"
    for line in table.lines:
        if line.asked:
            yield f"  {'ok    ' if line.met else 'MISSED'} {line.way}: {line.asked}"
    yield "the paper says, and its data say:"
    for claim in table.claims:
        yield f"  {claim.said}: {claim.found}"
    yield from table.remarks


def _table_rows(lines: Iterable[TableLine], name: str) -> Iterator[str]:
    for line in lines:
        errors: Errors = getattr(line, name)
        if errors.rows:
            yield error_row(line.way, errors)
