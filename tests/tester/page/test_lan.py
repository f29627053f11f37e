"""`tester page --lan` with a certificate of a real authority: only a client that trusts it works as at the machine."""

from __future__ import annotations

import asyncio
import os
import socket
import ssl
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest
from websockets.asyncio.client import connect

from tester.base.trouble import MisuseError
from tester.page.desk_call import NewCode
from tester.page.page_process import PageOptions, tls_of
from tester.service.commands import Hold
from tester.service.stop_lane import StopLane
from tests.tester.page.stage import Browser, PageStage

trustme = pytest.importorskip("trustme", reason="it makes the authority: pip install '.[browser]'")
pytestmark = pytest.mark.skipif(os.name != "posix", reason="the fake service listens at a Unix socket")

LAN = "127.0.0.2"
"""A second address of this machine, which Linux has without a network."""
ELSEWHERE = "127.0.0.3"
Story = Callable[[PageStage, "Authority"], Awaitable[None]]


def has_second_address() -> bool:
    try:
        socket.create_server((LAN, 0)).close()
    except OSError:
        return False
    return True


needs_second = pytest.mark.skipif(not has_second_address(), reason=f"this system has no address {LAN}")


class Authority:
    """A test's authority, and its certificate for an address on disk."""

    def __init__(self, folder: Path, address: str = LAN) -> None:
        self.ca = trustme.CA()
        issued = self.ca.issue_cert(address)
        self.certificate, self.key = folder / f"{address}.pem", folder / f"{address}.key"
        issued.private_key_pem.write_to_path(str(self.key))
        for at, blob in enumerate(issued.cert_chain_pems):
            blob.write_to_path(str(self.certificate), append=at > 0)

    def trusting(self) -> ssl.SSLContext:
        """Return the settings of a client that trusts this authority, and no other."""
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        self.ca.configure_trust(context)
        return context


def play(folder: Path, story: Story, address: str = LAN) -> None:
    authority = Authority(folder, address)

    async def run() -> None:
        options = {"lan": LAN, "certificate": authority.certificate, "key": authority.key}
        async with asyncio.timeout(120.0), PageStage(folder, **options) as stage:
            await story(stage, authority)

    asyncio.run(run())


async def opened(stage: PageStage, trust: ssl.SSLContext | None, address: str = LAN, **options: Any) -> Browser:
    scheme, plain = ("wss", "https") if trust is not None else ("ws", "http")
    options.setdefault("origin", f"{plain}://{address}:{stage.port}")
    url = f"{scheme}://{address}:{stage.port}/socket"
    return Browser(await connect(url, ssl=trust, max_size=None, compression=None, proxy=None, **options))


async def paired(stage: PageStage, page: Browser, role: Any) -> dict[str, Any]:
    code = (await stage.desk(NewCode(role))).code
    assert code is not None
    await page.send(type="pair", code=code.digits, name="phone")
    return await page.until("paired", "refused")


@needs_second
def test_a_browser_that_trusts_the_authority_pairs_and_controls(tmp_path: Path) -> None:
    async def story(stage: PageStage, authority: Authority) -> None:
        assert (await stage.desk()).address == f"https://{LAN}:{stage.port}/"
        page = await opened(stage, authority.trusting())
        assert (await paired(stage, page, "control"))["role"] == "control"
        assert (await page.command({"command": "hold"}))["type"] == "accepted"
        assert stage.fake.orders[-1].action == Hold()
        await page.connection.close()

    play(tmp_path, story)


@needs_second
def test_the_page_itself_comes_over_tls_with_its_policy(tmp_path: Path) -> None:
    async def story(stage: PageStage, authority: Authority) -> None:
        reader, writer = await asyncio.open_connection(LAN, stage.port, ssl=authority.trusting())
        tls = writer.get_extra_info("ssl_object")
        assert tls.version() in ("TLSv1.2", "TLSv1.3")
        writer.write(f"GET / HTTP/1.1\r\nHost: {LAN}:{stage.port}\r\n\r\n".encode())
        answer = await reader.read()
        assert answer.startswith(b"HTTP/1.1 200 ") and b"require-trusted-types-for 'script'" in answer
        writer.close()

    play(tmp_path, story)


@needs_second
def test_a_browser_that_does_not_trust_the_authority_sends_nothing(tmp_path: Path) -> None:
    async def story(stage: PageStage, _authority: Authority) -> None:
        other = Authority(tmp_path, ELSEWHERE)
        for trust in (other.trusting(), ssl.create_default_context()):
            with pytest.raises(ssl.SSLCertVerificationError, match=r"self-signed|unable to get"):
                await opened(stage, trust)

    play(tmp_path, story)


@needs_second
def test_a_certificate_for_another_address_is_refused_by_the_browser(tmp_path: Path) -> None:
    async def story(stage: PageStage, authority: Authority) -> None:
        with pytest.raises(ssl.SSLCertVerificationError, match="IP address mismatch"):
            await opened(stage, authority.trusting())

    play(tmp_path, story, ELSEWHERE)


@needs_second
def test_with_a_certificate_nothing_is_answered_in_the_clear(tmp_path: Path) -> None:
    async def story(stage: PageStage, _authority: Authority) -> None:
        for address in (LAN, "127.0.0.1"):
            with pytest.raises(Exception) as caught:  # however the handshake breaks
                await opened(stage, None, address)
            assert not isinstance(caught.value, AssertionError)
            reader, writer = await asyncio.open_connection(address, stage.port)
            writer.write(f"GET / HTTP/1.1\r\nHost: {address}:{stage.port}\r\n\r\n".encode())
            try:
                answer = await reader.read()
            except ConnectionError:
                answer = b""
            assert b"HTTP/1.1 200" not in answer
            writer.close()

    play(tmp_path, story)


@needs_second
def test_over_tls_another_origin_is_also_refused(tmp_path: Path) -> None:
    async def story(stage: PageStage, authority: Authority) -> None:
        for origin in (f"http://{LAN}:{stage.port}", "https://evil.example", None):
            with pytest.raises(Exception, match=r"403"):
                await opened(stage, authority.trusting(), origin=origin)

    play(tmp_path, story)


@needs_second
def test_without_a_certificate_a_page_on_the_network_looks_and_stops_and_no_more(tmp_path: Path) -> None:
    async def run() -> None:
        async with asyncio.timeout(120.0), PageStage(tmp_path, lan=LAN) as stage:
            before = (await stage.desk()).code
            refused = (await stage.desk(NewCode("control"))).code
            assert before is not None and refused == before  # no code is made for it
            page = await opened(stage, None)
            assert (await paired(stage, page, "stop"))["role"] == "stop"
            await page.service("hello")
            hold = await page.command({"command": "hold"})
            assert hold["type"] == "refused" and "needs the role control" in hold["reason"]
            lane = StopLane()
            lane.open(stage.fake.address)
            try:
                assert (await page.command({"command": "stop"}))["type"] == "accepted"
                assert lane.taken() and not stage.fake.orders
            finally:
                lane.close()
            await page.connection.close()

    asyncio.run(run())


def test_a_key_of_another_certificate_is_refused_at_start(tmp_path: Path) -> None:
    one, other = Authority(tmp_path), Authority(tmp_path, ELSEWHERE)
    with pytest.raises(MisuseError, match="--certificate"):
        tls_of(PageOptions(lan=LAN, certificate=one.certificate, key=other.key))
    with pytest.raises(MisuseError, match="--certificate"):
        tls_of(PageOptions(lan=LAN, certificate=tmp_path / "none.pem", key=one.key))
