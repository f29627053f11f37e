"""`tester run`: a recipe on a rig, in the foreground."""

from __future__ import annotations

import click

from tester.cli.options import json_option, rig_option, set_option


@click.command("run", short_help="Run a recipe on a rig, simulated unless told.")
@click.argument("recipe")
@rig_option
@set_option
@click.option("--out", default="runs", show_default=True, metavar="DIR", help="Folder that gets the run's folder.")
@click.option("--yes", is_flag=True, help="Answer every prompt with yes.")
@click.option(
    "--seed",
    default=0,
    show_default=True,
    metavar="N",
    type=click.IntRange(0, 2**63 - 1),
    help="Seed of the simulated rig.",
)
@click.option("--speed", default=None, metavar="max|X", help="Simulated rig: as fast as it goes, or X times real time.")
@click.option("--bus-log", default=None, metavar="DIR", help="Write every CAN and Modbus frame into this folder.")
@click.option(
    "--fault",
    "faults",
    multiple=True,
    metavar="TEXT",
    help='Simulated rig: let something fail, e.g. "t=130 s: belt drive heartbeat lost for 3 s". May be given again.',
)
@click.option("--operator", default="", metavar="NAME", help="Who runs the test; stored with the run.")
@json_option
def run(
    recipe: str,
    rig_name: str,
    overrides: tuple[str, ...],
    out: str,
    yes: bool,
    seed: int,
    speed: str | None,
    bus_log: str | None,
    faults: tuple[str, ...],
    operator: str,
    as_json: bool,
) -> int:
    """Run RECIPE (a file, or the name of a shipped recipe) and print the run's folder as the last line.

    Ctrl+C stops in a controlled way; a second one stops fast.
    """
    from pathlib import Path

    from tester.cli.console import Console
    from tester.session import CannotStartError, Session, SessionOptions

    lapse, refused = _lapse(speed)
    if refused:
        raise click.UsageError(refused)
    options = SessionOptions(
        recipe=recipe,
        rig=rig_name,
        overrides=overrides,
        out=Path(out),
        seed=seed,
        lapse=lapse,
        bus_log=Path(bus_log) if bus_log else None,
        operator=operator,
        faults=faults,
    )
    console = Console(as_json=as_json, answer_yes=yes)
    try:
        return Session(options, console).run()
    except (FileNotFoundError, CannotStartError) as error:
        raise click.UsageError(str(error)) from error


def _lapse(speed: str | None) -> tuple[float | None, str]:
    """Return the time lapse (None = as fast as it goes) and why a text is none."""
    if speed in (None, "max"):
        return None, ""
    assert speed is not None
    try:
        lapse = float(speed)
    except ValueError:
        lapse = float("nan")
    if not 0.0 < lapse < 1e6:
        return None, f"--speed: expected max or a number above 0, not {speed!r}"
    return lapse, ""
