"""`tester tui --web`: the screen in a browser, on this machine only, to look at.

Who can reach the port can see it: any user of this machine, and any page in its browser. So nothing is commanded from
there, not even STOP (docs/decisions/0023).
"""

from __future__ import annotations

import shlex

from tester.children import tester_command

HOST = "127.0.0.1"


def serve(port: int, address: str) -> None:
    """Serve view-only screens until interrupted, a process for each browser. Raises ImportError without textual-serve.

    ``address``: of the service as `--connect` takes it, "" = the user's own.
    """
    from textual_serve.server import Server

    command = tester_command("tui", "--view")
    if address:
        command += ["--connect", address]
    Server(shlex.join(command), host=HOST, port=port, title="friction-tester").serve()
