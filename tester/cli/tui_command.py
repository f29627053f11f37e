"""``tester tui``: the operator's screen."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import click

from tester.cli.options import rig_option, run_folder
from tester.cli.service_commands import connect_option

MAX = "max"
SWITCH_S = 0.001
"""How long drawing may keep the interpreter from the thread that sends STOP, s (Python: 5 ms)."""


class SpeedType(click.ParamType[float | None]):
    """Rig seconds per second: a number above 0, or max."""

    name = "speed"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float | None:
        """Return the number, None for max."""
        text = str(value)
        if text == MAX:
            return None
        try:
            speed = float(text)
        except ValueError:
            speed = 0.0
        if not 0.0 < speed <= 1e6:
            self.fail(f'expected "max" or a number above 0 (rig seconds per second), got "{text}"', param, ctx)
        return speed


@click.command()
@connect_option
@rig_option
@click.option("--speed", type=SpeedType(), default="1", show_default=True, metavar="X",
              help="Rig seconds per second of simulated runs that are started here, or max.")  # fmt: skip
@click.option("--out", default="runs", show_default=True, metavar="DIR", help="Folder of the runs.")
@click.option("--theme", type=click.Choice(["dark", "light", "16"]), default=None, help="Colours.")
@click.option("--ascii", "plain", is_flag=True, help="Draw with ASCII characters only.")
@click.option("--view", "view_only", is_flag=True, help="Watch only: command nothing, start no service.")
@click.option("--web", is_flag=True, help="Serve a view-only screen to browsers of this machine (extra: web).")
@click.option("--port", type=click.IntRange(1, 65535), default=8000, show_default=True, help="Of --web.")
def tui(
    address: str,
    rig_name: str,
    speed: float | None,
    out: str,
    theme: str | None,
    plain: bool,
    view_only: bool,
    web: bool,
    port: int,
) -> int:
    """Show the rig, choose recipes, run them, see results. Starts the service if none runs.

    F12 or Ctrl+X is STOP on every screen. Leaving with q touches no run.
    """
    if web:
        return _serve(port, address)
    need_terminal("tester tui", "`tester status`, `tester run` and `tester stop` need none")
    from tester.service.address import AddressError, address_of
    from tester.tui.app import TesterApp
    from tester.tui.host import TuiOptions

    try:
        where = address_of(address) if address else None
    except AddressError as error:
        raise click.UsageError(str(error)) from error
    app = TesterApp(
        TuiOptions(
            rig=rig_name, speed=speed, runs=Path(out), address=where, plain=plain, view_only=view_only,
            theme=theme or "",
        )
    )  # fmt: skip
    sys.setswitchinterval(SWITCH_S)
    farewell = app.run()
    if farewell:
        click.echo(farewell, err=True)
    return app.return_code or 0


def need_terminal(command: str, instead: str) -> None:
    """Raise UsageError where there is no terminal to draw on and to read keys from; a browser's is none of ours."""
    if "TEXTUAL_DRIVER" in os.environ:
        return
    if not all(stream is not None and stream.isatty() for stream in (sys.__stdin__, sys.__stderr__)):
        raise click.UsageError(f"{command} needs a terminal, and there is none here; {instead}")
    if os.environ.get("TERM") == "dumb":
        raise click.UsageError(f"{command} needs a terminal that can place text, and TERM is dumb; {instead}")


def _serve(port: int, address: str) -> int:
    from tester.base.plugins import needs
    from tester.tui.web import serve

    try:
        serve(port, address)
    except ImportError:
        raise click.UsageError(needs("--web", "textual-serve", "web")) from None
    return 0


@click.command()
@click.argument("run")
@click.option("--theme", type=click.Choice(["dark", "light", "16"]), default=None, help="Colours.")
@click.option("--ascii", "plain", is_flag=True, help="Draw with ASCII characters only.")
def replay(run: str, theme: str | None, plain: bool) -> int:
    """Show RUN (a folder, a name under runs, or latest) as it went; space plays, arrows seek. No rig is needed."""
    from tester.store.record_schema import StoreError
    from tester.tui.playback import load
    from tester.tui.replay import ReplayApp
    from tester.tui.stored import read

    folder = run_folder(run)
    need_terminal("tester replay", "`tester show` needs none")
    try:
        playback, stored = load(folder), read(str(folder), folder.parent)
    except StoreError as error:
        raise click.ClickException(str(error)) from error
    app = ReplayApp(playback, stored, plain=plain, theme=theme or "")
    app.run()
    return app.return_code or 0
