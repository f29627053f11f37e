"""`tester runs`: the stored runs, and which can be resumed."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.base.words import duration
from tester.cli.options import command, json_option
from tester.cli.text_table import dump, shown
from tester.store.run_folders import RunStatus

if TYPE_CHECKING:
    from tester.results.catalogue.entries import RunEntry


@command()
@click.option(
    "--out", type=click.Path(file_okay=False, path_type=Path), default=None, help="Folder of the runs (runs)."
)
@click.option("--compound", default="", metavar="TEXT", help="Runs that measured this compound, e.g. 1#.")
@click.option("--since", default="", metavar="DATE", help="Runs begun on or after a date (UTC), e.g. 2026-11-01.")
@click.option("--until", default="", metavar="DATE", help="Runs begun on or before a date (UTC).")
@click.option("--recipe", default="", metavar="TEXT", help="Runs whose recipe's name holds this text.")
@click.option("--status", type=click.Choice([one.value for one in RunStatus]), default=None, help="Of this status.")
@json_option
def runs(
    out: Path | None, compound: str, since: str, until: str, recipe: str, status: str | None, as_json: bool
) -> None:
    """List the stored runs; of interrupted ones, the repeats that are committed.

    With TESTER_CATALOGUE=postgresql://... the runs of all who share that catalogue.
    """
    from tester.results.catalogue import open_catalogue
    from tester.results.catalogue.entries import WantedRuns, entry_json, refresh
    from tester.store.run_folders import RUNS

    under = out or RUNS
    wanted = WantedRuns(compound, _date(since, "--since"), _end_of(_date(until, "--until")), recipe)
    with closing(open_catalogue(under)) as catalogue:
        refresh(catalogue, under)
        stored = catalogue.runs(wanted)
    found = [run for run in stored if not status or run.status == status]
    if as_json:
        dump([entry_json(run) for run in found])
        return
    for run in found:
        if run.problem:
            click.echo(f"{run.name}: {shown(run.problem)}", err=True)
            continue
        click.echo(
            f"{run.name}  {standing(run, under)}  {duration(run.rig_seconds or 0.0)}  "
            f"{run.conditions} conditions, {run.repeats} repeats  {shown(run.recipe)}"
        )


def standing(run: RunEntry, under: Path) -> str:
    """Return a run's status in words, with its process, its number of values, or its committed repeats."""
    from tester.results.catalogue.entries import origin_of
    from tester.store.run_folders import under_way

    status = RunStatus(run.status)
    if status is RunStatus.DONE:
        return status
    if status is RunStatus.INCOMPLETE:
        return f"{status}, {run.trusted} of {run.conditions} conditions have a value"
    if status is RunStatus.RUNNING:
        holder = under_way(under / run.name) if run.origin == origin_of(under) else None
        return f"{status}, {holder.describe()}" if holder is not None else f"{status} on {run.origin} when last seen"
    return f"{status}, {run.repeats} of {run.repeats_planned} repeats committed"


def _date(text: str, option: str) -> str:
    """Return a date, or a date and time, unchanged; any other text is a usage error."""
    from datetime import datetime

    if text:
        try:
            datetime.fromisoformat(text)
        except ValueError:
            raise click.UsageError(f"{option}: expected a date such as 2026-11-01, not {text!r}") from None
    return text


def _end_of(date: str) -> str:
    return f"{date}\uffff" if date else ""  # the whole of that day
