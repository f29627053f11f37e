"""`tester figure`: a run's results as pictures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.cli.formatting import shown
from tester.cli.run_lookup import run_folder

if TYPE_CHECKING:
    from tester.export.results import RunResults
    from tester.report.chart import Figure

TOGETHER = "several-runs"
"""Folder of the figures that show several runs together."""


@click.command()
@click.argument("runs", metavar="RUN...", nargs=-1, required=True)
@click.option("--name", "names", multiple=True, metavar="NAME", help="Only this figure (--list). May be given again.")
@click.option("--list", "only_list", is_flag=True, help="Name the figures that there are, draw none.")
@click.option("--format", "ending", type=click.Choice(["png", "svg", "pdf"]), default="png", show_default=True)
@click.option(
    "--out", type=click.Path(file_okay=False, path_type=Path), default=Path("figures"), show_default=True,
    help="Folder; each run's figures are in one of its own there.",
)  # fmt: skip
@click.option("--law", default="", metavar="LAW", help="Draw a published law too: paper or v2.")
@click.option("--published/--no-published", default=True, show_default=True, help="Points of the paper beside.")
def figure(
    runs: Sequence[str], names: Sequence[str], only_list: bool, ending: str, out: Path, law: str, published: bool
) -> None:
    """Draw the results of each RUN: coefficient over every axis that was varied, as a surface, the run in order of
    time, and the repeats; several runs also together, in a folder of its own.

    Bars are the expanded uncertainty U (95 %). The names of the files are printed, a line each.
    """
    read = [_results(name) for name in dict.fromkeys(runs)]
    sets = {folder: _figures(results, law, published) for folder, results in read}
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


def _draw(figures: Sequence[Figure], names: Sequence[str], target: Path, ending: str) -> None:
    """Write figures of these names, all for none, into a folder; raises ClickException where there are none at all."""
    from tester.base.extras import MissingExtraError
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
    from tester.export.results import results_of
    from tester.store.reader import RunReader
    from tester.store.schema import StoreError

    folder = run_folder(name)
    try:
        with RunReader(folder) as reader:
            return folder.name, results_of(reader)
    except StoreError as error:
        raise click.ClickException(str(error)) from error


def _figures(results: RunResults, law: str, published: bool) -> list[Figure]:
    """Return a run's figures."""
    from tester.cli.kind_words import material_of
    from tester.report.charts import charts_of, repeats_chart
    from tester.report.control import control_chart
    from tester.report.overview import overview_chart

    found: list[Figure] = [*charts_of(material_of(results, law, published))]
    if results.watch is not None and results.watch.charts:
        found.append(control_chart(results.watch.charts))
    measured = [one for one in results.conditions() if any(r.result.mu_resultant > 0.0 for r in one.repeats)]
    overview = overview_chart([("", results)]) if measured else None
    return [*found, *([overview] if overview is not None else []), *map(repeats_chart, measured)]


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
