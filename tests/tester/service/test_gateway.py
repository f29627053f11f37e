from __future__ import annotations

import asyncio
import os
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tester.service.client import Client, LostError, NoServiceError, RefusedError
from tester.service.commands import Acknowledge, Control, Hold, ListRuns, Release, RunRecipe, Stop, WatchFrames
from tester.service.gateway import QUESTIONS
from tester.service.manners import MOST_CLIENTS, MOST_STRANGERS, Bucket
from tester.service.outbox import MOST_BEHIND, MOST_REPLIES
from tester.service.protocol import Event, Hello, PlanMessage, Snapshot
from tests.tester.service.fake import FakeService
from tests.tester.service.views import HOSTILE, hostile, plan, state

Story = Callable[[FakeService], Awaitable[None]]


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


@pytest.mark.skipif(os.name != "posix", reason="Unix sockets")
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
                await second.command(Control())

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


def test_no_control_is_lent_before_what_an_order_made_is_known(tmp_path: Path) -> None:
    async def story(fake: FakeService) -> None:
        fake.show(state("OFFLINE"))
        first = await Client.connect(fake.address, name="first", control=True)
        second = await Client.connect(fake.address, name="second", control=True)
        async with first, second:
            await first.command(RunRecipe("quickstart"))
            with pytest.raises(RefusedError, match="first has control"):
                await second.command(Hold())

    play(tmp_path, story)


def test_who_asked_for_no_control_is_lent_none(tmp_path: Path) -> None:
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
            await second.command(Control(force=True))
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
            await second.command(Control())
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


def test_events_no_longer_kept_are_said_to_be_missing(tmp_path: Path) -> None:
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


def test_a_client_that_does_not_read_gets_the_newest_state_and_holds_nobody_up(tmp_path: Path) -> None:
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


def test_one_client_more_than_there_are_places_is_turned_away_and_says_why(tmp_path: Path) -> None:
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


def test_connections_that_never_join_keep_nobody_out(tmp_path: Path) -> None:
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


def test_of_what_a_client_that_is_gone_had_left_to_say_stop_alone_is_heard(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spent: list[int] = []
    monkeypatch.setattr(Bucket, "spend", lambda self, size: spent.append(size) or 3600.0)  # pyright: ignore

    async def story(fake: FakeService) -> None:
        client = await Client.connect(fake.address, name="gone")
        said = [asyncio.create_task(client.command(action)) for action in (Control(), Control(), Stop())]
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
