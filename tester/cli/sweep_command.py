"""`tester sweep`: a recipe over many seeds and rig parameters, on simulated rigs."""

from __future__ import annotations

import json
import os
import sys
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.cli.options import json_option, rig_option

if TYPE_CHECKING:
    from tester.run.sweep.case import CaseResult
    from tester.run.sweep.sweep import SweepOptions


@click.command("sweep")
@click.argument("recipe")
@rig_option
@click.option(
    "--seeds", default=1, show_default=True, metavar="N", type=click.IntRange(1, 10**6), help="Seeds a point."
)
@click.option(
    "--seed",
    "first_seed",
    default=0,
    show_default=True,
    metavar="N",
    type=click.IntRange(0, 2**63 - 10**6),
    help="The first seed; the others follow it.",
)
@click.option(
    "--set",
    "axes",
    multiple=True,
    metavar="KEY=V1,V2,...",
    help="Values of one key of the rig file. Given again for another key: every combination is run.",
)
@click.option(
    "--jobs",
    default=None,
    metavar="N",
    type=click.IntRange(1, 256),
    help="Runs side by side in processes of this machine.  [default: one for each CPU]",
)
@click.option("--dask", "address", default=None, metavar="ADDRESS", help="Use the Dask cluster with this scheduler.")
@click.option("--out", default="sweeps", show_default=True, metavar="DIR", help="Folder that gets the sweep's folder.")
@json_option
def sweep(
    recipe: str,
    rig_name: str,
    seeds: int,
    first_seed: int,
    axes: tuple[str, ...],
    jobs: int | None,
    address: str | None,
    out: str,
    as_json: bool,
) -> int:
    """Run RECIPE on the simulated rig for many seeds and values, and print the sweep's folder as the last line.

    The folder holds every run (runs.csv), its conditions (conditions.csv), their spread over the seeds beside the
    uncertainty the runs state (summary.csv), and durations and wheels (totals.csv). Ctrl+C keeps what is there.
    """
    from tester.run.sweep.grid import GridError, axes_of
    from tester.run.sweep.sweep import (
        NoClusterError,
        NotSimulatedError,
        SweepOptions,
        carry_out,
        dask,
        local,
        prepare_sweep,
    )

    if jobs is not None and address is not None:
        raise click.UsageError("--jobs is for processes of this machine, --dask for a cluster: one of them")
    try:
        options = SweepOptions(recipe, rig_name, axes_of(axes), seeds, first_seed, Path(out))
        prepared = prepare_sweep(options)
    except (GridError, NotSimulatedError, FileNotFoundError) as error:
        raise click.UsageError(str(error)) from error
    executor = dask(address) if address is not None else local(min(jobs or os.cpu_count() or 1, len(prepared.tasks)))
    try:
        with executor as submit:
            folder, code = carry_out(prepared, submit, _Printer(options, as_json=as_json))
    except NoClusterError as error:
        raise click.UsageError(str(error)) from error
    click.echo(str(folder))
    return code


class _Printer:
    """Reports to people on standard error and, with ``as_json``, to programs in JSON lines on standard output."""

    def __init__(self, options: SweepOptions, *, as_json: bool) -> None:
        self.keys = [axis.key for axis in options.axes]
        self.as_json = as_json
        self.runs = 0

    def begin(self, folder: Path, runs: int) -> None:
        """Report where the results will be."""
        self.runs = runs
        self._emit({"event": "begin", "folder": str(folder), "runs": runs})
        click.echo(f"{runs} runs into {folder}", err=True)

    def ran(self, result: CaseResult, done: int) -> None:
        """Report how a run ended, and what is missing."""
        from tester.run.sweep.sweep_tables import row_record

        record = {key: _json(value) for key, value in asdict(result).items() if key not in ("point", "rows")}
        record["set"] = dict(zip(self.keys, result.point, strict=True))
        rows = [{key: _json(value) for key, value in row_record(row).items()} for row in result.rows]
        self._emit({"event": "run", **record, "missing": result.missing, "rows": rows})
        point = "".join(f"{key}={value}, " for key, value in zip(self.keys, result.point, strict=True))
        missing = f", {result.missing} of {len(result.rows)} conditions missing" if result.missing else ""
        doubts = f", {result.with_care} to be taken with care" if result.with_care else ""
        reason = f": {result.reason}" if result.reason else ""
        ended = f"{result.outcome}{missing}{doubts}{reason}"
        click.echo(f"{done}/{self.runs}  {point}seed {result.seed}: {ended}", err=True)

    def _emit(self, record: dict[str, object]) -> None:
        if self.as_json:
            sys.stdout.write(json.dumps(record, ensure_ascii=False, allow_nan=False) + "\n")
            sys.stdout.flush()


def _json(value: object) -> object:
    """Return what JSON knows: null for not-a-number."""
    return None if isinstance(value, float) and not isfinite(value) else value
