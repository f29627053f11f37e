"""The owner's side with a real gateway process behind it, and the service as a process."""

from __future__ import annotations

import asyncio
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tester.notices.notice import NOTE, NextNeeded, NoticeOver
from tester.service import service_process
from tester.service.address import CARD, TcpAddress, UnixAddress, new_tcp_address, read_card, stop_path
from tester.service.client import Client, Gone, Link, Lost, NoServiceError
from tester.service.commands import CheckRecipe, ListRecipes, RunRecipe
from tester.service.gateway_link import GatewayLink, LinkConfig
from tester.service.protocol import Hello, Snapshot
from tester.service.service import ServiceOptions
from tester.service.service_link import OwnerEnd
from tests.tester.kinds.wheel_on_belt.bench import SHORT
from tests.tester.notices.scene import notice
from tests.tester.service.views import state

ROOT = Path(__file__).parents[3]
ROW = (1.0, 2.0)
BUSY_S = 60.0
"""Time limit of an answer on a machine at full load: starting the answering process takes seconds."""
posix = pytest.mark.skipif(os.name != "posix", reason="Unix sockets")


@pytest.fixture
def gateway(tmp_path: Path) -> Iterator[GatewayLink]:
    made = GatewayLink(LinkConfig(UnixAddress(tmp_path / "service.sock"), tmp_path / CARD, tmp_path, "sim"))
    made.open()
    made.event("step", "before anybody came")
    made.state(state(), ROW)
    yield made
    made.close()


async def connected(gateway: GatewayLink, address: UnixAddress | TcpAddress | None = None) -> Client:
    """Connect while the owner keeps sending, as it does between two ticks."""
    where = address or gateway.config.address
    for _ in range(400):
        gateway.receive()
        gateway.state(state(), ROW)
        try:
            return await Client.connect(where, name="test", control=True)
        except NoServiceError:
            await asyncio.sleep(0.02)
    raise AssertionError("the gateway does not come up")


@posix
@pytest.mark.parametrize("taken", [lambda path: path, stop_path], ids=["clients", "STOP"])
def test_a_path_that_is_no_socket_ends_the_service_with_a_sentence(
    taken: Callable[[Path], Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(service_process, "allow_only", lambda _: None)  # it holds for the rest of a process
    address = tmp_path / "service.sock"
    taken(address).write_text("a note", encoding="utf-8")
    options = ServiceOptions(runs=tmp_path)
    assert service_process.host(options, f"unix:{address}", None, "") == 1
    assert "exists and is not a socket: it is not replaced" in capfd.readouterr().err
    assert taken(address).read_text(encoding="utf-8") == "a note"


@posix
def test_a_gateway_process_that_dies_is_replaced_and_gets_the_earlier_state(gateway: GatewayLink) -> None:
    async def story() -> None:
        client = await connected(gateway)
        process = gateway._process  # pyright: ignore[reportPrivateUsage]
        assert process is not None
        process.kill()
        async for _ in client:
            pass
        gateway.receive()
        gateway.event("step", "while nobody was there")
        again = await connected(gateway)
        texts = [event.text for event in again.events]
        assert texts[0] == "before anybody came" and "while nobody was there" in texts
        assert len(again.trend) >= 2
        assert any("the gateway is gone" in text for text in texts)
        await again.close()

    asyncio.run(story())


@posix
def test_questions_are_answered_beside_the_rig(gateway: GatewayLink) -> None:
    async def story() -> None:
        async with await connected(gateway) as client:
            listed = await client.command(ListRecipes(), within_s=BUSY_S)
            assert isinstance(listed, dict)
            found = listed["recipes"]
            assert isinstance(found, list) and any(isinstance(one, dict) and one["name"] == "table2" for one in found)
            answer = await client.command(CheckRecipe("mine", text=SHORT.replace("200 N", "200 kN")), within_s=BUSY_S)
            assert isinstance(answer, dict) and answer["valid"] is False

    asyncio.run(story())


def test_tcp_needs_the_token(tmp_path: Path) -> None:
    gateway = GatewayLink(LinkConfig(new_tcp_address(), tmp_path / CARD, tmp_path, "sim"))
    gateway.open()
    gateway.state(state(), ROW)

    async def story() -> None:
        while not (tmp_path / CARD).exists():
            await asyncio.sleep(0.02)
        address = read_card(tmp_path / CARD)
        assert (tmp_path / CARD).stat().st_mode & 0o077 == 0 or os.name != "posix"
        with pytest.raises(NoServiceError, match="401"):
            await Client.connect(TcpAddress(address.host, address.port, "guessed"))
        async with await Client.connect(address) as client:
            assert client.state.mode == "RUN"

    try:
        asyncio.run(story())
    finally:
        gateway.close()
    assert not (tmp_path / CARD).exists()


@posix
def test_a_client_that_is_killed_leaves_the_run_alone_and_term_leaves_at_standstill(tmp_path: Path) -> None:
    address = UnixAddress(tmp_path / "s.sock")
    serve = ["serve", "--connect", f"unix:{address.path}", "--out", str(tmp_path / "runs")]
    code = "import sys; from tester.cli.main import main; main()"
    process = subprocess.Popen([sys.executable, "-c", code, *serve], cwd=ROOT, stderr=subprocess.DEVNULL)

    async def story() -> None:
        for _ in range(1000):
            try:
                client = await Client.connect(address, control=True)
                break
            except NoServiceError:
                await asyncio.sleep(0.02)
        else:
            raise AssertionError("the service does not come up")
        await client.command(RunRecipe("short", text=SHORT, speed=20.0, yes=True))
        client._connection.transport.abort()  # pyright: ignore[reportPrivateUsage]
        async with await Client.connect(address) as viewer:
            async for message in viewer:
                if isinstance(message, Snapshot) and message.state.mode == "RUN" and message.state.t_s > 10.0:
                    break
            assert viewer.state.clients.controller == ""
            process.send_signal(signal.SIGTERM)
            async for _ in viewer:
                pass
            assert viewer.lost == "the service has ended"
            assert any("stopped: terminated" in event.text for event in viewer.events)

    try:
        asyncio.run(story())
        assert process.wait(20) == 0
    finally:
        process.kill()
        process.wait()
    assert not address.path.exists()


@posix
def test_a_sign_of_life_of_the_controller_ends_the_silence(gateway: GatewayLink) -> None:
    async def story() -> None:
        client = await connected(gateway)
        assert gateway.silent_s == float("inf")
        client.attend()
        for _ in range(1000):
            gateway.receive()
            if gateway.silent_s < float("inf"):
                break
            await asyncio.sleep(0.01)
        assert gateway.silent_s < 10.0
        await client.close()

    asyncio.run(story())


@posix
@pytest.mark.parametrize("told", [False, True])
def test_clients_can_distinguish_a_dead_owner_from_an_ended_one(told: bool, tmp_path: Path) -> None:
    async def story() -> str:
        gateway = GatewayLink(LinkConfig(UnixAddress(tmp_path / "service.sock"), tmp_path / CARD, tmp_path, "sim"))
        gateway.open()
        gateway.state(state(), ROW)
        await (await connected(gateway)).close()
        link = Link(gateway.config.address, name="test")
        gone = ""
        async for message in link.messages():
            if isinstance(message, Lost) and message.gone:
                gone = message.gone
                break
            if not told and gateway._end is not None:  # pyright: ignore[reportPrivateUsage]
                gateway._end.close()  # pyright: ignore[reportPrivateUsage]  # without a goodbye, as a SIGKILL does
                gateway._end = None  # pyright: ignore[reportPrivateUsage]
            if isinstance(message, Hello):
                await asyncio.to_thread(gateway.close)
        return gone

    assert asyncio.run(story()) == ("ended" if told else "died")


@posix
def test_a_gateway_that_is_started_anew_is_no_death_of_the_service(gateway: GatewayLink) -> None:
    async def story() -> list[Gone]:
        await (await connected(gateway)).close()
        told: list[Gone] = []
        messages = Link(gateway.config.address, name="test").messages()
        async for message in messages:
            if isinstance(message, Hello):
                process = gateway._process  # pyright: ignore[reportPrivateUsage]
                assert process is not None
                process.kill()
                process.wait()
                gateway.config.address.path.unlink()  # type: ignore[union-attr]
            elif isinstance(message, Lost):
                told.append(message.gone)
            if len(told) == 2:
                break
        await messages.aclose()  # type: ignore[attr-defined]
        return told

    assert asyncio.run(story()) == ["", ""]


def test_a_new_gateway_gets_every_message_again_and_the_newest_forecast(tmp_path: Path) -> None:
    gateway = GatewayLink(LinkConfig(UnixAddress(tmp_path / "service.sock"), tmp_path / CARD, tmp_path, "sim"))
    gateway.notify(notice(1))
    for doing in ("run a", "run b"):
        gateway.notify(NextNeeded(doing))
    gateway.notify(NoticeOver("s1-2", "prompt"))
    ours, theirs = socket.socketpair()
    with ours, theirs:
        gateway.adopt(OwnerEnd(ours))
        lines = [line[1:] for line in theirs.recv(65_536).split(b"\n") if line[:1] == b"n"]
    got = [NOTE.validate_json(line) for line in lines]
    assert got == [notice(1), NoticeOver("s1-2", "prompt"), NextNeeded("run b")]
