"""`tester run`: a recipe on a rig, in the foreground."""

from __future__ import annotations

from collections.abc import Callable

import click
from click.core import ParameterSource

from tester.cli.options import json_option, rig_option, risk_option, seed_option, set_option
from tester.cli.recipe_commands import recipe_file

NOT_DETACHED = {
    "out": "--out", "bus_log": "--bus-log", "faults": "--fault", "jobs": "--jobs", "as_json": "--json",
    "accept_risk": "--accept-risk",
}  # fmt: skip
"""What the service has no command for, or chooses itself."""


@click.command("run")
@click.argument("recipe")
@rig_option
@set_option
@risk_option
@click.option("--out", default="runs", show_default=True, metavar="DIR", help="Folder that gets the run's folder.")
@click.option("--yes", is_flag=True, help="Answer prompts with yes, but those that ask a person to a real rig.")
@seed_option
@click.option("--speed", default=None, metavar="max|X", help="Simulated rig: as fast as it goes, or X times real time.")
@click.option(
    "--jobs",
    default=1,
    show_default=True,
    metavar="N",
    type=click.IntRange(1, 256),
    help="Simulated rig: processes in which specimens run side by side; the results are the same.",
)
@click.option("--bus-log", default=None, metavar="DIR", help="Write every CAN and Modbus frame into this folder.")
@click.option(
    "--fault",
    "faults",
    multiple=True,
    metavar="TEXT",
    help='Simulated rig: let something fail, e.g. "t=130 s: belt drive heartbeat lost for 3 s". May be given again.',
)
@click.option("--operator", default="", metavar="NAME", help="Who runs the test; stored with the run.")
@click.option("--detach", is_flag=True, help="Have the service run it (`tester serve`), and return.")
@click.option("--take", is_flag=True, help="With --detach: take control from the client that has it.")
@json_option
@click.pass_context
def run(
    context: click.Context,
    recipe: str,
    rig_name: str,
    overrides: tuple[str, ...],
    accept_risk: str,
    out: str,
    yes: bool,
    seed: int,
    speed: str | None,
    jobs: int,
    bus_log: str | None,
    faults: tuple[str, ...],
    operator: str,
    detach: bool,
    take: bool,
    as_json: bool,
) -> int:
    """Run RECIPE (a file, or the name of a shipped recipe) and print the run's folder as the last line.

    What was measured comes before it, with the expanded uncertainty (95 %), on stderr; stdout is the folder alone.

    Ctrl+C stops in a controlled way; a second one stops fast. On a terminal: F12 or Ctrl+X stops in a controlled
    way, F9 or Ctrl+F fast, space holds (lifts, keeps the heat), r goes on.
    """
    if detach:
        given = {name for name in context.params if context.get_parameter_source(name) is ParameterSource.COMMANDLINE}
        if accept_risk:
            raise click.UsageError("--accept-risk goes with `tester serve`, which owns the rig: not with --detach")
        if kept := [option for name, option in NOT_DETACHED.items() if name in given]:
            raise click.UsageError(f"not with --detach, the service would not do it: {', '.join(kept)}")
        rig = rig_name if "rig_name" in given else ""
        return _detached(recipe, rig, overrides, seed, time_lapse(speed), yes, operator, take)
    if take:
        raise click.UsageError("--take: a run in the foreground needs nobody's control; it goes with --detach")

    recipe_file(recipe)
    if not as_json:
        # What the run needs takes a moment to load: say what has been begun before that.
        click.echo(f"{recipe} on rig {rig_name}", err=True)

    from pathlib import Path

    from tester.cli.console import Console
    from tester.run.session import Session, SessionOptions

    options = SessionOptions(
        recipe=recipe,
        rig=rig_name,
        overrides=overrides,
        accept_risk=accept_risk,
        out=Path(out),
        seed=seed,
        lapse=time_lapse(speed),
        bus_log=Path(bus_log) if bus_log else None,
        operator=operator,
        faults=faults,
        jobs=jobs,
    )
    session = Session(options, Console(as_json=as_json, answer_yes=yes))
    return carried_out(session.run)


def _detached(
    recipe: str,
    rig: str,
    overrides: tuple[str, ...],
    seed: int,
    lapse: float | None,
    yes: bool,
    operator: str,
    take: bool,
) -> int:
    """Have the service run a recipe; its files are named so that the service finds them from its own folder."""
    from pathlib import Path

    from tester.cli.service_commands import run_detached
    from tester.service.commands import RunRecipe

    def found(name: str) -> str:
        return str(Path(name).resolve()) if Path(name).is_file() else name

    action = RunRecipe(
        found(recipe), rig=found(rig), overrides=overrides, seed=seed, speed=lapse, yes=yes, operator=operator
    )
    return run_detached("", action, take)


def carried_out(work: Callable[[], int]) -> int:
    """Do the work and return its exit code; what keeps it from beginning goes to stderr. Raises OSError."""
    from recipes import UnknownRecipe
    from tester.run.session import CannotStartError
    from tester.store.record_schema import StoreError

    try:
        return work()
    except CannotStartError as error:
        click.echo(str(error), err=True)
        return error.code
    except UnknownRecipe as error:
        raise click.UsageError(str(error)) from error
    except StoreError as error:
        raise click.ClickException(str(error)) from error


def time_lapse(speed: str | None) -> float | None:
    """Return the time lapse, None = as fast as it goes; a text that is none is a usage error."""
    if speed in (None, "max"):
        return None
    assert speed is not None
    try:
        lapse = float(speed)
    except ValueError:
        lapse = float("nan")
    if not 0.0 < lapse < 1e6:
        raise click.UsageError(f"--speed: expected max or a number above 0, not {speed!r}")
    return lapse


@click.command("resume")
@click.argument("run")
@click.option("--yes", is_flag=True, help="Answer prompts with yes, but those that ask a person to a real rig.")
@click.option(
    "--reason", default="", metavar="TEXT", help="Go on although recipe, rig or calibration changed; stored with it."
)
@click.option("--speed", default=None, metavar="max|X", help="Simulated rig: as fast as it goes, or X times real time.")
@click.option("--bus-log", default=None, metavar="DIR", help="Write every CAN and Modbus frame into this folder.")
@click.option("--operator", default="", metavar="NAME", help="Who runs the test; stored with the run.")
@risk_option
@json_option
def resume(
    run: str,
    yes: bool,
    reason: str,
    speed: str | None,
    bus_log: str | None,
    operator: str,
    accept_risk: str,
    as_json: bool,
) -> int:
    """Resume RUN (its folder, its name under runs, or latest) at the first repeat that is not committed.

    The wheel is heated again first. Prints the run's folder as the last line; a run that is complete stays as it is.
    """
    from pathlib import Path

    from tester.cli.console import Console
    from tester.cli.options import run_folder
    from tester.run.session import Session, SessionOptions

    options = SessionOptions(
        accept_risk=accept_risk,
        lapse=time_lapse(speed),
        bus_log=Path(bus_log) if bus_log else None,
        operator=operator,
    )
    folder = run_folder(run)
    session = Session(options, Console(as_json=as_json, answer_yes=yes))
    return carried_out(lambda: session.resume(folder, reason))
