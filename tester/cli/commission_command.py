"""`tester commission`: guide a person from plugged adapters to a first trusted coefficient."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.base.exits import EXIT_DONE, EXIT_FAILED, EXIT_INCOMPLETE, EXIT_INVALID, EXIT_TRIPPED
from tester.cli.options import risk_option, seed_option, set_option

if TYPE_CHECKING:
    from tester.commission.engine import CommissionOutcome
    from tester.commission.step import CommissionStep
    from tester.rig import Rig
    from tester.run.commissioning import CommissionOptions


@click.command()
@click.argument("rig", metavar="RIG")
@set_option
@risk_option
@seed_option
@click.option("--out", type=click.Path(path_type=Path), default=Path("runs"), show_default=True, metavar="FOLDER",
              help="Folder of the runs; the record is in its folder commissioning.")
@click.option("--operator", default="", metavar="NAME", help="Who commissions; goes on record with every entry.")
@click.option("--compound", default="", metavar="NAME",
              help='What the first wheel is made of, e.g. "1#"; you are asked, with this as the answer.')
@click.option("--yes", is_flag=True, help="Simulated rig only: a simulated person reads ruler, weight, thermometer.")
@click.option("--list", "only_list", is_flag=True, help="Say which steps stand, and do nothing.")
def commission(
    rig: str, overrides: tuple[str, ...], accept_risk: str, seed: int, out: Path, operator: str,
    compound: str, yes: bool, only_list: bool,
) -> int:  # fmt: skip
    """Guide a person through commissioning RIG (a rig file, or sim), step by step, each on record.

    What stands on record is not done again, unless the rig file has changed under it. Exit codes: 0 everything stands,
    3 a step was refused (with what to change), 1 it failed, 5 stopped, 6 left before the end.
    """
    from tester.commission.engine import Ended
    from tester.commission.record import RecordError
    from tester.run.commissioning import CommissionOptions, commission, part_of, record_path
    from tester.run.endings import CannotStartError
    from tester.run.rigs import load_rig

    found = load_rig(rig, overrides, accept_risk)
    simulated = found.can.interface == "sim"
    if yes and not simulated:
        raise click.UsageError("--yes: only a person can read a ruler at a real rig")
    part = part_of(found)
    if simulated and compound and compound not in part.compounds:
        expected = ", ".join(part.compounds)
        raise click.UsageError(f'--compound: no friction model for "{compound}" to simulate it (expected {expected})')
    try:
        if only_list:
            _list(record_path(out, found), part.steps, found)
            return EXIT_DONE
        options = CommissionOptions(rig, overrides, accept_risk, out, seed, operator, compound)
        if yes:
            twin = part.twin(lambda text: click.echo(text, err=True))
            outcome = commission(found, options, twin, twin)
        else:
            outcome = _at_terminal(found, options, commission, time_stands=simulated)
    except (CannotStartError, RecordError) as error:
        raise click.ClickException(str(error)) from error
    for name, seconds in outcome.took_s:
        click.echo(f"  {name:16} {seconds:6.1f} s of rig time", err=True)
    click.echo(f"{outcome.ended.value}{f' at: {outcome.step}' if outcome.step else ''}"
               f"; {outcome.rig_s / 60:.1f} min of rig time", err=True)  # fmt: skip
    click.echo(str(record_path(out, found)))
    codes = {
        Ended.DONE: EXIT_DONE, Ended.REFUSED: EXIT_INVALID, Ended.FAILED: EXIT_FAILED, Ended.STOPPED: EXIT_TRIPPED,
        Ended.LEFT: EXIT_INCOMPLETE,
    }  # fmt: skip
    return codes[outcome.ended]


def _at_terminal(
    rig: Rig, options: CommissionOptions, commission: Callable[..., CommissionOutcome], *, time_stands: bool
) -> CommissionOutcome:
    """Commission with whoever is at this terminal."""
    from tester.cli.commission_person import TerminalPerson

    if not sys.stdin.isatty():
        raise click.UsageError("commissioning asks a person, and nobody is at this terminal")
    person = TerminalPerson(time_stands=time_stands)
    person.begin()
    try:
        return commission(rig, options, person)
    finally:
        person.end()


def _list(path: Path, steps: tuple[CommissionStep, ...], rig: Rig) -> None:
    """Print a line a step: whether it stands, since when, by whom."""
    from tester.commission.record import CommissionRecord
    from tester.commission.step import sections_sha256

    record = CommissionRecord(path, str, "")
    for step in steps:
        entry = record.standing(step.name, sections_sha256(rig, step.sections))
        last = record.last(step.name)
        if entry is not None:
            said = f"stands since {entry.at[:10]}, {entry.by}: {entry.text}"
        elif last is not None:
            said = f"to be done again ({last.what} {last.at[:10]}): {last.text}"
        else:
            said = "to be done"
        click.echo(f"{step.name:16} {said}")
