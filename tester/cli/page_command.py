"""``tester page``: the page in a browser."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, cast

import click

from tester.base.processes import EXIT_DONE
from tester.cli.options import address_named, command, connect_option, runs_option

if TYPE_CHECKING:
    from tester.page.roles import Role

FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


@command()
@connect_option
@runs_option("Folder of the stored runs.")
@click.option("--port", type=click.IntRange(1, 65535), default=8010, show_default=True, help="Port of the page.")
@click.option("--role", type=click.Choice(["look", "stop", "control"]), default="look", show_default=True,
              help="What the first code pairs for; the terminal and F2 make codes for others.")  # fmt: skip
@click.option("--lan", default="", metavar="ADDRESS",
              help="Listen at this address too; without a certificate for look and stop only.")  # fmt: skip
@click.option("--certificate", type=FILE, default=None, metavar="FILE", help="Certificate (PEM), for --lan.")
@click.option("--key", type=FILE, default=None, metavar="FILE", help="The certificate's private key (PEM).")
@click.option("--origin", "origins", multiple=True, metavar="URL",
              help="Name of a forwarded port, as the browser shows it. May be given again.")  # fmt: skip
def page(
    address: str, out: Path, port: int, role: str, lan: str, certificate: Path | None, key: Path | None,
    origins: tuple[str, ...],
) -> int:  # fmt: skip
    """Serve the page for browsers: see the rig, STOP, stored runs; control with a code from this screen.

    A browser is paired by a code shown here and on F2 of `tester tui`. Ending the page touches no run.
    """
    from tester.page.page_process import PageOptions, serve_page

    serve_page(
        PageOptions(port, lan, certificate, key, cast("Role", role), origins, out, address_named(address)), click.echo
    )
    return EXIT_DONE
