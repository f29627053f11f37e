"""The gateway's process, `python -m tester.service.gateway_process LINK`. The first line from the link holds its
settings.
"""

from __future__ import annotations

import asyncio
import socket
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from pydantic import TypeAdapter

from tester.base import clock
from tester.notices.causes import died
from tester.notices.notice import NOTE, SenderSettings
from tester.service.address import TcpAddress, UnixAddress, write_card
from tester.service.child_process import link_to_owner
from tester.service.gateway import Gateway
from tester.service.listening import CLOSE_S, listening
from tester.service.manners import sparse_logger
from tester.service.notice_forwarder import NoticeForwarder
from tester.service.queries import Queries
from tester.service.service_link import MOST_QUEUED

NICE = 5
"""Priority below that of the ticking process and of STOP's door, because many clients may keep the gateway busy."""


@dataclass(frozen=True, slots=True)
class GatewaySettings:
    """The owner's settings for its gateway. ``path``: a Unix socket or, if there is a ``token``, the card of a TCP
    service.
    """

    service: str
    software: str
    path: str
    runs: str
    rig: str
    notify: str
    token: str = ""
    port: int = 0
    stop_port: int = 0
    accept_risk: str = ""


SETTINGS: TypeAdapter[GatewaySettings] = TypeAdapter(GatewaySettings)


async def _serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter, settings: GatewaySettings) -> None:
    queries = Queries(Path(settings.runs), settings.rig, settings.accept_risk)

    def tell(line: bytes) -> None:
        if not writer.is_closing():
            writer.write(line + b"\n")

    sender = SenderSettings(settings.service, settings.runs, settings.rig, settings.notify)
    notices = NoticeForwarder(sender)
    notices.open()
    gateway = Gateway(tell, settings.service, settings.software, queries, notices.take)
    path = Path(settings.path)
    tcp = TcpAddress("127.0.0.1", settings.port, settings.token, settings.stop_port)
    address = tcp if settings.token else UnixAddress(path)
    async with listening(gateway, address) as listens:
        if isinstance(listens, TcpAddress):
            write_card(listens, path)
        results = asyncio.create_task(gateway.results.work())
        with suppress(ConnectionError):  # an owner that dies with unread input resets the connection
            while line := await reader.readline():
                gateway.take(line[:-1])
        gateway.farewell()
        results.cancel()
        if not gateway.ended:
            last = died(f"{settings.service}-died", clock.utc_now(), settings.rig)
            notices.take(NOTE.dump_json(last))
        await asyncio.to_thread(notices.close)
        with suppress(TimeoutError):
            async with asyncio.timeout(CLOSE_S):
                await gateway.guests.sent()


async def serve_link(link: socket.socket) -> None:
    """Serve clients for the owner at the other end of ``link``, until the owner ends."""
    reader, writer = await asyncio.open_connection(sock=link, limit=2 * MOST_QUEUED)
    settings = SETTINGS.validate_json(await reader.readline())
    with suppress(ConnectionError):
        await _serve(reader, writer, settings)
    writer.close()


if __name__ == "__main__":
    sparse_logger("asyncio")
    asyncio.run(serve_link(link_to_owner(NICE)))
