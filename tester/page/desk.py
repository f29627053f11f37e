"""The page process's end for the machine's screen (tester.page.desk_call)."""

from __future__ import annotations

import asyncio
import hmac
import os
import socket
from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager, suppress
from typing import cast

from pydantic import ValidationError

from tester.base.trouble import MisuseError
from tester.page.desk_call import (
    CARD,
    REQUEST,
    VIEW,
    DeskRequest,
    DeskView,
    NewCode,
    NoPageError,
    Revoke,
    ShowDesk,
    ShownCode,
    ShownPairing,
    call_desk,
    desk_address,
)
from tester.page.pairing import Code
from tester.page.reception import Reception
from tester.page.roles import up_to
from tester.service.address import Address, TcpAddress, folder, new_tcp_address, peer_of, unlink_socket, write_card

FIRST_WITHIN_S = 5.0
"""Time for a caller to send its request, s."""


class PageDesk:
    """Answers the machine's screen."""

    def __init__(self, reception: Reception, address: str) -> None:
        """``address``: of the page, for people."""
        self._reception = reception
        self._address = address

    def view(self) -> DeskView:
        """Return the present state."""
        pairings = self._reception.pairings
        code = pairings.code()
        return DeskView(
            self._address,
            up_to(pairings.greatest),
            self._shown(code, "") if code is not None else None,
            tuple(self._shown(code, pairing.recorded) for pairing, code in pairings.asked()),
            tuple(
                ShownPairing(
                    pairing.number, pairing.name, pairing.role, pairing.expires_utc,
                    sum(1 for _ in self._reception.hub.of_pairing(pairing.number)),
                )
                for pairing in pairings.listed()
            ),
        )  # fmt: skip

    def _shown(self, code: Code, page: str) -> ShownCode:
        return ShownCode(code.digits, page, code.what, round(self._reception.pairings.left_s(code), 1))

    def carry_out(self, request: DeskRequest) -> DeskView:
        """Carry out a request of the machine's screen, and return the state after it."""
        pairings = self._reception.pairings
        if isinstance(request, NewCode) and request.role in up_to(pairings.greatest):
            pairings.new_code(request.role)
        elif isinstance(request, Revoke):
            for pairing in pairings.listed():
                if request.number in (0, pairing.number):
                    pairings.revoke(pairing.number)
            self._reception.tidy()
        if not isinstance(request, ShowDesk):
            self._reception.changed()
        return self.view()

    # -- callers ----------------------------------------------------------------------------------------------

    @asynccontextmanager
    async def open(self, service: Address | None) -> AsyncGenerator[None]:
        """Answer callers until the block ends. Raises MisuseError if another page process serves this service."""
        try:
            other = await asyncio.to_thread(call_desk, service, ShowDesk())
        except NoPageError:
            pass
        else:
            raise MisuseError(f"a page for this service is open already, at {other.address}")
        address = desk_address(service)
        if address is None:
            card = new_tcp_address()
            server = await asyncio.start_server(self._handler(card.token), card.host, 0)
            port = int(server.sockets[0].getsockname()[1])
            file = folder() / CARD
            write_card(TcpAddress(card.host, port, card.token), file)
        else:
            file = address.path
            unlink_socket(file)
            before = os.umask(0o177)
            try:
                server = await asyncio.start_unix_server(self._handler(""), str(file))
            finally:
                os.umask(before)
        try:
            async with server:
                yield
        finally:
            file.unlink(missing_ok=True)

    def _handler(self, token: str):
        async def handle(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            with suppress(OSError, TimeoutError, ValidationError, ValueError):
                async with asyncio.timeout(FIRST_WITHIN_S):
                    if _admitted(writer, token, await reader.readline() if token else b""):
                        answer = self.carry_out(REQUEST.validate_json(await reader.readline()))
                        writer.write(VIEW.dump_json(answer) + b"\n")
                        await writer.drain()
            writer.close()

        return handle


def _admitted(writer: asyncio.StreamWriter, token: str, shown: bytes) -> bool:
    """Return whether a caller is this user: by the token, or by the system's word for it."""
    if token:
        return hmac.compare_digest(shown.strip(), token.encode())
    raw = cast("socket.socket | None", writer.get_extra_info("socket"))
    uid = peer_of(raw)[1] if raw is not None else None
    return uid is None or uid == os.getuid()
