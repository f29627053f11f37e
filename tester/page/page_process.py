"""The page's process: it listens, keeps the link to the service, shows codes on its terminal, and ends with Ctrl+C."""

from __future__ import annotations

import asyncio
import ipaddress
import signal
import ssl
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from websockets.asyncio.server import serve

from tester.base.trouble import MisuseError, in_words
from tester.page.answers import Tickets, static_files
from tester.page.desk import PageDesk
from tester.page.desk_call import NewCode
from tester.page.front import LONGEST
from tester.page.hub import Hub
from tester.page.origins import HOST, NAMES, origins_for
from tester.page.pairing import Pairings
from tester.page.questions import Questions
from tester.page.reception import Reception
from tester.page.roles import Role, up_to
from tester.page.terminal import PageTerminal
from tester.service.address import Address
from tester.service.manners import counted, sparse_logger

BACKLOG_BYTES = 65_536
"""Bytes that a page may leave unread before its next message waits."""
CLOSE_S = 2.0
TIDY_S = 0.5
"""Period at which pairings and tickets are looked through, s."""
SWITCH_S = 0.001
"""How long other work in this process may keep the interpreter from STOP's thread, s (Python: 5 ms)."""
LOG = "tester.page"


@dataclass(frozen=True, slots=True)
class PageOptions:
    """Options of `tester page`. ``lan``: a further address to listen at, "" for none; ``role``: of the first code;
    ``warm``: whether the process that reads stored runs starts before the first question.
    """

    port: int = 8010
    lan: str = ""
    certificate: Path | None = None
    key: Path | None = None
    role: Role = "look"
    origins: tuple[str, ...] = ()
    runs: Path = Path("runs")
    address: Address | None = None
    warm: bool = True

    @property
    def greatest(self) -> Role:
        """Return the strongest role that may be given. In the clear everybody on the wire can read a secret and use
        it.
        """
        return "stop" if self.lan and self.certificate is None else "control"


def check_options(options: PageOptions) -> None:
    """Raise MisuseError for options that do not go together."""
    if (options.certificate is None) != (options.key is None):
        raise MisuseError("--certificate and --key go together: the certificate's file and its private key")
    if options.certificate is not None and not options.lan:
        raise MisuseError("--certificate is for --lan: on this machine alone nothing crosses a wire")
    if options.lan:
        try:
            ipaddress.ip_address(options.lan)
        except ValueError:
            raise MisuseError(f"--lan {options.lan}: expected this machine's address, e.g. 192.168.1.20") from None
    if options.role not in up_to(options.greatest):
        raise MisuseError(
            f"--role {options.role} over --lan needs --certificate and --key: without them everybody on the wire can "
            f"read along, and the roles are {' and '.join(up_to(options.greatest))}"
        )


def tls_of(options: PageOptions) -> ssl.SSLContext | None:
    """Return the settings for TLS, None without a certificate. Raises MisuseError."""
    if options.certificate is None:
        return None
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    try:
        context.load_cert_chain(options.certificate, options.key)
    except (OSError, ssl.SSLError) as error:
        raise MisuseError(f"--certificate {options.certificate}: {in_words(error)}") from error
    return context


async def host_page(options: PageOptions, write: Callable[[str], object], began: asyncio.Event | None = None) -> None:
    """Serve the page until the task is cancelled. Raises MisuseError, OSError.

    ``write`` prints a line on this process's terminal; ``began`` is set once pages may come.
    """
    check_options(options)
    tls = tls_of(options)
    addresses = [HOST, options.lan] if options.lan else [HOST]
    scheme = "https" if tls is not None else "http"
    origins = origins_for(scheme, [*NAMES, *addresses[1:]], options.port, options.origins)
    pairings = Pairings(options.greatest)
    hub, tickets = Hub(options.address), Tickets()
    async with Questions(options.runs, pairings, tickets) as questions:
        hub.run_ended = questions.prepare
        if options.warm:
            questions.warm()
        reception = Reception(pairings, hub, origins, static_files(), tickets, questions.answer, options.runs)
        desk = PageDesk(reception, f"{scheme}://{addresses[-1]}:{options.port}/")
        terminal = PageTerminal(desk, write)
        reception.changed = terminal.show
        # asyncio listens at several addresses; the library's type names one
        async with (
            desk.open(options.address),
            serve(
                reception.serve, cast("str", addresses), options.port, ssl=tls,
                process_request=reception.admit, compression=None, max_size=LONGEST,
                write_limit=BACKLOG_BYTES, close_timeout=CLOSE_S, server_header=None,
                create_connection=counted(reception.strangers), logger=sparse_logger(LOG),
            ),
        ):  # fmt: skip
            terminal.open()
            desk.carry_out(NewCode(options.role))
            if began is not None:
                began.set()
            async with asyncio.TaskGroup() as group:
                group.create_task(hub.relay())
                group.create_task(_tidy(reception, terminal))


async def _tidy(reception: Reception, terminal: PageTerminal) -> None:
    while True:
        await asyncio.sleep(TIDY_S)
        reception.tidy()
        terminal.show()


def serve_page(options: PageOptions, write: Callable[[str], object]) -> None:
    """Serve the page until Ctrl+C or TERM. Lines typed here make codes: Enter, or the name of a role."""
    sys.setswitchinterval(SWITCH_S)

    async def until_ended() -> None:
        loop = asyncio.get_running_loop()
        task = asyncio.current_task()
        assert task is not None
        with suppress(NotImplementedError):  # Windows: Ctrl+C raises KeyboardInterrupt instead
            for number in (signal.SIGINT, signal.SIGTERM):
                loop.add_signal_handler(number, task.cancel)
        with suppress(asyncio.CancelledError):
            await host_page(options, write)

    with suppress(KeyboardInterrupt):
        asyncio.run(until_ended())
