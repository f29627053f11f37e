"""`tester figure`: a run's results as pictures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.cli.formatting import shown
from tester.cli.run_lookup import run_folder

if TYPE_CHECKING:
    from tester.report.chart import Figure


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
    """Draw the results of each RUN: coefficient over every axis that was varied, as a surface, and the repeats.

    Bars are the expanded uncertainty U (95 %). The names of the files are printed, a line each.
    """
    from tester.base.extras import MissingExtraError

    for name in runs:
        folder = run_folder(name)
        figures = _figures(folder, law, published)
        if only_list:
            for one in figures:
                click.echo(f"{one.name}: {shown(one.title)}")
            continue
        unknown = sorted(set(names) - {one.name for one in figures})
        if unknown:
            known = ", ".join(one.name for one in figures) or "none"
            raise click.UsageError(f"no figure {', '.join(unknown)} of {folder.name} (there are {known})")
        wanted = [one for one in figures if not names or one.name in names]
        if not wanted:
            raise click.ClickException(f"{folder.name}: no condition has a value, and there is nothing to draw")
        target = out / folder.name
        target.mkdir(parents=True, exist_ok=True)
        from tester.report.draw import draw

        for one in wanted:
            path = target / f"{one.name}.{ending}"
            try:
                draw(one, path)
            except MissingExtraError as error:
                raise click.UsageError(str(error)) from error
            click.echo(path)


def _figures(folder: Path, law: str, published: bool) -> list[Figure]:
    """Return a run's figures; raises ClickException where it cannot be read."""
    from tester.cli.kind_words import material_of
    from tester.export.results import results_of
    from tester.report.charts import charts_of, repeats_chart
    from tester.store.reader import RunReader
    from tester.store.schema import StoreError

    try:
        with RunReader(folder) as reader:
            results = results_of(reader)
    except StoreError as error:
        raise click.ClickException(str(error)) from error
    found: list[Figure] = [*charts_of(material_of(results, law, published))]
    measured = [one for one in results.conditions() if any(r.result.mu_resultant > 0.0 for r in one.repeats)]
    return [*found, *map(repeats_chart, measured)]
