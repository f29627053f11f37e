"""`tester commission`: guide a person from plugged adapters to a first trusted coefficient."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.base.keys import FAST_STOP, STOP
from tester.base.processes import EXIT_DONE, EXIT_FAILED, EXIT_INCOMPLETE, EXIT_INVALID, EXIT_TRIPPED
from tester.cli.console import Console
from tester.cli.options import SpeedType, risk_option, seed_option, set_option
from tester.cli.tui_command import SWITCH_S, need_terminal
from tester.machine.commission.person import Person
from tester.machine.prompts import Prompt, Question

if TYPE_CHECKING:
    from tester.inputs.rig import Rig
    from tester.machine.commission.commission_step import CommissionStep
    from tester.machine.commission.step_engine import CommissionOutcome
    from tester.run.commissioning import CommissionOptions

EXIT_CODES = {
    "DONE": EXIT_DONE, "REFUSED": EXIT_INVALID, "FAILED": EXIT_FAILED, "STOPPED": EXIT_TRIPPED, "LEFT": EXIT_INCOMPLETE,
}  # fmt: skip
"""By the name of the ending (tester.machine.commission.step_engine.Ended)."""


@click.command()
@click.argument("rig", metavar="RIG")
@set_option
@risk_option
@seed_option
@click.option("--out", type=click.Path(path_type=Path), default=Path("runs"), show_default=True, metavar="FOLDER",
              help="Folder of the runs; the record is in its folder commissioning.")
@click.option("--operator", default="", metavar="NAME", help="Who commissions; stored with every entry of the record.")
@click.option("--compound", default="", metavar="NAME",
              help='Compound of the first wheel, e.g. "1#"; you are asked to confirm it.')
@click.option("--yes", is_flag=True, help="Simulated rig only: a simulated person reads ruler, weight, thermometer.")
@click.option("--tui", is_flag=True, help="On a screen: steps, live readings, the question, the record.")
@click.option("--speed", type=SpeedType(), default="max", show_default=True, metavar="X",
              help="Rig seconds per second of a simulated rig, or max.")
@click.option("--theme", type=click.Choice(["dark", "light", "16"]), default=None, help="Colours of --tui.")
@click.option("--ascii", "plain", is_flag=True, help="--tui: draw with ASCII characters only.")
@click.option("--list", "only_list", is_flag=True, help="List which steps are done, and do nothing.")
def commission(
    rig: str, overrides: tuple[str, ...], accept_risk: str, seed: int, out: Path, operator: str,
    compound: str, yes: bool, tui: bool, speed: float | None, theme: str | None, plain: bool, only_list: bool,
) -> int:  # fmt: skip
    """Guide a person through commissioning RIG (a rig file, or sim), step by step, each on record.

    A step on record is not repeated, unless the rig file has changed under it. Exit codes: 0 every step is done, 3 a
    step was refused (with what to change), 1 it failed, 5 stopped, 6 left before the end.
    """
    from tester.machine.commission.record import RecordError, record_path
    from tester.run.commissioning import CommissionOptions, part_of
    from tester.run.endings import CannotStartError
    from tester.run.kind_lookup import load_rig

    loaded = load_rig(rig, overrides, accept_risk)
    simulated = loaded.can.interface == "sim"
    if yes and not simulated:
        raise click.UsageError("--yes: only a person can read a ruler at a real rig")
    if yes and tui:
        raise click.UsageError("--yes and --tui: either a simulated person answers, or the one at the screen")
    part = part_of(loaded)
    if simulated and compound and compound not in part.compounds:
        expected = ", ".join(part.compounds)
        raise click.UsageError(f'--compound: no friction model for "{compound}" to simulate it (expected {expected})')
    options = CommissionOptions(
        rig=rig, overrides=overrides, accept_risk=accept_risk, out=out, seed=seed, operator=operator, lapse=speed,
        compound=compound,
    )  # fmt: skip
    path = record_path(out, loaded.name)
    try:
        if only_list:
            _list(path, part.steps, loaded)
            return EXIT_DONE
        if tui:
            outcome = _on_screen(lambda: load_rig(rig, overrides, accept_risk), options, theme or "", plain=plain)
        else:
            twin = part.twin(lambda text: click.echo(text, err=True)) if yes else None
            outcome = _line_by_line(loaded, options, twin)
    except (CannotStartError, RecordError) as error:
        raise click.ClickException(str(error)) from error
    _summarise(outcome)
    click.echo(str(path))
    return EXIT_CODES[outcome.ended.name]


def _summarise(outcome: CommissionOutcome) -> None:
    """Print the rig time of each step, and how the commissioning ended."""
    for name, seconds in outcome.took_s:
        click.echo(f"  {name:16} {seconds:6.1f} s of rig time", err=True)
    at = f" at: {outcome.step}" if outcome.step else ""
    click.echo(f"{outcome.ended.value}{at}; {outcome.rig_s / 60:.1f} min of rig time", err=True)


def _line_by_line(rig: Rig, options: CommissionOptions, twin: Person | None) -> CommissionOutcome:
    """Commission with the simulated person ``twin`` if there is one, else with the person at this terminal."""
    from tester.run.commissioning import commission

    if twin is not None:
        return commission(rig, options, twin)
    if not sys.stdin.isatty():
        raise click.UsageError("commissioning asks a person, and this is no interactive terminal")
    person = TerminalPerson(time_stands=rig.can.interface == "sim")
    person.begin()
    try:
        return commission(rig, options, person)
    finally:
        person.end()


class TerminalPerson(Console, Person):
    """The person at this terminal: questions as lines, answers typed, STOP by its keys at any time."""

    always = (STOP, FAST_STOP)

    def __init__(self, *, time_stands: bool) -> None:
        """``time_stands``: on a rig simulated in this process."""
        super().__init__(as_json=False, answer_yes=False)
        self.time_stands = time_stands

    def begin(self, name: str = "") -> None:
        """Take the keyboard."""
        self._keys.begin()
        self.message(f"{STOP.shown}: {STOP.does}   {FAST_STOP.shown}: {FAST_STOP.does}   at any time")

    def commands(self) -> list[str]:
        return [command for command in super().commands() if command in (STOP.command, FAST_STOP.command)]

    def put(self, question: Question) -> None:
        self.message(f"? {question.text}  [{question.hint}]")

    def answer(self, prompt: Prompt, typed: str) -> None:
        self.message(f"> {typed.strip()}")
        refusal = prompt.reply(typed)
        if refusal:
            self.message(refusal)
            self.put(prompt.question)


def _on_screen(load: Callable[[], Rig], options: CommissionOptions, theme: str, *, plain: bool) -> CommissionOutcome:
    """Commission with the person at this screen; the rig is at rest when this returns, however it ends."""
    need_terminal("tester commission --tui", "`tester commission RIG` asks line by line")
    from tester.base.processes import stopped_by_signals
    from tester.tui.guide.guide import Guide
    from tester.tui.guide.guide_app import GuideApp

    guide = Guide(load, options)
    app = GuideApp(guide, theme=theme, plain=plain)

    def stop(*, fast: bool) -> None:
        guide.person.press(fast=fast)
        app.exit("")

    sys.setswitchinterval(SWITCH_S)
    try:
        with stopped_by_signals(stop):
            app.run()
    finally:
        guide.close()
    if guide.outcome is None:
        raise click.ClickException(guide.trouble or "the screen ended before any step began")
    return guide.outcome


def _list(path: Path, steps: tuple[CommissionStep, ...], rig: Rig) -> None:
    """Print a line for each step: whether it is done, since when, by whom."""
    from tester.machine.commission.record import CommissionRecord, standing_of

    for state in standing_of(CommissionRecord(path, str, ""), steps, rig):
        click.echo(f"{state.step.name:16} {state.words}")
