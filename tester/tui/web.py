"""`tester tui --web`: the screen in a browser, on this machine only, view only.

Every user of this machine can reach the port, so no command works there, not even STOP (docs/decisions/0023). A page of
another origin is refused because of the ``Host`` and ``Origin`` headers that its browser sends, even if its name
resolves to this machine (DNS rebinding).
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
"""Names of this machine that a browser may use."""
HTTP_PORT = 80
"""Port that browsers leave out of the header."""


def is_own(host: str, origin: str | None, port: int) -> bool:
    """Return whether a request addresses this service by name, and comes from its own page or from no page.

    Arguments as in the headers.
    """
    places = {f"{name}:{port}" for name in NAMES} | (set(NAMES) if port == HTTP_PORT else set[str]())
    return host.lower() in places and (origin is None or origin.lower() in {f"http://{place}" for place in places})


async def application(port: int, address: str) -> web.Application:
    """Return the application for browsers: textual-serve, limited to requests that satisfy ``is_own``.

    ``address`` as in ``serve``. Raises ImportError without textual-serve.
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
        """A server that answers only requests addressed to itself."""

        async def answering(self) -> web.Application:
            app = await self._make_app()
            app.middlewares.append(own_only)
            return app

    return await OwnServer(shlex.join(command), host=HOST, port=port, title="friction-tester").answering()


def serve(port: int, address: str) -> None:
    """Serve view-only screens until interrupted, one process for each browser. Raises ImportError without
    textual-serve.

    ``address``: of the service, as `--connect` accepts it; "" = the user's own.
    """
    from aiohttp import web

    web.run_app(application(port, address), host=HOST, port=port, print=None, access_log=None)
