"""`tester runs`: what is stored, and which runs can go on."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.cli.showing import Json, dump, duration, shown

if TYPE_CHECKING:
    from tester.catalogue.entries import RunEntry

FINISHED = ("done", "finished")
RUNNING, INTERRUPTED = "running", "interrupted"


@click.command()
@click.option(
    "--out", type=click.Path(file_okay=False, path_type=Path), default=None, help="Folder of the runs (runs)."
)
@click.option("--compound", default="", metavar="TEXT", help="Runs that measured this compound, e.g. 1#.")
@click.option("--since", default="", metavar="DATE", help="Runs begun on or after a date (UTC), e.g. 2026-11-01.")
@click.option("--until", default="", metavar="DATE", help="Runs begun on or before a date (UTC).")
@click.option("--recipe", default="", metavar="TEXT", help="Runs whose recipe's name holds this text.")
@click.option("--status", default="", metavar="WORD", help="done, interrupted, running, stopped, tripped, failed ...")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
def runs(out: Path | None, compound: str, since: str, until: str, recipe: str, status: str, as_json: bool) -> None:
    """List the runs that are stored, those that were cut off with what is committed of them.

    With TESTER_CATALOGUE=postgresql://... the runs of everybody who shares that catalogue.
    """
    from tester.catalogue import open_catalogue
    from tester.catalogue.entries import CatalogueError, Wanted, refresh
    from tester.store.catalogue import RUNS

    under = out or RUNS
    wanted = Wanted(compound, _date(since, "--since"), _end_of(_date(until, "--until")), recipe)
    try:
        catalogue = open_catalogue(under)
        try:
            refresh(catalogue, under)
            found = catalogue.runs(wanted)
        finally:
            catalogue.close()
    except CatalogueError as error:
        raise click.ClickException(str(error)) from error
    stands = [(run, standing(run, under)) for run in found]
    stands = [(run, stand) for run, stand in stands if not status or stand.split()[0].rstrip(",") == status]
    if as_json:
        dump([_record(run, stand) for run, stand in stands])
        return
    for run, stand in stands:
        if run.problem:
            click.echo(f"{run.name}: {shown(run.problem)}", err=True)
            continue
        click.echo(
            f"{run.name}  {stand}  {duration(run.rig_seconds or 0.0)}  "
            f"{run.conditions} conditions, {run.repeats} repeats  {shown(run.recipe)}"
        )


def standing(run: RunEntry, under: Path) -> str:
    """Return how a run stands, in words: done; running and by whom; interrupted with what is committed."""
    from tester.catalogue.entries import origin_of
    from tester.store.catalogue import under_way

    if run.status in FINISHED or run.problem:
        return run.status
    committed = f"{run.repeats} of {run.repeats_planned} repeats committed"
    if run.status != RUNNING:
        return f"{run.status}, {committed}"
    holder = under_way(under / run.name) if run.origin == origin_of(under) else None
    return f"{RUNNING}, {holder.describe()}" if holder is not None else f"{INTERRUPTED}, {committed}"


def _record(run: RunEntry, stand: str) -> Json:
    found: dict[str, Json] = {"run": run.name, "origin": run.origin}
    if run.problem:
        return found | {"status": run.status, "problem": run.problem}
    known: dict[str, Json] = {
        "status": stand.split(",")[0] if run.status == RUNNING else run.status,
        "recipe": run.recipe,
        "compounds": list[Json](run.compounds.split("\n")),
        "operator": run.operator,
        "started_utc": run.started_utc,
        "ended_utc": run.ended_utc or None,
        "rig_seconds": run.rig_seconds,
        "simulated": run.simulated,
        "seed": run.seed,
        "conditions": run.conditions,
        "values": run.trusted,
        "repeats": run.repeats,
        "repeats_planned": run.repeats_planned,
        "can_resume": run.status not in FINISHED and not stand.startswith(RUNNING),
    }
    return found | known


def _date(text: str, option: str) -> str:
    """Return a date, or a date and time, as it was given; anything else is a usage error."""
    from datetime import datetime

    if text:
        try:
            datetime.fromisoformat(text)
        except ValueError:
            raise click.UsageError(f"{option}: expected a date such as 2026-11-01, not {text!r}") from None
    return text


def _end_of(date: str) -> str:
    return f"{date}\uffff" if date else ""  # the whole of that day
