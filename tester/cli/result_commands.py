"""``tester runs``, ``tester show`` and ``tester export``: what is stored, and how it leaves."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Iterator
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from tester.export.results import Measured, RunResults, TableRow
    from tester.store.catalogue import Listing
    from tester.store.reader import RunReader
    from tester.store.records import StoredRun

Json = str | int | float | bool | None | list["Json"] | dict[str, "Json"]

FORMATS = ("appendix", "conditions", "repeats", "samples", "parquet")


def _folder(name: str) -> Path:
    """Return the folder of a run; a name that is none is a usage error."""
    from tester.store.catalogue import find_run
    from tester.store.schema import StoreError

    try:
        return find_run(name)
    except StoreError as error:
        raise click.UsageError(str(error)) from error


def _number(value: float) -> float | None:
    return value if isfinite(value) else None


def _shown(text: str) -> str:
    """Return text that a person or a device wrote, harmless for a terminal."""
    return "".join(c if c.isprintable() else "�" for c in text)


def _dump(value: Json) -> None:
    click.echo(json.dumps(value, ensure_ascii=False, allow_nan=False, indent=1))


def _duration(seconds: float) -> str:
    minutes, s = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{s:02d}"


def _status(run: StoredRun) -> str:
    return "open (running, or cut off)" if run.status == "running" else run.status


# tester runs


@click.command()
@click.option(
    "--out", type=click.Path(file_okay=False, path_type=Path), default=None, help="Folder of the runs (runs)."
)
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
def runs(out: Path | None, as_json: bool) -> None:
    """List the runs that are stored."""
    from tester.store.catalogue import RUNS, list_runs

    listings = list_runs(out or RUNS)
    if as_json:
        _dump([_listing(listing) for listing in listings])
        return
    for listing in listings:
        if listing.run is None:
            click.echo(f"{listing.name}: {_shown(listing.problem)}", err=True)
            continue
        run = listing.run
        click.echo(
            f"{listing.name}  {_status(run)}  {_duration(run.rig_seconds)}  "
            f"{listing.conditions} conditions, {listing.repeats} repeats  {_shown(run.info.recipe_name)}"
        )


def _listing(listing: Listing) -> Json:
    found: dict[str, Json] = {"run": listing.name}
    if listing.run is None:
        return found | {"problem": listing.problem}
    return found | {
        "status": listing.run.status,
        "recipe": listing.run.info.recipe_name,
        "started_utc": listing.run.info.started_utc,
        "ended_utc": listing.run.ended_utc or None,
        "rig_seconds": _number(listing.run.rig_seconds),
        "simulated": listing.run.info.simulated,
        "seed": listing.run.info.seed,
        "conditions": listing.conditions,
        "repeats": listing.repeats,
    }


# tester show


@click.command()
@click.argument("run")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
def show(run: str, as_json: bool) -> None:
    """Show what RUN holds: a run's folder, or its name under runs."""
    from tester.export.results import results_of
    from tester.store.reader import RunReader
    from tester.store.schema import StoreError

    folder = _folder(run)
    try:
        with RunReader(folder) as reader:
            results = results_of(reader)
    except StoreError as error:
        raise click.ClickException(str(error)) from error
    if as_json:
        _dump(_summary(folder.name, results))
        return
    for text in _lines(folder.name, results):
        click.echo(text)


def _summary(name: str, results: RunResults) -> Json:
    run = results.run
    return {
        "run": name,
        "status": run.status,
        "reason": run.reason,
        "recipe": run.info.recipe_name,
        "recipe_sha256": run.recipe_sha256,
        "seed": run.info.seed,
        "simulated": run.info.simulated,
        "operator": run.info.operator,
        "software_version": run.info.software_version,
        "started_utc": run.info.started_utc,
        "ended_utc": run.ended_utc or None,
        "rig_seconds": _number(run.rig_seconds),
        "overruns": run.overruns,
        "metadata": dict(run.info.metadata),
        "rows": len(results.rows) - len(results.missing()),
        "missing": [row.describe() for row in results.missing()],
        "conditions": [_condition(measured) for measured in results.conditions()],
    }


def _condition(measured: Measured) -> Json:
    i, r = measured.info, measured.result
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
        "mu": _number(r.mu_resultant),
        "s": _number(r.s),
        "u_expanded": _number(r.expanded),
        "n_valid": r.n_valid,
        "n": r.n,
        "measured": {name: _number(value) for name, value in r.measured.items()},
        "repeats": [
            {
                "repeat": repeat.repeat,
                "attempt": repeat.attempt,
                "status": repeat.result.status.value,
                "reason": repeat.result.reason,
                "mu": _number(repeat.result.mu_resultant),
            }
            for repeat in measured.repeats
        ],
    }


def _lines(name: str, results: RunResults) -> Iterator[str]:
    run = results.run
    yield f"{name}: {_shown(run.info.recipe_name)}"
    yield f"status   {_status(run)}{': ' + _shown(run.reason) if run.reason else ''}"
    ended = f", ended {run.ended_utc}" if run.ended_utc else ""
    yield f"rig time {_duration(run.rig_seconds)}, started {run.info.started_utc}{ended}"
    if run.overruns:
        yield f"overruns {run.overruns} samples dropped"
    yield f"values   {len(results.rows) - len(results.missing())} of {len(results.rows)} conditions"
    for row in results.rows:
        yield _shown(_row(row))


def _row(row: TableRow) -> str:
    r = row.result
    if not r.ok:
        return f"  {row.describe()}"
    setpoints = row.describe().removesuffix(f": {r.reason}").removesuffix(f": {r.status.value}")
    spread = f" ± {r.expanded:.3f}" if isfinite(r.expanded) else ""
    return f"  {setpoints}: {r.mu_resultant:.3f}{spread} (n {r.n_valid} of {r.n}) {r.flags}".rstrip()


# tester export


@click.command()
@click.argument("run")
@click.option("--format", "kind", type=click.Choice(FORMATS), required=True, help="Which table.")
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), default=None, help="File to write (stdout).")
@click.option(
    "--decimals", type=click.IntRange(0, 10), default=2, show_default=True, help="Of the appendix's coefficient."
)
def export(run: str, kind: str, out: Path | None, decimals: int) -> None:
    """Write a table of RUN: a run's folder, or its name under runs.

    Conditions without a value that can be trusted are not in the appendix and are named on stderr.
    """
    from tester.store.reader import RunReader
    from tester.store.schema import StoreError

    if kind == "parquet" and out is None:
        raise click.UsageError("parquet is not text: name a file with --out")
    folder = _folder(run)
    try:
        with RunReader(folder) as reader:
            _export(reader, kind, out, decimals)
    except (StoreError, OSError) as error:
        if isinstance(error, BrokenPipeError):
            raise
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
    else:
        _deliver(tables.appendix(results, decimals), out)
        for row in results.missing():
            click.echo(f"not in the appendix: {_shown(row.describe())}", err=True)


def _deliver(chunks: Iterable[bytes], out: Path | None) -> None:
    from tester.export import write_file

    if out is not None:
        write_file(out, chunks)
        return
    stream = sys.stdout.buffer
    for chunk in chunks:
        stream.write(chunk)
    stream.flush()
