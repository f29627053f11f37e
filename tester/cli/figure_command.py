"""`tester figure`: a run's results as pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.cli.law_parts import OVERS, At, parts_chart
from tester.cli.options import QuantityType, command
from tester.cli.stored_runs import results_named, run_folder
from tester.cli.text_table import shown

if TYPE_CHECKING:
    from tester.analysis.master_curve.points import MasterPoint
    from tester.kinds.kind import Kind
    from tester.report.chart import Chart, Figure
    from tester.results.run_results import RunResults

TOGETHER = "several-runs"
"""Folder of the figures that show several runs together."""
REFERENCE_C = 20.0
"""Reference temperature of the master curves, the default of ``tester master``."""


@command()
@click.argument("runs", metavar="[RUN...]", nargs=-1)
@click.option("--name", "names", multiple=True, metavar="NAME", help="Only this figure (--list). May be given again.")
@click.option("--list", "only_list", is_flag=True, help="Name the figures that there are, draw none.")
@click.option("--format", "ending", type=click.Choice(["png", "svg", "pdf"]), default="png", show_default=True)
@click.option(
    "--out", type=click.Path(file_okay=False, path_type=Path), default=Path("figures"), show_default=True,
    help="Folder; each run's figures get a folder in it.",
)  # fmt: skip
@click.option("--law", default="", metavar="LAW", help="Draw a kept law, or a published one: of a wheel paper, v2.")
@click.option("--published/--no-published", default=True, show_default=True, help="Points of the paper beside.")
@click.option("--components", is_flag=True, help="No run: adhesion and hysteresis of a law of materials.")
@click.option("--over", type=click.Choice(OVERS), default="ra", show_default=True, help="What --components goes over.")
@click.option("--compound", default="tread", show_default=True, help="Of --components.")
@click.option("--surface", default="road", show_default=True, help="Of --components.")
@click.option("--temperature", type=QuantityType("degC"), default="25 degC", show_default=True, help="Of --components.")
@click.option("--pressure", type=QuantityType("Pa"), default="300 kPa", show_default=True, help="Of --components.")
@click.option("--speed", type=QuantityType("m/s"), default="1 m/s", show_default=True, help="Of --components.")
def figure(
    runs: Sequence[str],
    names: Sequence[str],
    only_list: bool,
    ending: str,
    out: Path,
    law: str,
    published: bool,
    components: bool,
    over: str,
    compound: str,
    surface: str,
    temperature: float,
    pressure: float,
    speed: float,
) -> None:
    """Draw the results of each RUN: coefficient over every axis that was varied, as a surface, the run in order of
    time, and the repeats; the deformation over temperature; of speeds and temperatures where friction heats nothing
    the master curve (tester master prints its details); several runs also together, in a folder of its own.

    Bars are the expanded uncertainty U (95 %). The names of the files are printed, a line each.

    --components draws a law (greta unless --law names another) of a compound's moduli on a surface, without a run.
    """
    if components:
        _draw_law(runs, law or "greta", compound, surface, over, At(temperature, pressure, speed), out, ending)
        return
    if not runs:
        raise click.UsageError("no run is named (expected RUN..., or --components)")
    sets = _sets(list(dict.fromkeys(runs)), law, published)
    known = list(dict.fromkeys(one.name for figures in sets.values() for one in figures))
    unknown = sorted(set(names) - {*known})
    if unknown and not only_list:
        of = ", ".join(folder for folder in sets if folder != TOGETHER)
        raise click.UsageError(f"no figure {', '.join(unknown)} of {of} (there are {', '.join(known) or 'none'})")
    for folder, figures in sets.items():
        if only_list:
            for one in figures:
                click.echo(f"{one.name}: {shown(one.title)}")
        else:
            _draw(figures, names, out / folder, ending)


def _sets(names: Sequence[str], law: str, published: bool) -> dict[str, list[Figure]]:
    """Return the figures of each run by its folder's name, of several runs also those that show them together."""
    folders = [run_folder(name) for name in names]
    results = {folder.name: results_named(name) for folder, name in zip(folders, names, strict=True)}
    sets = {folder.name: figures_of(folder, results[folder.name], law, published) for folder in folders}
    return sets | {TOGETHER: _of_several(results)} if len(sets) > 1 else sets


def _draw_law(
    runs: Sequence[str], law: str, compound: str, surface: str, over: str, at: At, out: Path, ending: str
) -> None:
    """Draw the parts of a law over one quantity."""
    if runs:
        raise click.UsageError("--components draws a law and takes no run")
    if min(at.pressure_pa, at.speed_m_s) <= 0.0:
        raise click.UsageError("--components: pressure and speed are above 0")
    chart = parts_chart(law, compound, surface, over, at)
    _draw([replace(chart, name=f"components-over-{over}")], (), out / f"{law}-{compound}-{surface}", ending)


def _draw(figures: Sequence[Figure], names: Sequence[str], target: Path, ending: str) -> None:
    """Write figures of these names, all for none, into a folder; raises ClickException where there are none at all."""
    from tester.report.draw import draw

    if not figures:
        raise click.ClickException(f"{target.name}: no condition has a value, and there is nothing to draw")
    for one in figures if not names else [one for one in figures if one.name in names]:
        target.mkdir(parents=True, exist_ok=True)
        path = target / f"{one.name}.{ending}"
        draw(one, path)
        click.echo(path)


def figures_of(folder: Path, results: RunResults, law: str, published: bool) -> list[Figure]:
    """Return a run's figures."""
    from tester.cli.stored_runs import kind_of, material_of
    from tester.report.charts import charts_of, control_chart, repeats_chart
    from tester.report.overview import overview_chart

    found: list[Figure] = [*charts_of(material_of(results, law, published))]
    if results.watch is not None and results.watch.charts:
        found.append(control_chart(results.watch.charts))
    measured = [one for one in results.conditions() if any(r.result.mu_resultant > 0.0 for r in one.repeats)]
    overview = overview_chart([("", results)]) if measured else None
    found += [*([overview] if overview is not None else []), *map(repeats_chart, measured)]
    stiffness = deformation_chart(folder, results)
    found += [stiffness] if stiffness is not None else []
    kind = kind_of(results.run.info)
    found += master_charts(kind, folder) if kind is not None else []
    return found


def deformation_chart(folder: Path, results: RunResults) -> Chart | None:
    """Return the deformation over temperature; None where the depth is not on record. Raises StoreError."""
    from tester.report.stiffness_chart import stiffness_chart
    from tester.results.stiffness_table import shows_stiffness, stiffness_rows
    from tester.store.run_reader import RunReader

    if not shows_stiffness(results):
        return None
    with RunReader(folder) as reader:
        return stiffness_chart(stiffness_rows(results, reader))


def master_charts(kind: Kind, folder: Path) -> list[Chart]:
    """Return a run's master curves: one for each compound, interface and load.

    None where its kind has no master curves, where friction heated the contact, or where the conditions allow none;
    ``tester master`` gives the reason. A figure's title has the verdict. Raises StoreError.
    """
    if kind.masters is None:
        return []
    from tester.analysis.master_curve.fitted_curve import master_of
    from tester.analysis.master_curve.points import MasterError
    from tester.report.law_charts import master_chart

    run = kind.masters().run(folder)
    alike: dict[tuple[object, ...], list[MasterPoint]] = {}
    for point in () if run.refusal else run.points:
        alike.setdefault((point.compound, *point.held.items()), []).append(point)
    charts: list[Chart] = []
    for points in alike.values():
        with suppress(MasterError):
            charts.append(master_chart(master_of(points, REFERENCE_C)))
    if len(charts) == 1:
        return charts
    return [replace(one, name=f"{one.name}-{number}") for number, one in enumerate(charts, start=1)]


def _of_several(results: Mapping[str, RunResults]) -> list[Figure]:
    """Return the figures that show several runs together: those of the first one's kind."""
    from tester.report.charts import overlay_charts, values_of
    from tester.report.overview import overview_chart

    first = next(iter(results.values()))
    alike = [(name, one) for name, one in results.items() if one.axes == first.axes]
    overview = overview_chart(alike)
    charts = overlay_charts([value for name, one in alike for value in values_of(one, name)])
    return [*charts, *([overview] if overview is not None else [])]
