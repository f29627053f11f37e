"""Charts of runs: the coefficient over each varied axis, over pairs of them, and the control chart."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations
from math import isfinite

from tester.analysis.pressure import pressure_kpa
from tester.analysis.reference_watch import ControlChart, ControlPoint
from tester.analysis.results import RepeatResult
from tester.base.axes import Axis, AxisValue, Setpoint, condition_words, plain
from tester.base.words import coefficient
from tester.report.chart import Chart, ChartPanel, ChartSurface, Figure, Look, Mark, Series, series_of
from tester.report.layout import labelled, name_of, second_scale
from tester.results.columns import unit_of
from tester.results.run_results import RunResults
from tester.results.table_rows import Measured

NAN = float("nan")
Y_LABEL = "friction coefficient"
AS_MEASURED = "friction coefficient as measured"
"""Label for single repeats, each at its own measured temperature."""
BARS = "bars: expanded uncertainty U (95 %)"
HOLLOW = "hollow: as published"
CURVE_POINTS = 61
OVERLAID = 6
"""Most panels of a chart of several runs."""
LOGARITHMIC = 100.0
"""Ratio of the greatest to the least value above which an axis is logarithmic [A]: two decades."""

Law = Callable[[Setpoint], float]


@dataclass(frozen=True, slots=True)
class ChartValue:
    """A coefficient with its setpoints; ``u`` expanded, NaN where it is unknown."""

    held: Setpoint
    mu: float
    u: float = NAN
    run: str = ""
    """Name of its run, where several are shown together."""
    kpa_per_n: float | None = None
    """Nominal pressure of 1 N, where the area under the load is known."""

    @property
    def named(self) -> str:
        """Return the value with its setpoints, and its run, in words."""
        spread = f"\u00a0±\u00a0{coefficient(self.u)}" if isfinite(self.u) else ""
        of = f"{self.run}: " if self.run else ""
        return f"{of}{condition_words(self.held)}: {coefficient(self.mu)}{spread}"


@dataclass(frozen=True, slots=True)
class Material:
    """Content of a figure: values of runs, published ones, and a law by its name."""

    measured: Sequence[ChartValue]
    published: Sequence[ChartValue] = ()
    law: Law | None = None
    law_name: str = ""
    law_caveats: Callable[[Setpoint], Sequence[str]] | None = None
    """Returns caveats on the law's coefficient at a setpoint."""


def values_of(results: RunResults, run: str = "") -> list[ChartValue]:
    """Return the rows of a run that have a value; ``run``: its name among others."""
    kpa_per_n = pressure_kpa(1.0, results.run.info.metadata)
    return [
        ChartValue(row.info.setpoint, row.result.mu, row.result.budget.expanded, run, kpa_per_n)
        for row in results.rows
        if row.result.ok
    ]


def charts_of(material: Material) -> Iterator[Figure]:
    """Yield a chart for each pair of axes that were varied together, or for an axis alone, then surfaces."""
    varied = _varied(material.measured)
    drawn: set[str] = set()
    for along, across in permutations(varied, 2):
        chart = _chart(material, along, across)
        if chart is not None:
            drawn.add(along.name)
            yield chart
    for along in varied:
        chart = _chart(material, along, None) if along.name not in drawn else None
        if chart is not None:
            yield chart
    if len(varied) > 1:
        yield from _surfaces(material.measured, varied[0], varied[1])


def overlay_charts(values: Sequence[ChartValue]) -> Iterator[Chart]:
    """Yield a chart for each varied axis, a series for each run, if two runs or more have it.

    It has a panel for each compound and setting of the other axes, those with the most values first.
    """
    runs = list(dict.fromkeys(value.run for value in values))
    for along in _varied(values):
        alike: dict[tuple[object, ...], list[ChartValue]] = {}
        for point in values:
            rest = (axis.of(point.held) for axis in point.held.axes if axis.name != along.name)
            alike.setdefault((point.held.compound, *rest), []).append(point)
        panels = [
            panel
            for alike_values in sorted(alike.values(), key=len, reverse=True)[:OVERLAID]
            if (panel := _overlaid(alike_values, along, runs))
        ]
        if panels:
            title = f"{Y_LABEL} over {name_of(along)}, of each run"
            log_x = _logarithmic(values, along)
            yield Chart(
                f"{along.name}-of-runs", title, labelled(along), Y_LABEL, tuple(panels), BARS, log_x=log_x,
                x_second=second_scale(along, _kpa_per_n(values)),
            )  # fmt: skip


def _overlaid(alike: Sequence[ChartValue], along: Axis, runs: Sequence[str]) -> ChartPanel | None:
    """Return the panel of values that differ only in ``along`` and the run."""
    series: list[Series] = []
    for style, run in enumerate(runs):
        points = [point for point in alike if point.run == run]
        if len({along.number(point.held) for point in points}) > 1:
            series.append(_points(run, points, along, "measured", style))
    named = [axis for axis in alike[0].held.axes if axis.name != along.name and not axis.at_default(alike[0].held)]
    return ChartPanel(condition_words(alike[0].held, named), tuple(series)) if len(series) > 1 else None


def _kpa_per_n(values: Sequence[ChartValue]) -> float | None:
    """Return the pressure of 1 N, where all values have the same."""
    found = {value.kpa_per_n for value in values}
    return found.pop() if len(found) == 1 else None


def _varied(values: Sequence[ChartValue]) -> list[Axis]:
    """Return the numeric axes on which the values differ, the preferred abscissa first."""
    if not values:
        return []
    axes = values[0].held.axes.differing(value.held for value in values)
    return sorted((axis for axis in axes if axis.plotted and not axis.textual), key=lambda axis: axis.plotted)


def _chart(material: Material, along: Axis, across: Axis | None) -> Chart | None:
    """Return the chart of the coefficient over ``along``, a series for each value of ``across``."""
    kinds = _panelled(material.measured)
    panels = [panel for group in kinds if (panel := _panel(material, group, along, across))]
    if not panels or (across is not None and not any(_styles(panel) > 1 for panel in panels)):
        return None
    notes = [BARS]
    looks = {series.look for panel in panels for series in panel.series}
    notes += [HOLLOW] if "published" in looks else []
    notes += [f"lines: {material.law_name}", *_caveats(material)] if "law" in looks else []
    by = f"-by-{across.name}" if across is not None else ""
    title = f"{Y_LABEL} over {name_of(along)}" + (f" at each {name_of(across)}" if across is not None else "")
    log_x = _logarithmic(material.measured, along)
    second = second_scale(along, _kpa_per_n(material.measured))
    return Chart(
        f"{along.name}{by}", title, labelled(along), Y_LABEL, tuple(panels), "; ".join(notes), log_x=log_x,
        x_second=second,
    )  # fmt: skip


def _caveats(material: Material) -> list[str]:
    """Return the law's caveats at the measured values, each once, with the number of values that it affects."""
    if material.law_caveats is None:
        return []
    caveats = Counter(caveat for value in material.measured for caveat in material.law_caveats(value.held))
    return [f"caution ({count} values): {caveat}" for caveat, count in caveats.items()]


def _logarithmic(values: Iterable[ChartValue], along: Axis) -> bool:
    """Return whether an axis spans decades, as speeds of a master curve do."""
    numbers = [along.number(value.held) for value in values]
    return min(numbers) > 0.0 and max(numbers) >= LOGARITHMIC * min(numbers)


def _styles(panel: ChartPanel) -> int:
    return len({series.style for series in panel.series})


def _panelled(values: Iterable[ChartValue]) -> list[list[ChartValue]]:
    """Return the values of each panel: of one compound, and of one text of each axis of texts (glass; dry, wet)."""
    panels: dict[tuple[str, ...], list[ChartValue]] = {}
    for value in values:
        texts = (_rank(axis, str(axis.of(value.held))) for axis in value.held.axes if axis.textual)
        panels.setdefault((value.held.compound, *texts), []).append(value)
    return [panels[key] for key in sorted(panels)]


def _rank(axis: Axis, text: str) -> str:
    """Return what sorts a text of an axis: its place among the choices, or itself."""
    return str(axis.choices.index(text)) if axis.choices else text


def _panel(material: Material, values: Sequence[ChartValue], along: Axis, across: Axis | None) -> ChartPanel | None:
    """Return the panel of values of one group (``_panelled``)."""
    compound = values[0].held.compound
    free = {along.name, *([across.name] if across is not None else [])}
    fixed = _usual(values, free)
    values = _fixed(values, fixed)
    published = _fixed([value for value in material.published if value.held.compound == compound], fixed)
    series: list[Series] = []
    # A style means the same value of ``across`` in all panels.
    levels = sorted({across.number(value.held) for value in material.measured}) if across is not None else [0.0]
    for style, level in enumerate(levels):
        here = [point for point in values if across is None or across.number(point.held) == level]
        if len({along.number(point.held) for point in here}) < 2:
            continue  # a single place shows no trend
        label = _level(level, across, values) if across is not None else "measured"
        series.append(_points(label, here, along, "measured", style))
        shown = [value for value in published if across is None or across.number(value.held) == level]
        if shown:
            series.append(_points("", shown, along, "published", style))
        if material.law is not None:
            series.append(_curve(material.law, here, along, style))
    if not series:
        return None
    named = [axis for axis in values[0].held.axes if axis.name not in free and not axis.at_default(values[0].held)]
    return ChartPanel(condition_words(values[0].held, named), tuple(series))


def _level(level: float, across: Axis, values: Sequence[ChartValue]) -> str:
    """Return a value of an axis with its unit; a load with its pressure, where that is known."""
    second = second_scale(across, _kpa_per_n(values))
    return f"{plain(level)} {unit_of(across)}" + (f" ({second.factor * level:g} kPa)" if second is not None else "")


def _usual(values: Sequence[ChartValue], free: set[str]) -> dict[str, AxisValue]:
    """Return the most frequent setpoints on the axes that are not free."""
    axes = values[0].held.axes
    (most, _), *_ = Counter(
        tuple((axis.name, axis.of(value.held)) for axis in axes if axis.name not in free) for value in values
    ).most_common(1)
    return dict(most)


def _fixed(values: Sequence[ChartValue], fixed: Mapping[str, AxisValue]) -> list[ChartValue]:
    return [value for value in values if all(value.held.axes[name].of(value.held) == at for name, at in fixed.items())]


def _points(label: str, values: Sequence[ChartValue], along: Axis, look: Look, style: int) -> Series:
    ordered = sorted(values, key=lambda value: along.number(value.held))
    if look == "measured":
        marks = [Mark(along.number(value.held), value.mu, value.u, name=value.named) for value in ordered]
    else:
        marks = [Mark(along.number(v.held), v.mu, name=f"as published: {v.named}") for v in ordered]
    return series_of(label, marks, look, style)


def _curve(law: Law, values: Sequence[ChartValue], along: Axis, style: int) -> Series:
    numbers = [along.number(value.held) for value in values]
    low, high = min(numbers), max(numbers)
    shares = [i / (CURVE_POINTS - 1) for i in range(CURVE_POINTS)]
    if _logarithmic(values, along):
        x = [low * (high / low) ** share for share in shares]
    else:
        x = [low + (high - low) * share for share in shares]
    y = [law(values[0].held.but(**{along.name: value / along.scale})) for value in x]
    return Series("", tuple(x), tuple(y), "law", style)


def _surfaces(values: Sequence[ChartValue], along: Axis, upward: Axis) -> Iterator[ChartSurface]:
    """Yield the coefficient over two axes, for each compound at the setpoints that most of its conditions share."""
    panels: list[tuple[str, tuple[float, ...], tuple[float, ...], tuple[tuple[float, ...], ...]]] = []
    for kind in _panelled(values):
        group = _fixed(kind, _usual(kind, {along.name, upward.name}))
        x, y = (tuple(sorted({axis.number(value.held) for value in group})) for axis in (along, upward))
        if len(x) < 2 or len(y) < 2:
            continue
        at = {(along.number(value.held), upward.number(value.held)): value.mu for value in group}
        named = [
            axis for axis in group[0].held.axes if axis not in (along, upward) and not axis.at_default(group[0].held)
        ]
        grid = tuple(tuple(at.get((value, other), NAN) for value in x) for other in y)
        panels.append((condition_words(group[0].held, named), x, y, grid))
    if panels:
        title = f"{Y_LABEL} over {name_of(along)} and {name_of(upward)}"
        note = "empty: not measured"
        x_second, y_second = (second_scale(axis, _kpa_per_n(values)) for axis in (along, upward))
        yield ChartSurface(
            "surface", title, labelled(along), labelled(upward), Y_LABEL, tuple(panels), note, x_second, y_second
        )


def repeats_chart(measured: Measured) -> Chart:
    """Return the repeats of a condition: each at its time, over its duration, with the scatter of its batch means."""
    finite = [repeat for repeat in measured.repeats if isfinite(repeat.result.mu_resultant)]
    counted = [_window(repeat.result) for repeat in finite if not measured.exclusion(repeat)]
    left_out = [_window(repeat.result) for repeat in finite if measured.exclusion(repeat)]
    series = [
        *([series_of("in the mean", counted, "measured", 0)] if counted else []),
        *([series_of("left out", left_out, "left out", 1)] if left_out else []),
    ]
    result = measured.result
    title = f"repeats of {condition_words(measured.info.setpoint)}"
    if isfinite(result.mu):
        title += f": mu {coefficient(result.mu)} ± {coefficient(result.budget.expanded)}"
    note = "along: from begin to end of each repeat; bars: standard deviation of its batch means"
    return Chart(f"repeats-{measured.info.condition}", title, "rig time (min)", AS_MEASURED,
                 (ChartPanel("", tuple(series)),), note, from_zero=False)  # fmt: skip


def _window(repeat: RepeatResult) -> Mark:
    """Return a repeat at the middle of its duration, minutes, with the standard deviation of its batch means."""
    begin, end = repeat.started_s / 60.0, repeat.ended_s / 60.0
    spread = 0.01 * repeat.fluctuation_percent * repeat.mu_resultant
    return Mark(0.5 * (begin + end), repeat.mu_resultant, spread, 0.5 * (end - begin))


def control_chart(charts: Sequence[ControlChart]) -> Chart:
    """Return the charts of the references, one for each compound and counterface, over their order.

    Those out of limits are crosses.
    """
    panels = tuple(ChartPanel(chart.name if len(charts) > 1 else "", _series(chart)) for chart in charts)
    return Chart(
        "control",
        "reference condition in the order in which it was measured",
        "turn of the reference condition",
        Y_LABEL,
        panels,
        "bars: expanded repeatability (95 %); dashed: limits about the first",
        from_zero=False,
    )


def _series(chart: ControlChart) -> tuple[Series, ...]:
    valued = [point for point in chart.points if isfinite(point.mu)]
    inside = [_turn(point) for point in valued if point.within]
    outside = [_turn(point) for point in valued if not point.within]
    along = tuple(float(point.number) for point in chart.points)
    return (
        *([series_of("in control", inside, "measured", 0)] if inside else []),
        *([series_of("out of control", outside, "left out", 1)] if outside else []),
        Series("limits", along, (chart.low,) * len(along), "limit", 1),
        Series("", along, (chart.high,) * len(along), "limit", 1),
    )


def _turn(point: ControlPoint) -> Mark:
    value = f"{coefficient(point.mu)}\u00a0±\u00a0{coefficient(point.expanded)}"
    return Mark(float(point.number), point.mu, point.expanded, name=f"turn {point.number}: {value}")
