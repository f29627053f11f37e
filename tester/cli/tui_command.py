"""``tester tui``: the operator's screen."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import click

from tester.cli.options import (
    SpeedType,
    address_named,
    ascii_option,
    command,
    connect_option,
    rig_option,
    runs_option,
    theme_option,
)
from tester.cli.stored_runs import run_folder

SWITCH_S = 0.001
"""How long drawing may keep the interpreter from the thread that sends STOP, s (Python: 5 ms)."""


@command()
@connect_option
@rig_option
@click.option("--speed", type=SpeedType(), default="1", show_default=True, metavar="X",
              help="Rig seconds per second of simulated runs that are started here, or max.")  # fmt: skip
@runs_option("Folder of the runs.")
@theme_option
@ascii_option
@click.option("--view", "view_only", is_flag=True, help="Watch only: command nothing, start no service.")
def tui(
    address: str, rig_name: str, speed: float | None, out: Path, theme: str | None, plain: bool, view_only: bool
) -> int:  # fmt: skip
    """Show the rig, choose recipes, run them, see results. Starts the service if none runs.

    F12 or Ctrl+X is STOP on every screen. Leaving with q touches no run.
    """
    need_terminal("tester tui", "`tester status`, `tester run` and `tester stop` need none")
    from tester.tui.app import TesterApp
    from tester.tui.host import TuiOptions

    app = TesterApp(
        TuiOptions(rig_name, speed, out, address_named(address), plain=plain, view_only=view_only, theme=theme or "")
    )
    sys.setswitchinterval(SWITCH_S)
    farewell = app.run()
    if farewell:
        click.echo(farewell, err=True)
    return app.return_code or 0


def need_terminal(command: str, instead: str) -> None:
    """Raise UsageError where there is no terminal to draw on and to read keys from."""
    if not all(stream is not None and stream.isatty() for stream in (sys.__stdin__, sys.__stderr__)):
        raise click.UsageError(f"{command} needs a terminal, and there is none here; {instead}")
    if os.environ.get("TERM") == "dumb":
        raise click.UsageError(f"{command} needs a terminal that can place text, and TERM is dumb; {instead}")


@command()
@click.argument("run")
@theme_option
@ascii_option
def replay(run: str, theme: str | None, plain: bool) -> int:
    """Show RUN (a folder, a name under runs, or latest) as it went; space plays, arrows seek. No rig is needed."""
    from tester.tui.playback import load
    from tester.tui.replay import ReplayApp
    from tester.tui.stored import read

    folder = run_folder(run)
    need_terminal("tester replay", "`tester show` needs none")
    app = ReplayApp(load(folder), read(str(folder), folder.parent), plain=plain, theme=theme or "")
    app.run()
    return app.return_code or 0
