"""``tester show`` and ``tester export``: what a run holds, and how it leaves."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.cli.finding import run_folder
from tester.cli.showing import Json, dump, duration, number, shown

if TYPE_CHECKING:
    from tester.analysis.wear import WearRate
    from tester.export.results import Measured, RunResults, TableRow
    from tester.store.reader import RunReader
    from tester.store.records import Change, SessionInfo, StoredExclusion, StoredTrip, WheelInfo

FORMATS = ("appendix", "conditions", "repeats", "wheel", "wear", "samples", "parquet")


# tester show


@click.command()
@click.argument("run")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
def show(run: str, as_json: bool) -> None:
    """Show what RUN holds: a run's folder, its name under runs, or latest."""
    from tester.export.results import results_of
    from tester.store.reader import RunReader
    from tester.store.schema import StoreError

    folder = run_folder(run)
    try:
        with RunReader(folder) as reader:
            results, sessions, changes = results_of(reader), reader.sessions(), reader.changes()
            said, trips, commands = reader.exclusions(), [*reader.trips()], [*reader.commands()]
    except StoreError as error:
        raise click.ClickException(str(error)) from error
    if as_json:
        history: dict[str, Json] = {"sessions": [*map(_session, sessions)], "changes": [*map(_change, changes)]}
        history["exclusions"] = [*map(_word, said)]
        history["trips"] = [*map(_trip, trips)]
        history["commands"] = [{"t_s": number(one.t_s), "utc": one.utc, "text": one.text} for one in commands]
        dump(_summary(folder.name, results) | history)
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
    for trip in trips:
        compared = f" ({trip.compared})" if trip.compared else ""
        click.echo(f"trip at {duration(trip.t_s)} of rig time, {trip.utc}: {trip.interlock}{compared}")
        click.echo(f"  {shown(trip.acknowledged)}")
    for word in said:
        what = "excluded" if word.excluded else "included again"
        who = f" by {shown(word.operator)}" if word.operator else ""
        click.echo(f"{word.condition}/{word.repeat} {what} {word.utc}{who}: {shown(word.reason)}")


def _session(session: SessionInfo) -> Json:
    return {
        "session": session.session,
        "origin_s": session.origin_s,
        "started_utc": session.started_utc,
        "host": session.host,
        "operator": session.operator,
        "software_version": session.software_version,
        "git_revision": session.git_revision,
    }


def _change(change: Change) -> Json:
    return {
        "session": change.session,
        "utc": change.utc,
        "subject": change.subject,
        "before_sha256": change.before_sha256,
        "after_sha256": change.after_sha256,
        "reason": change.reason,
    }


def _trip(trip: StoredTrip) -> Json:
    return {
        "t_s": number(trip.t_s),
        "utc": trip.utc,
        "interlock": trip.interlock,
        "text": trip.text,
        "value": number(trip.value),
        "limit": number(trip.limit_value),
        "unit": trip.unit,
        "acknowledged_s": number(trip.acknowledged_s),
        "acknowledged_utc": trip.acknowledged_utc or None,
        "acknowledged_by": trip.acknowledged_by,
    }


def _word(word: StoredExclusion) -> Json:
    return {
        "condition": word.condition,
        "repeat": word.repeat,
        "attempt": word.attempt,
        "excluded": bool(word.excluded),
        "reason": word.reason,
        "operator": word.operator,
        "utc": word.utc,
        "software_version": word.software_version,
    }


def _summary(name: str, results: RunResults) -> dict[str, Json]:
    run = results.run
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
        "started_utc": run.info.started_utc,
        "ended_utc": run.ended_utc or None,
        "rig_seconds": number(run.rig_seconds),
        "overruns": run.overruns,
        "metadata": dict(run.info.metadata),
        "rows": len(results.rows) - len(results.missing()),
        "missing": [row.describe() for row in results.missing()],
        "conditions": [_condition(measured, results) for measured in results.conditions()],
        "wheels": [_wheel(wheel, results) for wheel in results.wheels],
    }


def _rate(found: WearRate) -> dict[str, Json]:
    return {"wear_mm3_n_m": number(found.rate), "wear_u_expanded": number(found.expanded), "checks": found.checks}


def _wheel(wheel: WheelInfo, results: RunResults) -> Json:
    return {
        "wheel": wheel.wheel,
        "compound": wheel.compound,
        "installed_diameter_mm": number(wheel.installed_diameter_mm),
        "diameter_mm": number(wheel.diameter_mm),
        "sliding_m": number(wheel.sliding_m),
        **_rate(results.wear_of(wheel.wheel)),
    }


def _condition(measured: Measured, results: RunResults) -> Json:
    from tester.analysis.results import flags_in
    from tester.analysis.trust import mark_of

    i, r = measured.info, measured.result
    worn = results.condition_wear(i.condition)
    return {
        "condition": i.condition,
        "specimen": i.specimen,
        "replicate": i.replicate,
        "compound": i.compound,
        "slip_velocity_mm_s": round(1e3 * i.slip_velocity_m_s, 6),
        "load_n": i.load_n,
        "sideslip_deg": i.sideslip_deg,
        "camber_deg": i.camber_deg,
        "temperature_c": i.temperature_c,
        "wheel_speed_m_s": i.wheel_speed_m_s,
        "status": r.status.value,
        "reason": r.reason,
        "mu": number(r.mu_resultant),
        "mark": mark_of(r.status, r.flags) if isfinite(r.mu_resultant) else "",
        "flags": [*flags_in(r.flags)],
        "s": number(r.s),
        "u_expanded": number(r.expanded),
        "n_valid": r.n_valid,
        "n": r.n,
        "diameter_before_mm": number(worn.before_mm) if worn is not None else None,
        "diameter_after_mm": number(worn.after_mm) if worn is not None else None,
        "wear": _rate(worn.rate) if worn is not None else None,
        "measured": {name: number(value) for name, value in r.measured.items()},
        "repeats": [
            {
                "repeat": repeat.repeat,
                "attempt": repeat.attempt,
                "status": repeat.result.status.value,
                "reason": repeat.result.reason,
                "mu": number(repeat.result.mu_resultant),
                "exclusion": measured.exclusion(repeat),
            }
            for repeat in measured.repeats
        ],
    }


def _lines(name: str, results: RunResults) -> Iterator[str]:
    from tester.cli.ending import risk_lines

    run = results.run
    yield f"{name}: {shown(run.info.recipe_name)}"
    yield f"status   {results.status}{': ' + shown(run.reason) if run.reason else ''}"
    yield from risk_lines(results)
    ended = f", ended {run.ended_utc}" if run.ended_utc else ""
    yield f"rig time {duration(run.rig_seconds)}, started {run.info.started_utc}{ended}"
    if run.overruns:
        yield f"overruns {run.overruns} samples dropped"
    yield f"values   {len(results.rows) - len(results.missing())} of {len(results.rows)} conditions"
    for row in results.rows:
        if row.tried:
            yield shown(_row(row))
            yield from _worn(row, results)
    left = sum(not row.tried for row in results.rows)
    if left:
        yield f"  {left} of {len(results.rows)} conditions not measured"
    for line in results.wear_lines():
        yield shown(line)


def _worn(row: TableRow, results: RunResults) -> Iterator[str]:
    """Yield what each replicate of a condition took off its wheel, where the wheel was checked."""
    for measured in row.replicates:
        found = results.condition_wear(measured.info.condition)
        if found is not None and isfinite(found.rate.rate):
            rate = f"{found.rate.rate:.3g} ± {found.rate.expanded:.2g} mm3/(N m)"
            below = "" if found.rate.resolved else ", below what the checks resolve"
            yield f"    {found.before_mm:.3f} mm to {found.after_mm:.3f} mm, wear {rate}{below}"


def _row(row: TableRow) -> str:
    from tester.analysis.trust import mark_of

    r = row.result
    if not r.ok:
        return f"  {row.describe()}"
    setpoints = row.describe().removesuffix(f": {r.reason}").removesuffix(f": {r.status.value}")
    spread = f" ± {r.expanded:.3f}" if isfinite(r.expanded) else ""
    mu = f"{r.mu_resultant:.3f}{mark_of(r.status, r.flags)}"
    return f"  {setpoints}: {mu}{spread} (n {r.n_valid} of {r.n}) {r.flags}".rstrip()


# tester export


@click.command()
@click.argument("run")
@click.option("--format", "kind", type=click.Choice(FORMATS), required=True, help="Which table.")
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), default=None, help="File to write (stdout).")
@click.option(
    "--decimals", type=click.IntRange(0, 10), default=2, show_default=True, help="Of the appendix's coefficient."
)
def export(run: str, kind: str, out: Path | None, decimals: int) -> None:
    """Write a table of RUN: a run's folder, its name under runs, or latest.

    Conditions without a value that can be trusted are not in the appendix and are named on stderr; so are values that
    are to be taken with care.
    """
    from tester.extras import MissingExtraError
    from tester.store.reader import RunReader
    from tester.store.schema import StoreError

    if kind == "parquet" and out is None:
        raise click.UsageError("parquet is not text: name a file with --out")
    folder = run_folder(run)
    try:
        with RunReader(folder) as reader:
            _export(reader, kind, out, decimals)
    except MissingExtraError as error:
        raise click.UsageError(str(error)) from error
    except StoreError as error:
        raise click.ClickException(str(error)) from error


def _export(reader: RunReader, kind: str, out: Path | None, decimals: int) -> None:
    from tester import export as tables

    if kind == "parquet" and out is not None:
        tables.write_parquet_file(out, reader)
        return
    if kind == "samples":
        _deliver(tables.samples(reader), out)
        return
    results = tables.results_of(reader)
    if kind == "conditions":
        _deliver(tables.conditions(results), out)
    elif kind == "repeats":
        _deliver(tables.repeats(results), out)
    elif kind == "wheel":
        _deliver(tables.wheels(results), out)
    elif kind == "wear":
        _deliver(tables.wear(results), out)
    else:
        _deliver(tables.appendix(results, decimals), out)
        for row in results.missing():
            click.echo(f"not in the appendix: {shown(row.describe())}", err=True)
        for row in results.doubtful():
            click.echo(f"to be taken with care: {shown(row.advise())}", err=True)


def _deliver(chunks: Iterable[bytes], out: Path | None) -> None:
    from tester.export import write_file

    if out is not None:
        write_file(out, chunks)
        return
    stream = sys.stdout.buffer
    for chunk in chunks:
        stream.write(chunk)
    stream.flush()
