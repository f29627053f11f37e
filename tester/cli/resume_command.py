"""`tester resume`: go on with an interrupted run."""

from __future__ import annotations

import click

from tester.cli.options import json_option, risk_option


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
    """Go on with RUN (its folder, its name under runs, or latest) at the first repeat that is not committed.

    The wheel is heated again first. Prints the run's folder as the last line; a run that is complete stays as it is.
    """
    from pathlib import Path

    from tester.cli.console import Console
    from tester.cli.run_command import carried_out, time_lapse
    from tester.cli.run_lookup import run_folder
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
