"""`tester verify`: is a run as it was left?"""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from tester.cli.finding import run_folder
from tester.cli.options import json_option, print_json

if TYPE_CHECKING:
    from tester.export.verify import Verification

EXIT_DIFFERS = 1
EXIT_INCOMPLETE = 6


@click.command()
@click.argument("run")
@json_option
def verify(run: str, as_json: bool) -> int:
    """Check RUN: its manifest, its database, every sample block, recipe and rig file.

    Exit code 0: as it was left, and its plan was gone through. 1: something differs, each named on stderr. 6: as it
    was left, and its plan was not gone through.
    """
    from tester.export.verify import verify as check

    folder = run_folder(run)
    found = check(folder)
    code = EXIT_DIFFERS if found.problems else 0 if found.status.over else EXIT_INCOMPLETE
    if as_json:
        print_json(_record(folder.name, found, code))
    elif not found.problems:
        by_hand = f"; excluded by hand: {found.excluded}" if found.excluded else ""
        read = f"{found.samples} samples in {found.blocks} blocks read"
        click.echo(f"{folder.name}: as it was left, {found.status}; {read}{by_hand}")
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
        "blocks": found.blocks,
        "samples": found.samples,
        "excluded": found.excluded,
        "verified_with": __version__,
        "exit": code,
    }
    if run is None:
        return record
    return record | {
        "status": found.status.value,
        "recipe_sha256": run.recipe_sha256,
        "rig_sha256": run.rig_sha256,
        "calibration_sha256": run.calibration_sha256,
        "software_version": run.info.software_version,
        "git_revision": run.info.git_revision,
        "versions": dict(run.info.versions),
    }
