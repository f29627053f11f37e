"""`tester run` and `tester resume`: a recipe on a rig, in the foreground."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import click
from click.core import ParameterSource

from tester.cli.options import (
    RigChoice,
    bus_log_option,
    command,
    hands_option,
    json_option,
    lapse_option,
    operator_option,
    rig_options,
    risk_option,
    runs_option,
    seed_option,
    yes_option,
)
from tester.cli.recipe_commands import recipe_file
from tester.cli.stored_runs import run_folder

NOT_DETACHED = {
    "out": "--out", "bus_log": "--bus-log", "faults": "--fault", "jobs": "--jobs", "as_json": "--json",
    "hands": "--hands", "no_leaps": "--no-leaps", "accept_risk": "--accept-risk",
}  # fmt: skip
"""Options that the service has no command for, or chooses itself."""


@command()
@click.argument("recipe")
@rig_options
@runs_option("Folder that gets the run's folder.")
@yes_option
@seed_option
@lapse_option
@click.option(
    "--jobs", default=1, show_default=True, metavar="N", type=click.IntRange(1, 256),
    help="Simulated rig: processes in which specimens run side by side; the results are the same.",
)
@bus_log_option
@hands_option
@click.option(
    "--no-leaps", is_flag=True,
    help="Simulated rig: make every scan, also while only heat flows; coefficients differ by 0.02 % at most.",
)
@click.option(
    "--fault", "faults", multiple=True, metavar="TEXT",
    help='Simulated rig: let something fail, e.g. "t=130 s: belt drive heartbeat lost for 3 s". May be given again.',
)
@operator_option
@click.option("--detach", is_flag=True, help="Have the service run it (`tester serve`), and return.")
@click.option("--take", is_flag=True, help="With --detach: take control from the client that has it.")
@json_option
@click.pass_context
def run(
    context: click.Context, recipe: str, rig: RigChoice, out: Path, yes: bool, seed: int, speed: float | None,
    jobs: int, bus_log: Path | None, hands: str, no_leaps: bool, faults: tuple[str, ...], operator: str, detach: bool,
    take: bool, as_json: bool,
) -> int:  # fmt: skip
    """Run RECIPE (a file, or the name of a shipped recipe) and print the run's folder as the last line.

    The results precede it on stderr, with their expanded uncertainty (95 %); stdout is the folder alone.

    Ctrl+C stops in a controlled way; a second one stops fast. On a terminal: F12 or Ctrl+X stops in a controlled
    way, F9 or Ctrl+F fast, space holds (lifts, keeps the heat), r resumes.
    """
    if detach:
        from tester.cli.service_commands import give
        from tester.service.commands import RunRecipe

        typed = _full_name(_detachable(context, rig))
        action = RunRecipe(
            _full_name(recipe), rig=typed, overrides=rig.overrides, seed=seed, speed=speed, yes=yes, operator=operator
        )
        return give("", action, take, show_folder=True)
    if take:
        raise click.UsageError("--take: a run in the foreground needs no control; it goes with --detach")
    recipe_file(recipe)
    if not as_json:
        # Loading what the run needs takes a moment: report the beginning before that.
        click.echo(f"{recipe} on rig {rig.name}", err=True)
    from tester.cli.console import Console
    from tester.run.session import Session
    from tester.run.session_options import SessionOptions

    options = SessionOptions(
        recipe, *rig, out=out, seed=seed, lapse=speed, bus_log=bus_log, operator=operator, jobs=jobs, faults=faults,
        leaps=not no_leaps, hands=hands,
    )
    return _carried_out(Session(options, Console(as_json=as_json, answer_yes=yes)).run)


def _detachable(context: click.Context, rig: RigChoice) -> str:
    """Return the typed rig, "" for the service's; an option that the service does not take is a usage error."""
    given = {name for name in context.params if context.get_parameter_source(name) is ParameterSource.COMMANDLINE}
    if rig.accept_risk:
        raise click.UsageError("--accept-risk goes with `tester serve`, which owns the rig: not with --detach")
    if kept := [option for name, option in NOT_DETACHED.items() if name in given]:
        raise click.UsageError(f"not with --detach, the service would not do it: {', '.join(kept)}")
    return rig.name if "rig_name" in given else ""


def _full_name(name: str) -> str:
    """Return a file's path as the service finds it from its own folder; any other name unchanged."""
    return str(Path(name).resolve()) if Path(name).is_file() else name


def _carried_out(work: Callable[[], int]) -> int:
    """Do the work and return its exit code; print the reason why it cannot begin. Raises StoreError, OSError."""
    from tester.run.endings import CannotStartError

    try:
        return work()
    except CannotStartError as error:
        click.echo(str(error), err=True)
        return error.code


@command()
@click.argument("run")
@yes_option
@click.option(
    "--reason", default="", metavar="TEXT",
    help="Resume although recipe, rig or calibration changed; stored with the run.",
)
@lapse_option
@bus_log_option
@hands_option
@operator_option
@risk_option
@json_option
def resume(
    run: str, yes: bool, reason: str, speed: float | None, bus_log: Path | None, hands: str, operator: str,
    accept_risk: str, as_json: bool,
) -> int:  # fmt: skip
    """Resume RUN (its folder, its name under runs, or latest) at the first repeat that is not committed.

    The wheel is heated again first. Prints the run's folder as the last line; a run that is complete stays as it is.
    """
    from tester.cli.console import Console
    from tester.run.session import Session
    from tester.run.session_options import SessionOptions

    folder = run_folder(run)
    options = SessionOptions(accept_risk=accept_risk, lapse=speed, bus_log=bus_log, operator=operator, hands=hands)
    session = Session(options, Console(as_json=as_json, answer_yes=yes))
    return _carried_out(lambda: session.resume(folder, reason))
