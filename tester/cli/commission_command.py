"""`tester commission`: guide a person from plugged adapters to a first trusted coefficient."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

import click

from tester.base.processes import EXIT_DONE, EXIT_FAILED, EXIT_INCOMPLETE, EXIT_INVALID, EXIT_TRIPPED
from tester.cli.options import SpeedType, risk_option, seed_option, set_option
from tester.cli.tui_command import SWITCH_S, need_terminal

if TYPE_CHECKING:
    from tester.inputs.rig import Rig
    from tester.machine.commission.commission_step import CommissionStep
    from tester.machine.commission.step_engine import CommissionOutcome
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
@click.option("--tui", is_flag=True, help="On a screen: steps, live readings, the question, what is on record.")
@click.option("--speed", type=SpeedType(), default="max", show_default=True, metavar="X",
              help="Rig seconds per second of a simulated rig, or max.")
@click.option("--theme", type=click.Choice(["dark", "light", "16"]), default=None, help="Colours of --tui.")
@click.option("--ascii", "plain", is_flag=True, help="--tui: draw with ASCII characters only.")
@click.option("--list", "only_list", is_flag=True, help="Say which steps stand, and do nothing.")
def commission(
    rig: str, overrides: tuple[str, ...], accept_risk: str, seed: int, out: Path, operator: str,
    compound: str, yes: bool, tui: bool, speed: float | None, theme: str | None, plain: bool, only_list: bool,
) -> int:  # fmt: skip
    """Guide a person through commissioning RIG (a rig file, or sim), step by step, each on record.

    What stands on record is not done again, unless the rig file has changed under it. Exit codes: 0 everything stands,
    3 a step was refused (with what to change), 1 it failed, 5 stopped, 6 left before the end.
    """
    from tester.machine.commission.record import RecordError, record_path
    from tester.machine.commission.step_engine import Ended
    from tester.run.commissioning import CommissionOptions, commission, part_of
    from tester.run.endings import CannotStartError
    from tester.run.kind_lookup import load_rig

    found = load_rig(rig, overrides, accept_risk)
    simulated = found.can.interface == "sim"
    if yes and not simulated:
        raise click.UsageError("--yes: only a person can read a ruler at a real rig")
    if yes and tui:
        raise click.UsageError("--yes and --tui: either a simulated person answers, or the one at the screen")
    part = part_of(found)
    if simulated and compound and compound not in part.compounds:
        expected = ", ".join(part.compounds)
        raise click.UsageError(f'--compound: no friction model for "{compound}" to simulate it (expected {expected})')
    options = CommissionOptions(rig, overrides, accept_risk, out, seed, operator, compound, speed)
    try:
        if only_list:
            _list(record_path(out, found.name), part.steps, found)
            return EXIT_DONE
        if tui:
            outcome = _on_screen(lambda: load_rig(rig, overrides, accept_risk), options, theme or "", plain=plain)
        elif yes:
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
    click.echo(str(record_path(out, found.name)))
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


def _on_screen(load: Callable[[], Rig], options: CommissionOptions, theme: str, *, plain: bool) -> CommissionOutcome:
    """Commission with whoever is at this screen; however it ends, what moves is at rest when this returns."""
    need_terminal("tester commission --tui", "`tester commission RIG` asks line by line")
    from tester.base.processes import handled
    from tester.tui.guide.guide import Guide
    from tester.tui.guide.guide_app import GuideApp

    guide = Guide(load, options)
    app = GuideApp(guide, theme=theme, plain=plain)
    asked = 0

    def on_signal(_number: int, _frame: FrameType | None) -> None:
        nonlocal asked
        asked += 1
        guide.person.press(fast=asked > 1)
        app.exit("")

    sys.setswitchinterval(SWITCH_S)
    try:
        with handled(on_signal):
            app.run()
    finally:
        guide.close()
    if guide.outcome is None:
        raise click.ClickException(guide.trouble or "the screen has ended before anything was begun")
    return guide.outcome


def _list(path: Path, steps: tuple[CommissionStep, ...], rig: Rig) -> None:
    """Print a line a step: whether it stands, since when, by whom."""
    from tester.machine.commission.record import CommissionRecord, standing_of

    for one in standing_of(CommissionRecord(path, str, ""), steps, rig):
        click.echo(f"{one.step.name:16} {one.words}")
