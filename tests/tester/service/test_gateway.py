from __future__ import annotations

import asyncio
import os
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

import pytest
from websockets.asyncio.client import ClientConnection, unix_connect

from tester.base.screen import MachineView
from tester.service.address import UnixAddress
from tester.service.client import Client, LostError, NoServiceError, RefusedError
from tester.service.commands import (
    VERSION,
    Acknowledge,
    Command,
    Hold,
    Join,
    ListRuns,
    Release,
    RunRecipe,
    Stop,
    TakeControl,
    WatchFrames,
)
from tester.service.gateway import QUESTIONS
from tester.service.manners import MOST_CLIENTS, MOST_STRANGERS, Bucket
from tester.service.outbox import MOST_BEHIND, MOST_REPLIES
from tester.service.protocol import (
    Accepted,
    Event,
    Goodbye,
    Hello,
    MachineMessage,
    PlanMessage,
    Snapshot,
    encode,
    from_server,
)
from tests.tester.service.fake import FakeService
from tests.tester.service.views import HOSTILE, MACHINE, hostile, plan, state

Story = Callable[[FakeService], Awaitable[None]]
needs_unix = pytest.mark.skipif(os.name != "posix", reason="Unix sockets")


def play(folder: Path, story: Story, *, uid: int | None = None) -> None:
    async def run() -> None:
        async with asyncio.timeout(20.0), FakeService(folder, uid=uid) as fake:
            await story(fake)

    asyncio.run(run())


def test_hello_holds_state_plan_events_and_trend(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        fake.plan(plan())
        fake.event("step", "heat to 40 degC")
        async with await Client.connect(fake.address) as client:
            assert (client.state.mode, client.plan) == ("RUN", plan())
            assert [event.text for event in client.events] == ["heat to 40 degC"]
            assert len(client.trend) == 1

    play(tmp_path, story)


def test_snapshots_plans_and_events_reach_a_client(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        async with await Client.connect(fake.address) as client:
            messages = aiter(client)
            assert isinstance(await anext(messages), Hello)
            fake.show(state("HOLD"))
            seen = await anext(messages)
            assert isinstance(seen, Snapshot) and seen.state.mode == "HOLD"
            fake.plan(plan())
            assert isinstance(await anext(messages), PlanMessage)
            fake.event("mode", "hold")
            assert isinstance(await anext(messages), Event)

    play(tmp_path, story)


def test_an_accepted_command_gives_its_result(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        fake.results["hold"] = {"at": 1.0}
        async with await Client.connect(fake.address, control=True) as client:
            assert await client.command(Hold()) == {"at": 1.0}
            assert fake.orders[-1].action == Hold()

    play(tmp_path, story)


@needs_unix
def test_a_command_carries_the_user_id_of_its_client(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        async with await Client.connect(fake.address, name="ada", control=True) as client:
            await client.command(Hold())
            assert fake.orders[-1].by == f"ada (user id {os.getuid()})"
            assert fake.presence.peer == f"user id {os.getuid()}"

    play(tmp_path, story)


def test_a_refused_command_gives_its_reason(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        fake.refusals["release"] = "the rig is not held"
        async with await Client.connect(fake.address, control=True) as client:
            with pytest.raises(RefusedError, match="the rig is not held"):
                await client.command(Release())

    play(tmp_path, story)


def test_commands_that_wait_side_by_side_each_get_their_own_answer(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        fake.results.update({"hold": "held", "stop": "stopped"})
        fake.refusals["release"] = "the rig is not held"
        async with await Client.connect(fake.address, control=True) as client:
            answers = await asyncio.gather(
                *(client.command(action, within_s=5.0) for action in (Hold(), Release(), Stop())),
                return_exceptions=True,
            )
            assert [str(answer) for answer in answers] == ["held", "the rig is not held", "stopped"]

    play(tmp_path, story)


def test_only_the_first_of_two_that_ask_has_control(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        first = await Client.connect(fake.address, name="first", control=True)
        second = await Client.connect(fake.address, name="second", control=True)
        async with first, second:
            assert fake.presence.controller == "first"
            with pytest.raises(RefusedError, match="first has control"):
                await second.command(Hold())
            with pytest.raises(RefusedError, match="first has control"):
                await second.command(TakeControl())

    play(tmp_path, story)


@pytest.mark.parametrize("mode", ["OFFLINE", "INTERRUPTED"])
def test_a_screen_that_is_idle_lends_its_control_to_a_command(tmp_path: Path, mode: str) -> None:
    async def story(fake: FakeService) -> None:
        fake.show(state(mode))
        async with await Client.connect(fake.address, name="screen", control=True) as screen:
            async with await Client.connect(fake.address, name="command", control=True) as command:
                await command.command(RunRecipe("quickstart"))
                assert fake.presence.controller == "command"
            async with asyncio.timeout(20):
                while fake.presence.controller != "screen":
                    await asyncio.sleep(0.001)
            await screen.command(Hold())

    play(tmp_path, story)


@pytest.mark.parametrize("mode", ["RUN", "HOLD", "MANUAL", "IDLE", "LATCHED", "CONNECTING"])
def test_no_control_is_lent_while_something_is_under_way(tmp_path: Path, mode: str) -> None:
    async def story(fake: FakeService) -> None:
        fake.show(state(mode))
        first = await Client.connect(fake.address, name="first", control=True)
        second = await Client.connect(fake.address, name="second", control=True)
        async with first, second:
            with pytest.raises(RefusedError, match="first has control"):
                await second.command(Acknowledge())

    play(tmp_path, story)


def test_no_control_is_lent_before_the_result_of_an_order_is_known(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        fake.show(state("OFFLINE"))
        first = await Client.connect(fake.address, name="first", control=True)
        second = await Client.connect(fake.address, name="second", control=True)
        async with first, second:
            await first.command(RunRecipe("quickstart"))
            with pytest.raises(RefusedError, match="first has control"):
                await second.command(Hold())

    play(tmp_path, story)


def test_a_client_that_did_not_ask_for_control_is_lent_none(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        fake.show(state("OFFLINE"))
        first = await Client.connect(fake.address, name="first", control=True)
        second = await Client.connect(fake.address, name="second")
        async with first, second:
            with pytest.raises(RefusedError, match="first has control"):
                await second.command(RunRecipe("quickstart"))

    play(tmp_path, story)


def test_control_is_taken_over_only_by_force(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        first = await Client.connect(fake.address, name="first", control=True)
        second = await Client.connect(fake.address, name="second")
        async with first, second:
            await second.command(TakeControl(force=True))
            await second.command(Hold())
            with pytest.raises(RefusedError, match="second has control"):
                await first.command(Hold())

    play(tmp_path, story)


def test_control_is_free_once_its_holder_has_gone(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        first = await Client.connect(fake.address, name="first", control=True)
        async with await Client.connect(fake.address, name="second") as second:
            await first.close()
            while fake.presence.controller:
                await asyncio.sleep(0)
            await second.command(TakeControl())
            await second.command(Hold())
            assert fake.presence.controller == "second"
            assert (fake.orders[-1].action, fake.orders[-1].name) == (Hold(), "second")

    play(tmp_path, story)


def test_stop_is_taken_from_a_viewer(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        first = await Client.connect(fake.address, name="first", control=True)
        async with first, await Client.connect(fake.address, name="viewer") as viewer:
            await viewer.stop(fast=True)
            assert (fake.orders[-1].action, fake.orders[-1].name) == (Stop(fast=True), "viewer")

    play(tmp_path, story)


def test_a_client_that_comes_back_gets_every_event_in_between_once(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        for number in range(5):
            fake.event("step", f"step {number}")
        client = await Client.connect(fake.address)
        service, since = client.service, client.last_seq
        await client.close()
        for number in range(5, 8):
            fake.event("step", f"step {number}")
        async with await Client.connect(fake.address, service=service, since=since) as again:
            assert [event.seq for event in again.events] == [6, 7, 8]
            assert again.complete

    play(tmp_path, story)


def test_events_of_another_life_of_the_service_are_not_mistaken_for_missing_ones(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        fake.event("step", "one")
        async with await Client.connect(fake.address, service="life-0", since=70) as client:
            assert [event.seq for event in client.events] == [1]

    play(tmp_path, story)


def test_events_no_longer_kept_are_reported_as_missing(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        for number in range(2500):
            fake.event("step", f"step {number}")
        async with await Client.connect(fake.address, service="life-1", since=10) as client:
            assert not client.complete
            assert len(client.events) == 2000

    play(tmp_path, story)


def test_a_name_that_could_steer_a_terminal_is_refused_with_the_reason(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        with pytest.raises(NoServiceError, match=r"join.name: the character U\+001B, number 7, is not accepted"):
            await Client.connect(fake.address, name="screen\x1b[2J")
        assert not fake.gateway.guests

    play(tmp_path, story)


def test_hostile_text_comes_through_as_it_is(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        fake.event("step", HOSTILE)
        async with await Client.connect(fake.address, name="[/x] $(rm) <b>", control=True) as client:
            fake.show(hostile(state()))
            messages = aiter(client)
            while not isinstance(await anext(messages), Snapshot):
                pass
            assert client.state.prompt is not None and client.state.prompt.text == HOSTILE
            assert client.events[-1].text == HOSTILE
            assert fake.presence.controller == "[/x] $(rm) <b>"

    play(tmp_path, story)


def test_another_user_is_turned_away(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        with pytest.raises(NoServiceError, match="403"):
            await Client.connect(fake.address)

    play(tmp_path, story, uid=4_000_000_000)


def test_the_socket_is_its_users_alone(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        assert (tmp_path / "service.sock").stat().st_mode & 0o777 == 0o600

    play(tmp_path, story)


def test_a_client_that_does_not_read_gets_the_newest_state_and_delays_no_other(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        slow = await Client.connect(fake.address, name="slow")
        slow._connection.transport.pause_reading()  # pyright: ignore[reportPrivateUsage]
        async with slow, await Client.connect(fake.address, name="quick") as quick:
            messages = aiter(quick)
            for number in range(2000):
                fake.show(replace(state(), t_s=float(number)))
                if number % 50 == 0:
                    await asyncio.sleep(0)
            while quick.state.t_s < 1999.0:
                await anext(messages)
            assert all(len(guest.outbox) < 5 for guest in fake.gateway.guests.values())
            slow._connection.transport.resume_reading()  # pyright: ignore[reportPrivateUsage]
            messages = aiter(slow)
            while slow.state.t_s < 1999.0:
                await anext(messages)
            assert len(slow.trend) < 1000

    play(tmp_path, story)


def test_a_client_that_does_not_take_its_events_is_sent_away(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        slow = await Client.connect(fake.address, name="slow")
        slow._connection.transport.pause_reading()  # pyright: ignore[reportPrivateUsage]
        number = 0
        while fake.gateway.guests and not any(guest.leaving for guest in fake.gateway.guests.values()):
            number += 1
            fake.event("step", f"step {number} " + 1000 * "x")
            await asyncio.sleep(0)
        assert number > MOST_BEHIND
        slow._connection.transport.resume_reading()  # pyright: ignore[reportPrivateUsage]
        async for _ in slow:
            pass
        assert "come back with since" in slow.lost
        with pytest.raises(LostError):
            await slow.stop()

    play(tmp_path, story)


def test_one_client_more_than_there_are_places_is_refused_with_a_reason(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        there = [await Client.connect(fake.address) for _ in range(MOST_CLIENTS)]
        with pytest.raises(NoServiceError, match=f"{MOST_CLIENTS} clients"):
            await Client.connect(fake.address)
        await there[0].close()
        while len(fake.gateway.guests) >= MOST_CLIENTS:
            await asyncio.sleep(0)
        there[0] = await Client.connect(fake.address)
        await asyncio.gather(*(client.close() for client in there))

    play(tmp_path, story)


def test_connections_that_never_join_keep_no_client_out(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        path = str(tmp_path / "service.sock")
        idle = [await asyncio.open_unix_connection(path) for _ in range(3 * MOST_STRANGERS)]
        async with await Client.connect(fake.address) as client:
            assert client.state.mode == "RUN"
            assert len(fake.gateway.strangers) <= MOST_STRANGERS
        for _, writer in idle:
            writer.close()

    play(tmp_path, story)


def test_a_client_that_talks_without_a_pause_is_read_at_the_rate_it_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    waited: list[float] = []
    monkeypatch.setattr(Bucket, "spend", lambda self, size: waited.append(1.0) or 0.001)  # pyright: ignore

    async def story(fake: FakeService) -> None:
        async with await Client.connect(fake.address) as client:
            await asyncio.gather(*(client.command(WatchFrames(on=bool(number % 2))) for number in range(20)))
            assert len(waited) == 20

    play(tmp_path, story)


def test_of_the_pending_orders_of_a_gone_client_only_stop_is_obeyed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spent: list[int] = []
    monkeypatch.setattr(Bucket, "spend", lambda self, size: spent.append(size) or 3600.0)  # pyright: ignore

    async def story(fake: FakeService) -> None:
        client = await Client.connect(fake.address, name="gone")
        said = [asyncio.create_task(client.command(action)) for action in (TakeControl(), TakeControl(), Stop())]
        while not spent:
            await asyncio.sleep(0)
        client._connection.transport.abort()  # pyright: ignore[reportPrivateUsage]
        while fake.gateway.guests:
            fake.show(state("RUN"))
            await asyncio.sleep(0)
        assert len(spent) == 3 and fake.presence.controller == ""
        while not fake.orders:
            await asyncio.sleep(0)
        assert [order.action for order in fake.orders] == [Stop()]
        await asyncio.gather(*said, return_exceptions=True)

    play(tmp_path, story)


def test_a_client_that_does_not_take_its_answers_is_sent_away(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        client = await Client.connect(fake.address)
        client._connection.transport.pause_reading()  # pyright: ignore[reportPrivateUsage]
        guest = next(iter(fake.gateway.guests.values()))
        number = 0
        while fake.gateway.guests and not guest.leaving:
            number += 1
            fake.gateway.take(b"a%d " % guest.number + b"x" * 10_000)
            await asyncio.sleep(0)
        assert number > MOST_REPLIES and len(guest.outbox) <= MOST_REPLIES + 2
        client._connection.transport.resume_reading()  # pyright: ignore[reportPrivateUsage]
        async for _ in client:
            pass
        assert "come back with since" in client.lost

    play(tmp_path, story)


def test_a_client_asks_a_few_questions_at_a_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    go = asyncio.Event()

    async def answer(question: object) -> dict[str, object]:
        await go.wait()
        return {}

    async def story(fake: FakeService) -> None:
        monkeypatch.setattr(type(fake.gateway.queries), "answer", lambda self, question: answer(question))
        async with await Client.connect(fake.address) as client:
            asked = [asyncio.create_task(client.command(ListRuns())) for _ in range(QUESTIONS + 1)]
            with pytest.raises(RefusedError, match="questions are being worked out"):
                await asked.pop()
            go.set()
            assert await asyncio.gather(*asked) == [{}] * QUESTIONS
            assert await client.command(ListRuns()) == {}

    play(tmp_path, story)


async def raw(fake: FakeService) -> ClientConnection:
    assert isinstance(fake.address, UnixAddress)
    return await unix_connect(str(fake.address.path), uri="ws://localhost/", compression=None)


async def stop_arrives(fake: FakeService) -> Stop:
    while not fake.orders:
        await asyncio.sleep(0)
    action = fake.orders[-1].action
    assert isinstance(action, Stop)
    return action


@needs_unix
@pytest.mark.parametrize(
    "join", [b'{"type":"join","name":"old","version":1}', b'{"type":"join","name":"old"}'], ids=["version 1", "none"]
)
def test_a_client_of_version_1_is_refused_with_the_reason_and_a_remedy(tmp_path: Path, join: bytes) -> None:
    async def story(fake: FakeService) -> None:
        async with await raw(fake) as old:
            await old.send(join, text=True)
            said = from_server(await old.recv())
        assert isinstance(said, Goodbye)
        for words in ("speaks version 1", f"the service version {VERSION}", "install the same version", "STOP"):
            assert words in said.reason

    play(tmp_path, story)


@needs_unix
def test_a_client_of_a_newer_version_learns_that_the_service_is_older(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        async with await raw(fake) as new:
            await new.send(b'{"type":"join","name":"new","version":99,"mood":"good"}', text=True)
            said = from_server(await new.recv())
        assert isinstance(said, Goodbye) and "here the service is the older one" in said.reason

    play(tmp_path, story)


@needs_unix
def test_a_client_that_is_refused_can_stop_the_rig_all_the_same(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        async with await raw(fake) as old:
            await old.send(b'{"type":"join","name":"old","version":1}', text=True)
            await old.recv()
            await old.send(b'{"type":"command","id":1,"action":{"command":"stop","fast":true}}', text=True)
            assert (await stop_arrives(fake)).fast

    play(tmp_path, story)


@needs_unix
def test_stop_as_the_first_word_is_taken_and_on_record_as_a_strangers(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        async with await raw(fake) as stranger:
            await stranger.send(b'{"type":"command","id":1,"action":{"command":"stop"}}', text=True)
            assert not (await stop_arrives(fake)).fast
            assert fake.orders[-1].by == f"a client that has not joined (user id {os.getuid()})"

    play(tmp_path, story)


@needs_unix
def test_a_client_that_finds_no_place_can_stop_the_rig_all_the_same(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        there = [await Client.connect(fake.address) for _ in range(MOST_CLIENTS)]
        async with await raw(fake) as late:
            await late.send(encode(Join("late")), text=True)
            await late.recv()
            await late.send(encode(Command(1, Stop())), text=True)
            await stop_arrives(fake)
        await asyncio.gather(*(client.close() for client in there))

    play(tmp_path, story)


@needs_unix
@pytest.mark.parametrize("more", [b',"fsat":true', b',"fast":"yes"', b',"scope":"all"'])
def test_a_stop_with_unknown_data_is_a_stop(tmp_path: Path, more: bytes) -> None:
    async def story(fake: FakeService) -> None:
        async with await raw(fake) as client:
            await client.send(encode(Join("script")), text=True)
            await client.recv()
            await client.send(b'{"type":"command","id":7,"action":{"command":"stop"' + more + b'},"new":1}', text=True)
            await stop_arrives(fake)
            while not isinstance(answer := from_server(await client.recv()), Accepted):
                pass
            assert answer.id == 7

    play(tmp_path, story)


def test_another_kind_of_rig_is_announced_before_its_first_state_and_restarts_the_trend(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        async with await Client.connect(fake.address) as client:
            messages = aiter(client)
            assert isinstance(await anext(messages), Hello)
            assert client.machine == MACHINE and len(client.trend) == 1
            fake.machine(MachineView("track", ("wall_s", "t_s", "force_n")))
            fake.show(state("HOLD"), (1.0, 2.0, 3.0))
            told = await anext(messages)
            assert isinstance(told, MachineMessage) and client.machine.kind == "track"
            assert isinstance(await anext(messages), Snapshot)
            assert list(client.trend) == [(1.0, 2.0, 3.0)]
        async with await Client.connect(fake.address) as late:
            assert late.machine.kind == "track" and list(late.trend) == [(1.0, 2.0, 3.0)]

    play(tmp_path, story)


def test_the_same_tables_sent_again_change_nothing(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        fake.machine(MACHINE)
        async with await Client.connect(fake.address) as client:
            assert len(client.trend) == 1

    play(tmp_path, story)
