"""`tester figure`: a run's results as pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.cli.law_parts import OVERS, At, parts_chart
from tester.cli.options import QuantityType, run_folder
from tester.cli.text_table import shown

if TYPE_CHECKING:
    from tester.report.chart import Figure
    from tester.results.run_results import RunResults

TOGETHER = "several-runs"
"""Folder of the figures that show several runs together."""


@click.command()
@click.argument("runs", metavar="[RUN...]", nargs=-1)
@click.option("--name", "names", multiple=True, metavar="NAME", help="Only this figure (--list). May be given again.")
@click.option("--list", "only_list", is_flag=True, help="Name the figures that there are, draw none.")
@click.option("--format", "ending", type=click.Choice(["png", "svg", "pdf"]), default="png", show_default=True)
@click.option(
    "--out", type=click.Path(file_okay=False, path_type=Path), default=Path("figures"), show_default=True,
    help="Folder; each run's figures are in one of its own there.",
)  # fmt: skip
@click.option("--law", default="", metavar="LAW", help="Draw a law with published parameters: of a wheel paper or v2.")
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
    time, and the repeats; of speeds and temperatures where friction heats nothing the master curve (tester master says
    more of it); several runs also together, in a folder of its own.

    Bars are the expanded uncertainty U (95 %). The names of the files are printed, a line each.

    --components draws a law (greta unless --law names another) of a compound's moduli on a surface, without a run.
    """
    if components:
        _draw_law(runs, law or "greta", compound, surface, over, At(temperature, pressure, speed), out, ending)
        return
    if not runs:
        raise click.UsageError("no run is named (expected RUN..., or --components)")
    named = list(dict.fromkeys(runs))
    read = [_results(name) for name in named]
    sets = {folder: _figures(results, law, published) for folder, results in read}
    for name, (folder, _) in zip(named, read, strict=True):
        sets[folder] += _masters(name)
    if len(sets) > 1:
        sets[TOGETHER] = _of_several(read)
    known = list(dict.fromkeys(one.name for figures in sets.values() for one in figures))
    unknown = sorted(set(names) - {*known})
    if unknown and not only_list:
        of = ", ".join(folder for folder, _ in read)
        raise click.UsageError(f"no figure {', '.join(unknown)} of {of} (there are {', '.join(known) or 'none'})")
    for folder, figures in sets.items():
        for one in figures if only_list else ():
            click.echo(f"{one.name}: {shown(one.title)}")
        if not only_list:
            _draw(figures, names, out / folder, ending)


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
    from tester.base.plugins import MissingExtraError
    from tester.report.draw import draw

    if not figures:
        raise click.ClickException(f"{target.name}: no condition has a value, and there is nothing to draw")
    for one in figures if not names else [one for one in figures if one.name in names]:
        target.mkdir(parents=True, exist_ok=True)
        path = target / f"{one.name}.{ending}"
        try:
            draw(one, path)
        except MissingExtraError as error:
            raise click.UsageError(str(error)) from error
        click.echo(path)


def _results(name: str) -> tuple[str, RunResults]:
    """Return the name of a run's folder and its results; raises ClickException where it cannot be read."""
    from tester.results.run_results import results_of
    from tester.store.record_schema import StoreError
    from tester.store.run_reader import RunReader

    folder = run_folder(name)
    try:
        with RunReader(folder) as reader:
            return folder.name, results_of(reader)
    except StoreError as error:
        raise click.ClickException(str(error)) from error


def _figures(results: RunResults, law: str, published: bool) -> list[Figure]:
    """Return a run's figures."""
    from tester.cli.kind_words import material_of
    from tester.report.charts import charts_of, control_chart, repeats_chart
    from tester.report.overview import overview_chart

    found: list[Figure] = [*charts_of(material_of(results, law, published))]
    if results.watch is not None and results.watch.charts:
        found.append(control_chart(results.watch.charts))
    measured = [one for one in results.conditions() if any(r.result.mu_resultant > 0.0 for r in one.repeats)]
    overview = overview_chart([("", results)]) if measured else None
    return [*found, *([overview] if overview is not None else []), *map(repeats_chart, measured)]


def _masters(name: str) -> list[Figure]:
    """Return a run's master curves."""
    from tester.cli.master_figures import master_charts
    from tester.kinds import UnknownKindError, find
    from tester.store.run_reader import RunReader

    folder = run_folder(name)
    with RunReader(folder) as reader:
        kind = reader.run().info.kind
    try:
        return [*master_charts(find(kind), folder)]
    except UnknownKindError:
        return []


def _of_several(read: Sequence[tuple[str, RunResults]]) -> list[Figure]:
    """Return the figures that show several runs together: those of the first one's kind."""
    from tester.report.charts import ChartValue, overlay_charts, values_of
    from tester.report.overview import overview_chart

    alike = [(name, results) for name, results in read if results.axes == read[0][1].axes]
    values: list[ChartValue] = []
    for name, results in alike:
        values += values_of(results, name)
    overview = overview_chart(alike)
    return [*overlay_charts(values), *([overview] if overview is not None else [])]
