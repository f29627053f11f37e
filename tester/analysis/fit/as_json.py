"""A fit as plain data, for ``--json``: NaN is null, shares are numbers between 0 and 1."""

from __future__ import annotations

from dataclasses import asdict

from tester.analysis.fit.check import Errors
from tester.analysis.fit.fit_part import PublishedTable, TableLine
from tester.analysis.fit.joint import GroupFit
from tester.analysis.fit.trends import Interval
from tester.base.words import Json, finite


def interval(ends: Interval) -> Json:
    """Return both ends."""
    return [finite(end) for end in ends]


def errors(figures: Errors | None) -> Json:
    """Return errors, None where there are none."""
    if figures is None:
        return None
    return {name: finite(value) if isinstance(value, float) else value for name, value in asdict(figures).items()}


def group(fit: GroupFit, validation: Errors | None, *, force: bool = False) -> dict[str, Json]:
    """Return the fit of a group; ``force``: include unreliable intervals."""
    law = fit.law
    table: Json = dict(law.table(fit.parameters)) if law.table is not None else None
    return {
        "group": fit.group,
        "conditions": len(fit.points),
        "parameters": _parameters(fit, force),
        "table": table,
        "condition_number": finite(fit.condition_number),
        "resamples": {"fitted": len(fit.resamples.parameters), "drawn": fit.resamples.drawn},
        "errors": errors(fit.errors),
        "left_out": errors(fit.left_out),
        "cells_kept": fit.cells_kept,
        "validation": errors(validation),
        "residuals": {
            variable.name: [
                {"value": variable.scale * row.value, "unit": variable.unit, "mean": row.mean, "count": row.count}
                for row in residual
            ]
            for variable, residual in zip(law.variables, fit.residuals, strict=True)
        },
        "lack_of_fit": _lack(fit),
        "impossible": {**fit.impossible},
        "beyond": [*fit.beyond],
        "trends": _trends(fit, force),
    }


def _parameters(fit: GroupFit, force: bool) -> dict[str, Json]:
    return {
        parameter.name: {
            "value": value,
            "unit": parameter.unit,
            "interval": None if not force and fit.why_no_interval(parameter.name) else interval(pair),
            "no_interval": fit.why_no_interval(parameter.name),
            "held": parameter.name in fit.held,
        }
        for parameter, value, pair in zip(fit.law.parameters, fit.parameters, fit.intervals, strict=True)
    }


def _trends(fit: GroupFit, force: bool) -> dict[str, Json]:
    sure = force or not fit.silent
    return {
        "at": {v.name: v.scale * x for v, x in zip(fit.law.variables, fit.trends.at, strict=True)},
        "each": [
            {
                "variable": row.variable.name,
                "trend": row.word,
                "peak": finite(row.variable.scale * row.peak),
                "peak_interval": [finite(row.variable.scale * end) for end in row.peak_interval] if sure else None,
                "inside": row.inside,
                "exponent" if row.variable.ratio else "per_unit": row.exponent,
                "interval": interval(row.exponent_interval) if sure and not row.own_heat else None,
                "agree": finite(row.agree),
            }
            for row in (fit.trends.each if sure or not fit.lack.shown else ())
        ],
    }


def _lack(fit: GroupFit) -> dict[str, Json]:
    lack, below = fit.lack, fit.lack.denominator
    return {
        "shown": lack.shown,
        "residual": lack.residual,
        "independent": finite(below.standard) if below is not None else None,
        "repeats": finite(below.repeats) if below is not None else None,
        "own": finite(below.own) if below is not None else None,
        "between_conditions": finite(below.between) if below is not None else None,
        "tests": [{"name": test.name, "p": test.p, "failed": test.failed} for test in lack.tests],
        "visible": finite(lack.visible),
    }


def table(published: PublishedTable) -> dict[str, Json]:
    """Return a publication's table with the verdict."""
    return {
        "title": published.title,
        "lines": [_line(line) for line in published.lines],
        "compared": {how: [_line(line) for line in lines] for how, lines in published.compared.items()},
        "claims": [{"said": claim.statement, "found": claim.found} for claim in published.claims],
        "missed": [*published.missed],
    }


def _line(line: TableLine) -> dict[str, Json]:
    return {
        "way": line.way,
        "fitted": errors(line.fitted),
        "validation": errors(line.validation),
        "asked": line.asked or None,
        "met": line.met,
    }
