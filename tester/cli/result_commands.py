"""``tester show`` and ``tester export``: what a run holds, and how it leaves."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.base.words import Json, duration, finite
from tester.cli.options import run_folder
from tester.cli.text_table import dump, shown

if TYPE_CHECKING:
    from tester.results.formats import Format
    from tester.results.run_results import RunResults, TableRow
    from tester.store.records import StoredTrip


# tester show

SHOW_WIDTH = 120
"""Columns within which flags stand behind a row of `tester show`."""
_SESSION = "session origin_s started_utc host operator software_version git_revision"
_CHANGE = "session utc subject before_sha256 after_sha256 reason"
_MATERIAL = "role name file source sha256 doubts"
_WORD = "condition repeat attempt excluded reason operator utc software_version"
"""Fields of the records of these names that ``show --json`` tells."""

@click.command()
@click.argument("run")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
@click.option("--budget", "with_budget", is_flag=True, help="What each uncertainty is made of, term by term.")
def show(run: str, as_json: bool, with_budget: bool) -> None:
    """Show what RUN holds: a run's folder, its name under runs, or latest.

    Behind a coefficient stand two expanded uncertainties (95 %): of what was mounted, in this condition, and of the
    compound, which any other piece of it comes with.
    """
    from tester.results.run_results import results_of
    from tester.store.record_schema import StoreError
    from tester.store.run_reader import RunReader

    folder = run_folder(run)
    try:
        with RunReader(folder) as reader:
            results, sessions, changes = results_of(reader), reader.sessions(), reader.changes()
            said, trips, commands = reader.exclusions(), [*reader.trips()], [*reader.commands()]
            holds = [*reader.holds()]
    except StoreError as error:
        raise click.ClickException(str(error)) from error
    if as_json:
        history: dict[str, Json] = {
            "sessions": [_fields(session, _SESSION) for session in sessions],
            "changes": [_fields(change, _CHANGE) for change in changes],
            "exclusions": [_fields(word, _WORD, excluded=bool(word.excluded)) for word in said],
        }
        history["trips"] = [*map(_trip, trips)]
        history["holds"] = [{"t_s": finite(one.t_s), "utc": one.utc, "text": one.text} for one in holds]
        history["commands"] = [{"t_s": finite(one.t_s), "utc": one.utc, "text": one.text} for one in commands]
        dump(_summary(folder.name, results) | history)
        return
    if with_budget:
        from tester.cli.budget_lines import budget_lines

        for text in budget_lines(results):
            click.echo(text)
        return
    for text in _lines(folder.name, results):
        click.echo(text)
    for session in sessions[1:]:
        where = f"{duration(session.origin_s)} of rig time, {session.started_utc}"
        click.echo(f"went on at {where}, version {session.software_version}")
    for change in changes:
        click.echo(f"{change.subject} changed before stretch {change.session}: {shown(change.reason)}")
    for one in commands:
        click.echo(f"command at {duration(one.t_s)} of rig time, {one.utc}: {shown(one.text)}")
    for one in holds:
        click.echo(f"{one.text}, until {duration(one.t_s)} of rig time, {one.utc}")
    for trip in trips:
        compared = f" ({trip.compared})" if trip.compared else ""
        click.echo(f"trip at {duration(trip.t_s)} of rig time, {trip.utc}: {trip.interlock}{compared}")
        click.echo(f"  {shown(trip.acknowledged)}")
    for word in said:
        what = "excluded" if word.excluded else "included again"
        who = f" by {shown(word.operator)}" if word.operator else ""
        click.echo(f"{word.condition}/{word.repeat} {what} {word.utc}{who}: {shown(word.reason)}")


def _fields(record: object, names: str, **instead: Json) -> Json:
    """Return some of a record's fields, by their names; ``instead``: values that take the place of a field's."""
    return {name: getattr(record, name) for name in names.split()} | instead


def _trip(trip: StoredTrip) -> Json:
    return {
        "t_s": finite(trip.t_s),
        "utc": trip.utc,
        "interlock": trip.interlock,
        "text": trip.text,
        "value": finite(trip.value),
        "limit": finite(trip.limit_value),
        "unit": trip.unit,
        "acknowledged_s": finite(trip.acknowledged_s),
        "acknowledged_utc": trip.acknowledged_utc or None,
        "acknowledged_by": trip.acknowledged_by,
    }


def _summary(name: str, results: RunResults) -> dict[str, Json]:
    from tester.cli.watch_json import watch_json
    from tester.results.pieces_table import pieces_table
    from tester.results.tally import tally_of

    run, tally = results.run, tally_of(results)
    return {
        "run": name,
        "status": results.status.value,
        "reason": run.reason,
        "recipe": run.info.recipe_name,
        "recipe_sha256": run.recipe_sha256,
        "seed": run.info.seed,
        "simulated": run.info.simulated,
        "operator": run.info.operator,
        "risk": run.info.risk,
        "software_version": run.info.software_version,
        "git_revision": run.info.git_revision,
        "versions": dict(run.info.versions),
        "calibration_sha256": run.calibration_sha256,
        "materials": [_fields(one, _MATERIAL) for one in run.info.materials],
        "started_utc": run.info.started_utc,
        "ended_utc": run.ended_utc or None,
        "rig_seconds": finite(run.rig_seconds),
        "overruns": run.overruns,
        "metadata": dict(run.info.metadata),
        "tally": {
            "conditions": tally.conditions, "values": tally.valued, "doubts": tally.doubted, "notes": tally.noted,
        },
        "missing": [row.describe() for row in results.missing()],
        "conditions": [*_conditions(results)],
        "wheels": [*pieces_table(results).records()],
        **watch_json(results),
    }


def _conditions(results: RunResults) -> Iterator[Json]:
    """Yield the rows of the table of conditions, each with its budget and, but for a combined one, its repeats."""
    from tester.results.budget_table import terms_table
    from tester.results.conditions_table import conditions_table
    from tester.results.repeats_table import repeats_table

    table, repeats = conditions_table(results), repeats_table(results)
    for row, record in zip(table.rows, table.records(), strict=True):
        own = repeats.of(one for one in repeats.rows if one.measured is row.measured)
        budget = terms_table(row, results.worn)
        yield {**record, "budget": [*budget.records()], "repeats": [*own.records()]}


def _lines(name: str, results: RunResults) -> Iterator[str]:
    from tester.cli.ending import risk_lines, tally_lines

    run = results.run
    yield f"{name}: {shown(run.info.recipe_name)}"
    yield f"status   {results.status}{': ' + shown(run.reason) if run.reason else ''}"
    yield from risk_lines(results)
    ended = f", ended {run.ended_utc}" if run.ended_utc else ""
    yield f"rig time {duration(run.rig_seconds)}, started {run.info.started_utc}{ended}"
    for name, described in run.info.extensions.items():
        yield f"loaded   {shown(name)}: {shown(described)}"
    for one in run.info.materials:
        yield shown(f"{one.role:8} {one.name}: {one.source}, sha256 {one.sha256}")
        yield from (shown(f"  doubt: {doubt}") for doubt in one.doubts.splitlines())
    if run.overruns:
        yield f"overruns {run.overruns} samples dropped"
    yield from _table(results)
    yield from tally_lines(results, SHOW_WIDTH)
    left = sum(not row.tried for row in results.rows)
    if left:
        yield f"{left} of {len(results.rows)} conditions not measured"
    for line in (*results.watch_lines(), *results.angle_lines(), *results.wear_lines()):
        yield shown(line)


def _worn(row: TableRow, results: RunResults) -> Iterator[str]:
    """Yield what each replicate of a condition took off its wheel, where the wheel was checked."""
    for measured in row.replicates:
        found = results.condition_wear(measured.info.condition)
        if found is not None and isfinite(found.rate.rate):
            rate = f"{found.rate.rate:.3g} ± {found.rate.expanded:.2g} mm3/(N m)"
            below = "" if found.rate.resolved else ", below what the checks resolve"
            yield f"    {found.before_mm:.3f} mm to {found.after_mm:.3f} mm, wear {rate}{below}"


def _table(results: RunResults) -> Iterator[str]:
    """Yield the table of conditions, references behind them, then why some have no value, and what wore off."""
    from tester.cli.text_table import table_lines
    from tester.results.columns import Output
    from tester.results.conditions_table import axis_keys, conditions_table

    table = conditions_table(results)
    tried = [one for one in table.rows if one.whole and one.row.tried]
    if tried:
        axes = results.axes.columns(one.info.setpoint for one in tried)
        yield from table_lines(table.of(tried).view(Output.SHOW, axis_keys(axes)), "remarks", width=SHOW_WIDTH)
    for one in tried:
        if not one.result.ok:
            yield shown(one.row.describe())
        yield from _worn(one.row, results)


# tester export


class FormatName(click.ParamType["Format"]):
    """The name of an export format: one that is shipped, or one of an installed package."""

    name = "format"

    def get_metavar(self, param: click.Parameter, ctx: click.Context) -> str:
        """Return the names there are; nothing is loaded for it."""
        from tester.results.formats import format_names

        return f"[{'|'.join(format_names())}]"

    def convert(self, value: str | Format, param: click.Parameter | None, ctx: click.Context | None) -> Format:
        """Return the format, loaded."""
        from tester.base.plugins import PluginError
        from tester.results.formats import FORMATS, Format, format_of

        if isinstance(value, Format):
            return value
        try:
            return format_of(value)
        except PluginError as error:
            self.fail(f"no format {value!r} (there are {', '.join(FORMATS)}); {error}", param, ctx)


@click.command()
@click.argument("run")
@click.option("--format", "kind", type=FormatName(), required=True, help="Which table.")
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), default=None, help="File to write (stdout).")
@click.option(
    "--decimals", type=click.IntRange(0, 10), default=2, show_default=True, help="Of the appendix's coefficient."
)
def export(run: str, kind: Format, out: Path | None, decimals: int) -> None:
    """Write a table of RUN: a run's folder, its name under runs, or latest.

    Conditions without a value that can be trusted are not in the appendix and are named on stderr; so are values that
    are to be taken with care.
    """
    from tester.base.plugins import MissingExtraError
    from tester.results import Record, write_format
    from tester.store.record_schema import StoreError
    from tester.store.run_reader import RunReader

    if out is None and not kind.is_text:
        raise click.UsageError(f"{kind.name} is not text: name a file with --out")
    try:
        with RunReader(run_folder(run)) as reader:
            record = Record(reader, decimals)
            if out is not None:
                write_format(out, kind, record)
            else:
                kind.write(record, sys.stdout.buffer)
                sys.stdout.flush()
            for remark in kind.remarks(record):
                click.echo(shown(remark), err=True)
    except MissingExtraError as error:
        raise click.UsageError(str(error)) from error
    except StoreError as error:
        raise click.ClickException(str(error)) from error
