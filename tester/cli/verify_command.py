"""`tester verify`: whether a run is unchanged."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import click

from tester.base.processes import EXIT_DONE, EXIT_FAILED, EXIT_INCOMPLETE
from tester.cli.options import command, json_option, print_json
from tester.cli.stored_runs import run_folder
from tester.cli.text_table import fields

if TYPE_CHECKING:
    from tester.results.verify import Verification


def _hash(_context: click.Context, _parameter: click.Parameter, value: str) -> str:
    """Return a hash; refuse any other text: a mistyped hash must not read as a forged record."""
    if value and not re.fullmatch(r"[0-9a-fA-F]{64}", value):
        raise click.BadParameter(f"expected 64 hexadecimal digits, got {value!r}")
    return value


@command()
@click.argument("run")
@click.option("--head", metavar="HASH", default="", callback=_hash, help="The record's head as you have kept it.")
@json_option
def verify(run: str, head: str, as_json: bool) -> int:
    """Check RUN: the chain over its record, every coefficient by its samples, its tables, manifest, recipe, rig file.

    The record's head is shown at a run's end, and here. A person who can write the folder can make everything in it
    anew; --head, with the head that you have kept elsewhere, shows that as well.

    Exit code 0: unchanged, and its plan is complete. 1: something differs, each difference on stderr. 6: unchanged, and
    its plan is not complete.
    """
    from tester.results.verify import verify as check

    folder = run_folder(run)
    found = check(folder, head)
    code = EXIT_FAILED if found.problems else EXIT_DONE if found.status.over else EXIT_INCOMPLETE
    if as_json:
        print_json(_record(folder.name, found, code))
    elif not found.problems:
        by_hand = f"; excluded by hand: {found.excluded}" if found.excluded else ""
        read = f"{found.samples} samples in {found.blocks} blocks read, {found.coefficients} coefficients recomputed"
        click.echo(f"{folder.name}: as it was left, {found.status}; {read}{by_hand}")
    if found.head and not as_json:
        click.echo(f"record head: {found.head}")
    for problem in found.problems:
        click.echo(f"{folder.name}: {problem}", err=True)
    return code


def _record(name: str, found: Verification, code: int) -> dict[str, object]:
    from tester import __version__

    run = found.run
    record: dict[str, object] = {
        "run": name,
        "problems": list(found.problems),
        "complete": found.status.over,
        **fields(found, "blocks samples excluded coefficients"),
        "record_head": found.head,
        "verified_with": __version__,
        "exit": code,
    }
    if run is None:
        return record
    return record | {
        "status": found.status.value,
        **fields(run, "recipe_sha256 rig_sha256 calibration_sha256"),
        **fields(run.info, "software_version git_revision"),
        "versions": dict(run.info.versions),
    }
