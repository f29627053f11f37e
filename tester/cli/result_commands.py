"""``tester show`` prints a run's results, ``tester export`` writes them to files."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.base.words import Json, duration, finite
from tester.cli.export_law import SOLVER_NAMES
from tester.cli.options import QuantityType, command, json_option
from tester.cli.stored_runs import run_folder
from tester.cli.text_table import dump, fields, shown

if TYPE_CHECKING:
    from tester.analysis.reference_watch import ReferenceWatch
    from tester.results.formats import Format
    from tester.results.run_results import RunResults
    from tester.results.table_rows import TableRow
    from tester.store.run_reader import RunReader


# tester show

SHOW_WIDTH = 120
"""Columns within which flags are printed behind a row of `tester show`."""


@command()
@click.argument("run")
@json_option
@click.option("--budget", "with_budget", is_flag=True, help="What each uncertainty is made of, term by term.")
def show(run: str, as_json: bool, with_budget: bool) -> None:
    """Show what RUN holds: a run's folder, its name under runs, or latest.

    A coefficient is followed by two expanded uncertainties (95 %): that of what was mounted, in this condition, and
    that of the compound, which any other piece of it comes with.
    """
    from tester.results.run_results import results_of
    from tester.store.run_reader import RunReader

    folder = run_folder(run)
    with RunReader(folder) as reader:
        results = results_of(reader)
        if as_json:
            dump(_summary(folder.name, results) | _history_json(reader))
            return
        lines = [*_budgets(results)] if with_budget else [*_lines(folder.name, results), *_history(reader)]
    for line in lines:
        click.echo(line)


def _history(run: RunReader) -> Iterator[str]:
    """Yield what happened to a run, a line each."""
    for session in run.sessions()[1:]:
        where = f"{duration(session.origin_s)} of rig time, {session.started_utc}"
        yield f"resumed at {where}, version {session.software_version}"
    for change in run.changes():
        yield f"{change.subject} changed before stretch {change.session}: {shown(change.reason)}"
    for event in run.commands():
        yield f"command at {duration(event.t_s)} of rig time, {event.utc}: {shown(event.text)}"
    for event in run.holds():
        yield f"{event.text}, until {duration(event.t_s)} of rig time, {event.utc}"
    for trip in run.trips():
        compared = f" ({trip.compared})" if trip.compared else ""
        yield f"trip at {duration(trip.t_s)} of rig time, {trip.utc}: {trip.interlock}{compared}"
        yield f"  {shown(trip.acknowledged)}"
    for word in run.exclusions():
        what = "excluded" if word.excluded else "included again"
        who = f" by {shown(word.operator)}" if word.operator else ""
        yield f"{word.condition}/{word.repeat} {what} {word.utc}{who}: {shown(word.reason)}"


def _history_json(run: RunReader) -> dict[str, Json]:
    session = "session origin_s started_utc host operator software_version git_revision"
    change = "session utc subject before_sha256 after_sha256 reason"
    word = "condition repeat attempt excluded reason operator utc software_version"
    trip = "t_s utc interlock text value unit acknowledged_s acknowledged_utc acknowledged_by"
    return {
        "sessions": [fields(one, session) for one in run.sessions()],
        "changes": [fields(one, change) for one in run.changes()],
        "exclusions": [fields(one, word, excluded=bool(one.excluded)) for one in run.exclusions()],
        "trips": [
            fields(one, trip, limit=finite(one.limit_value), acknowledged_utc=one.acknowledged_utc or None)
            for one in run.trips()
        ],
        "holds": [fields(one, "t_s utc text") for one in run.holds()],
        "commands": [fields(one, "t_s utc text") for one in run.commands()],
    }


def _budgets(results: RunResults) -> Iterator[str]:
    """Yield each condition's budget, the largest term first; terms in per cent of the coefficient."""
    from tester.base.axes import condition_words
    from tester.cli.text_table import plain_lines
    from tester.results.budget_table import budgeted_rows, sums, terms_table
    from tester.results.columns import Output
    from tester.results.conditions_table import conditions_table

    conditions = conditions_table(results)
    for row in budgeted_rows(conditions):
        first, *others = sums(conditions, row)
        yield shown(f"{condition_words(row.info.setpoint)}: {first}")
        yield from (shown(f"  {line}") for line in others)
        yield from (f"  {line}" for line in plain_lines(terms_table(row, results.worn).view(Output.SHOW)))


def _summary(name: str, results: RunResults) -> dict[str, Json]:
    from tester.results.measured_tables import pieces_table
    from tester.results.repeated_tables import settings_table
    from tester.results.tally import tally_of

    run, tally = results.run, tally_of(results)
    return {
        "run": name,
        "status": results.status.value,
        "reason": run.reason,
        "recipe": run.info.recipe_name,
        "recipe_sha256": run.recipe_sha256,
        **fields(run.info, "seed simulated operator risk software_version git_revision"),
        "versions": dict(run.info.versions),
        "calibration_sha256": run.calibration_sha256,
        "materials": [fields(one, "role name file source sha256 doubts") for one in run.info.materials],
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
        "settings": [*settings_table(results).records()],
        **({"reference": _reference(results.watch)} if results.watch is not None else {}),
    }


def _reference(watch: ReferenceWatch) -> Json:
    """Return what the reference conditions show: the drift of each counterface, and the control charts."""
    drifts: list[Json] = []
    for surface, drift in watch.drifts.items():
        if drift is None:
            continue
        change, low, high = map(finite, drift.changed_percent(drift.over_m))
        drifts.append({
            "surface": surface,
            "told_apart": drift.apart,
            "change_percent": change,
            "change_low_percent": low,
            "change_high_percent": high,
            **fields(drift, "over_m references pieces"),
        })  # fmt: skip
    charts: list[Json] = []
    for chart in watch.charts:
        points = [fields(point, " ".join(asdict(point))) for point in chart.points]
        charts.append({**fields(chart, "compound surface centre low high"), "points": [*points]})
    return {"drifts": drifts, "charts": charts}


def _conditions(results: RunResults) -> Iterator[Json]:
    """Yield the rows of the table of conditions, each with its budget and, but for a combined one, its repeats."""
    from tester.results.budget_table import terms_table
    from tester.results.conditions_table import conditions_table
    from tester.results.measured_tables import repeats_table

    table, repeats = conditions_table(results), repeats_table(results)
    for row, record in zip(table.rows, table.records(), strict=True):
        own = repeats.of(one for one in repeats.rows if one.measured is row.measured)
        budget = terms_table(row, results.worn)
        yield {**record, "budget": [*budget.records()], "repeats": [*own.records()]}


def _lines(name: str, results: RunResults) -> Iterator[str]:
    from tester.cli.ending import risk_lines, tally_lines
    from tester.results.hardness_read import hardness_lines

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
    for line in (*results.watch_lines(), *results.angle_lines(), *results.wear_lines(), *hardness_lines(results)):
        yield shown(line)


def _worn(row: TableRow, results: RunResults) -> Iterator[str]:
    """Yield the wear by each replicate of a condition whose wheel was checked."""
    for measured in row.replicates:
        found = results.condition_wear(measured.info.condition)
        if found is not None and isfinite(found.rate.rate):
            rate = f"{found.rate.rate:.3g} ± {found.rate.expanded:.2g} mm3/(N m)"
            below = "" if found.rate.resolved else ", below what the checks resolve"
            yield f"    {found.before_mm:.3f} mm to {found.after_mm:.3f} mm, wear {rate}{below}"


def _table(results: RunResults) -> Iterator[str]:
    """Yield the table of conditions, references last, then the reasons for missing values, and the wear."""
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


class FormatName(click.ParamType["Format | str"]):
    """The name of an export format: one that is shipped, or one of an installed package."""

    name = "format"

    def get_metavar(self, param: click.Parameter, ctx: click.Context) -> str:
        """Return the names there are; nothing is loaded for it."""
        from tester.results.formats import format_names

        return f"[{'|'.join((*format_names(), *SOLVER_NAMES))}]"

    def convert(self, value: str | Format, param: click.Parameter | None, ctx: click.Context | None) -> Format | str:
        """Return the format, loaded; a format of laws by its name."""
        from tester.base.plugins import PluginError
        from tester.results.formats import FORMATS, Format, format_of

        if isinstance(value, Format) or value in SOLVER_NAMES:
            return value
        try:
            return format_of(value)
        except PluginError as error:
            self.fail(f"no format {value!r} (there are {', '.join(FORMATS)}); {error}", param, ctx)


@command()
@click.argument("run")
@click.option("--format", "kind", type=FormatName(), required=True, help="Which table.")
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), default=None, help="File to write (stdout).")
@click.option(
    "--decimals", type=click.IntRange(0, 10), default=2, show_default=True, help="Of the appendix's coefficient."
)
@click.option("--area", type=QuantityType("mm2"), default=None, help="Of a law: area of contact (that in its file).")
@click.option("--points", default="20x20x10", show_default=True, help="Of a law: speeds, pressures, temperatures.")
def export(
    run: str, kind: Format | str, out: Path | None, decimals: int, area: float | None, points: str
) -> None:
    """Write a table of RUN: a run's folder, its name under runs, or latest.

    RUN may be the file of a kept law (`tester fit -o`), for abaqus, ansys, lsdyna or csv: the coefficient over slip
    speed, pressure and temperature, within the law's range.

    Conditions without a value that can be trusted are not in the appendix and are named on stderr; so are values that
    are to be taken with care.
    """
    from tester.inputs.rig.profiles import is_law_file
    from tester.results.formats import Record
    from tester.results.run_files import write_format
    from tester.store.run_reader import RunReader

    if is_law_file(run):
        from tester.cli.export_law import export_law

        export_law(run, kind if isinstance(kind, str) else kind.name, out, area, points)
        return
    if isinstance(kind, str) or area is not None:
        raise click.UsageError(f"{run} is a run: --area and {', '.join(SOLVER_NAMES)} are for a kept law (LAW.yaml)")
    if out is None and not kind.is_text:
        raise click.UsageError(f"{kind.name} is not text: name a file with --out")
    with RunReader(run_folder(run)) as reader:
        record = Record(reader, decimals)
        if out is not None:
            write_format(out, kind, record)
        else:
            kind.write(record, sys.stdout.buffer)
            sys.stdout.flush()
        for remark in kind.remarks(record):
            click.echo(shown(remark), err=True)
