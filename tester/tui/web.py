"""`tester tui --web`: the screen in a browser, on this machine only, to look at.

Who can reach the port can see it: any user of this machine. So nothing is commanded from there, not even STOP
(docs/decisions/0023). A page of another origin cannot: it is refused by the ``Host`` and ``Origin`` that a browser
sends, also where its name was made to mean this machine (DNS rebinding).
"""

from __future__ import annotations

import shlex
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING

from tester.base.processes import tester_command

if TYPE_CHECKING:
    from aiohttp import web

HOST = "127.0.0.1"
NAMES = (HOST, "localhost")
"""What a browser may call this machine."""
HTTP_PORT = 80
"""A browser leaves this one out."""


def is_own(host: str, origin: str | None, port: int) -> bool:
    """Return whether a request is for us by name, and from a page of ours or from no page. Both as the headers say."""
    places = {f"{name}:{port}" for name in NAMES} | (set(NAMES) if port == HTTP_PORT else set[str]())
    return host.lower() in places and (origin is None or origin.lower() in {f"http://{place}" for place in places})


async def application(port: int, address: str) -> web.Application:
    """Return what answers browsers: textual-serve, for requests that ``is_own``. Raises ImportError without it.

    ``address`` as of ``serve``.
    """
    from aiohttp import web
    from textual_serve.server import Server

    command = tester_command("tui", "--view")
    if address:
        command += ["--connect", address]

    @web.middleware
    async def own_only(
        request: web.Request, handler: Callable[[web.Request], Awaitable[web.StreamResponse]]
    ) -> web.StreamResponse:
        if not is_own(request.headers.get("Host", ""), request.headers.get("Origin"), port):
            raise web.HTTPForbidden(text=f"expected http://{HOST}:{port}\n")
        return await handler(request)

    class OwnServer(Server):
        """Answers nobody else."""

        async def answering(self) -> web.Application:
            made = await self._make_app()
            made.middlewares.append(own_only)
            return made

    return await OwnServer(shlex.join(command), host=HOST, port=port, title="friction-tester").answering()


def serve(port: int, address: str) -> None:
    """Serve view-only screens until interrupted, a process for each browser. Raises ImportError without textual-serve.

    ``address``: of the service as `--connect` takes it, "" = the user's own.
    """
    from aiohttp import web

    web.run_app(application(port, address), host=HOST, port=port, print=None, access_log=None)
