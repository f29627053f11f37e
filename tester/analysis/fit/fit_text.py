"""A fit in lines for people."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from tester.analysis.fit.check import Errors
from tester.analysis.fit.fit_law import Law, Variable
from tester.analysis.fit.fit_part import PublishedTable, TableLine
from tester.analysis.fit.joint import GroupFit, Overall
from tester.analysis.fit.lack import LEVEL, SEEN, Denominator
from tester.analysis.fit.trends import Interval, Trend

_HEADER = f"{'errors':<34} rows  mean %  median %   max %  within 5 %  within 10 %"


def error_row(title: str, errors: Errors) -> str:
    """Return a row of the table of errors."""
    if not errors.rows:
        return f"{title:<34}    0       -         -       -           -            -"
    mean, middle, largest = (100.0 * share for share in (errors.mean, errors.median, errors.largest))
    return (
        f"{title:<34} {errors.rows:>4}  {mean:>6.2f}  {middle:>8.2f}  {largest:>6.1f}  "
        f"{errors.near:>10}  {errors.far:>11}"
    )


def verdict_lines(fit: GroupFit) -> Iterator[str]:
    """Yield whether the law describes the conditions of a group, and the basis of that verdict."""
    lack = fit.lack
    residual = f"residual standard deviation {100.0 * lack.residual:.1f} %"
    if lack.denominator is None:
        yield f"{fit.group}: whether the law describes these data is unknown"
        yield f"  {residual}; {fit.silent}: no intervals"
    else:
        yield f"{fit.group}: {verdict_words(fit)}"
        yield f"  {residual}, of what is independent between conditions {_independent(lack.denominator)}"
        outcomes = (
            f"{test.name} {'more than chance' if test.failed else 'chance'} (p {test.p:.2g})" for test in lack.tests
        )
        yield f"  {', '.join(outcomes)}; judged together at {100.0 * LEVEL:g} %"
        if not lack.shown:
            yield (
                f"  a departure of {100.0 * lack.visible:.1f} % (root mean square, beyond what the parameters take up)"
                f" is seen in {100.0 * SEEN:g} % of such records"
            )
    for name, reason in {**fit.heated, **fit.impossible}.items():
        yield f"  {name} {fit.parameters[fit.law.names.index(name)]:.3g}: {reason}"
    yield from (f"  warning: {one}" for one in fit.beyond)


def verdict_words(fit: GroupFit) -> str:
    """Return the verdict on a fit whose denominator is known."""
    if fit.lack.shown:
        return "this law does not describe these data"
    if fit.impossible:
        return f"this law describes these data only at what no such rubber has: {', '.join(fit.impossible)}"
    return "no departure from the law is seen"


def _independent(denominator: Denominator) -> str:
    repeats = dict.fromkeys(source.repeats for source in denominator.sources if source.repeats)
    between = dict.fromkeys(source.between for source in denominator.sources if source.between)
    parts = [f"repeats {100.0 * denominator.repeats:.1f} %: {'; '.join(repeats) or 'as stated'}"]
    parts += (
        [f"terms of the budget of each condition by itself {100.0 * denominator.own:.1f} %"] if denominator.own else []
    )
    if denominator.between:
        parts.append(
            f"scatter between conditions {100.0 * denominator.between:.1f} %: {'; '.join(between) or 'as stated'}"
        )
    else:
        parts.append("no scatter between conditions is declared")
    return f"{100.0 * denominator.standard:.1f} % ({', '.join(parts)})"


def group_lines(fit: GroupFit, validation: Errors | None, *, force: bool = False) -> Iterator[str]:
    """Yield the fit of a group; ``validation``: its errors on other conditions; ``force``: include unreliable
    intervals."""
    sources = ", ".join(dict.fromkeys(point.source.name for point in fit.points))
    yield f"{fit.group}: {len(fit.points)} conditions of {sources}, mu as measured"
    yield from _parameter_lines(fit, force)
    yield f"  {_HEADER}"
    yield f"  {error_row('conditions that were fitted', fit.errors)}"
    kept = f", {fit.cells_kept} kept" if fit.cells_kept else ""
    yield f"  {error_row(f'{_cell_words(fit)} left out{kept}', fit.left_out)}"
    if validation is not None:
        yield f"  {error_row('validation', validation)}"
    yield "  mean residual, measured over fitted:"
    for variable, residual in zip(fit.law.variables, fit.residuals, strict=True):
        means = ", ".join(
            f"{variable.words(level.value)} {100.0 * level.mean:+.1f} % ({level.count})" for level in residual
        )
        yield f"    {means}"


def _parameter_lines(fit: GroupFit, force: bool) -> Iterator[str]:
    yield "  parameter        value  95 % interval"
    for parameter, value, interval in zip(fit.law.parameters, fit.parameters, fit.intervals, strict=True):
        shown = "held" if parameter.name in fit.held else _interval(interval)
        if parameter.name not in fit.held and fit.why_no_interval(parameter.name) and not force:
            shown = "none"
        yield f"  {parameter.name:<6} {value:>15.6g}  {shown} {parameter.unit}".rstrip()
    if fit.law.table is not None:
        values = ", ".join(f"{name} {value:.5g}" for name, value in fit.law.table(fit.parameters).items())
        yield f"  {fit.law.table_title}: {values}"
        yield f"  {fit.law.caution}"
    drawn = f"{len(fit.resamples.parameters)} of {fit.resamples.drawn} resamples could be fitted"
    yield f"  condition number {fit.condition_number:.3g}; {drawn}"


def _cell_words(fit: GroupFit) -> str:
    return f"one ({', '.join(fit.law.variables[i].name for i in fit.cells)})"


def trend_lines(fits: Sequence[GroupFit], *, force: bool = False) -> Iterator[str]:
    """Yield peaks, exponents and signs of the trends of all groups; ``force``: even where the law does not fit."""
    for fit in fits:
        at = ", ".join(v.words(x) for v, x in zip(fit.law.variables, fit.trends.at, strict=True))
        if fit.lack.shown and not force:
            yield f"{fit.group}: nothing, for the law does not describe these data"
            continue
        sure = not fit.silent or force
        yield f"{fit.group}, at {at} but for what is varied ({'95 % intervals' if sure else 'no intervals'}):"
        for trend in fit.trends.each:
            yield f"  {trend.variable.name:<12} {trend.word}"
            yield f"  {'':<12} {_peak_words(trend, sure)}; {_slope_words(trend, sure and not trend.own_heat)}"


def _peak_words(trend: Trend, sure: bool) -> str:
    v = trend.variable
    between = f"between {v.words(trend.low)} and {v.words(trend.high)}"
    if trend.peak != trend.peak:
        return f"no peak {between}" + (f" (in {trend.inside:.0%} of resamples)" if trend.inside else "")
    low, high = trend.peak_interval
    peak = f"peak at {v.scale * trend.peak:.4g} {v.unit}"
    if sure:
        peak += f" ({v.scale * low:.4g} to {v.scale * high:.4g})"
    return peak if trend.inside >= 1.0 else f"{peak}, inside the range in {trend.inside:.0%} of resamples"


def _slope_words(trend: Trend, sure: bool) -> str:
    if trend.variable.ratio:
        interval = f" {_paired(trend.exponent_interval, 1.0, '.3f')}" if sure else ""
        return f"exponent {trend.exponent:+.3f}{interval}"
    per_cent = 100.0 / trend.variable.scale
    interval = f" {_paired(trend.exponent_interval, per_cent, '.2f')}" if sure else ""
    return f"{per_cent * trend.exponent:+.2f} %/{_difference(trend.variable)}{interval}"


def _difference(variable: Variable) -> str:
    return {"degC": "K"}.get(variable.unit, variable.unit)


def _paired(interval: Interval, scale: float, digits: str) -> str:
    low, high = interval
    return f"({scale * low:+{digits}} to {scale * high:+{digits}})"


def _interval(interval: Interval) -> str:
    return f"{interval[0]:.5g} to {interval[1]:.5g}"


def law_line(law: Law) -> str:
    """Return a law as a line."""
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
        yield f"  {claim.statement}: {claim.found}"
    yield from table.remarks


def _table_rows(lines: Iterable[TableLine], name: str) -> Iterator[str]:
    for line in lines:
        errors: Errors = getattr(line, name)
        if errors.rows:
            yield error_row(line.way, errors)
