"""``tester replay``: the screens over a stored run."""

from __future__ import annotations

import click

from tester.cli.run_lookup import run_folder
from tester.cli.tui_command import need_terminal


@click.command()
@click.argument("run")
@click.option("--theme", type=click.Choice(["dark", "light", "16"]), default=None, help="Colours.")
@click.option("--ascii", "plain", is_flag=True, help="Draw with ASCII characters only.")
def replay(run: str, theme: str | None, plain: bool) -> int:
    """Show RUN (a folder, a name under runs, or latest) as it went; space plays, arrows seek. No rig is needed."""
    from tester.store.schema import StoreError
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
