"""What a run's reference conditions, and settings that it measures several times, say as JSON."""

from __future__ import annotations

from dataclasses import asdict

from tester.analysis.reference import ControlChart, CounterfaceDrift
from tester.base.words import Json, finite
from tester.results.run_results import RunResults
from tester.results.settings_table import settings_table


def watch_json(results: RunResults) -> dict[str, Json]:
    """Return what is found under ``settings``, and with references under ``reference``."""
    settings: list[Json] = [*settings_table(results).records()]
    if results.watch is None:
        return {"settings": settings}
    drift = results.watch.drift
    charts: list[Json] = [_chart(chart) for chart in results.watch.charts]
    return {"settings": settings, "reference": {"drift": None if drift is None else _drift(drift), "charts": charts}}


def _drift(drift: CounterfaceDrift) -> Json:
    change, low, high = drift.changed_percent(drift.over_m)
    return {
        "told_apart": drift.apart,
        "over_m": finite(drift.over_m),
        "change_percent": finite(change),
        "change_low_percent": finite(low),
        "change_high_percent": finite(high),
        "references": drift.references,
        "pieces": drift.pieces,
    }


def _chart(chart: ControlChart) -> Json:
    points: list[Json] = [
        {key: finite(value) if isinstance(value, float) else value for key, value in asdict(one).items()}
        for one in chart.points
    ]
    limits: dict[str, Json] = {"centre": finite(chart.centre), "low": finite(chart.low), "high": finite(chart.high)}
    return {"compound": chart.compound, **limits, "points": points}
