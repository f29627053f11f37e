"""Pages, friendly and hostile, over real sockets."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from pydantic_core import to_json
from websockets.exceptions import ConnectionClosed, InvalidStatus

from tester.base.trouble import MisuseError
from tester.page import reception
from tester.page.desk_call import NewCode, Revoke
from tester.page.page_process import PageOptions, check_options
from tester.queue.calendar import new_key, revoke_key
from tester.service.commands import AddNote, ExcludeRepeat, Hold
from tester.service.stop_lane import StopLane
from tests.tester.page.stage import PageStage
from tests.tester.queue.test_calendar import view
from tests.tester.service.views import HOSTILE, hostile, plan, state

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the fake service listens at a Unix socket")
Story = Callable[[PageStage], Awaitable[None]]


def play(folder: Path, story: Story, **options: Any) -> None:
    async def run() -> None:
        async with asyncio.timeout(120.0), PageStage(folder, **options) as stage:
            await story(stage)

    asyncio.run(run())


# -- sent to a page ------------------------------------------------------------------------------------------


def test_a_paired_page_gets_state_plan_and_events(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("look")
        assert (await page.until("link"))["connected"]
        assert (await page.service("hello"))["state"]["mode"] == "RUN"
        stage.fake.show(state("HOLD"))
        assert (await page.service("snapshot"))["state"]["mode"] == "HOLD"
        stage.fake.plan(plan())
        assert (await page.service("plan"))["plan"]["name"] == plan().name
        stage.fake.event("step", "heat to 40 degC")
        assert (await page.service("event"))["text"] == "heat to 40 degC"

    play(tmp_path, story)


def test_its_secret_lets_it_in_again(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        secret = await stage.secret("stop")
        page = await stage.browser()
        await page.send(type="enter", secret=secret)
        answer = await page.until("entered", "refused")
        assert (answer["type"], answer["role"], answer["name"]) == ("entered", "stop", "Anna's phone")

    play(tmp_path, story)


def test_each_event_arrives_once(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        for n in range(5):
            stage.fake.event("step", f"before {n}")
        page = await stage.paired("look")
        for n in range(5):
            stage.fake.event("step", f"after {n}")
        while (await page.service("event"))["text"] != "after 4":
            pass
        seen = [m["message"] for m in page.kept if m["type"] == "service"]
        numbers = [e["seq"] for m in seen for e in (m["events"] if m["type"] == "hello" else [m]) if "seq" in e]
        assert numbers == sorted(set(numbers)) and len(numbers) == 10

    play(tmp_path, story)


def test_a_page_learns_that_the_service_is_gone(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("look")
        await page.service("hello")
        stage.fake.gateway.farewell()
        await stage.fake.__aexit__(None, None, None)
        while (link := await page.until("link"))["connected"]:
            pass
        assert link["reason"]
        late = await stage.paired("look", "late")
        assert not (await late.until("link"))["connected"]

    play(tmp_path, story)


def test_hostile_texts_pass_as_data(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("look")
        await page.service("hello")
        stage.fake.show(hostile(state()))
        shown = (await page.service("snapshot"))["state"]
        assert shown["run"]["recipe"] == shown["run"]["operator"] == shown["prompt"]["text"] == HOSTILE

    play(tmp_path, story)


# -- commands ------------------------------------------------------------------------------------------------


def test_control_holds_under_the_pages_name(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("control")
        assert (await page.command({"command": "hold"}))["type"] == "accepted"
        order = stage.fake.orders[-1]
        assert order.action == Hold() and order.name == "page 1: Anna's phone"

    play(tmp_path, story)


@pytest.mark.parametrize(
    ("query", "keys", "action"),
    [
        ("note", {"text": "swept", "tags": ["x"]}, AddNote("run", "swept", ("x",))),
        ("exclude", {"n": 3, "repeat": 2, "reason": "debris"}, ExcludeRepeat("run", 3, "debris", 2)),
    ],
)
def test_a_note_or_exclusion_on_the_run_under_way_goes_to_the_service_with_the_pages_name(
    query: str, keys: dict[str, Any], action: AddNote | ExcludeRepeat, tmp_path: Path
) -> None:
    async def story(stage: PageStage) -> None:
        view = state()
        assert view.run is not None
        stage.fake.show(replace(view, run=replace(view.run, name="run", folder="/runs/run")))
        stage.fake.results["exclude"] = {"repeats": 1}
        page = await stage.paired("control")
        await page.service("hello")
        answer = await page.ask(query, run="run", **keys)
        assert answer["type"] == "accepted" and answer["result"] == stage.fake.results.get(query)
        order = stage.fake.orders[-1]
        assert order.action == action and order.name == "page 1: Anna's phone"
        assert stage.fake.presence is None or not stage.fake.presence.controller  # it does not ask for control
        stage.fake.orders.clear()
        looks = await stage.paired("look")
        await looks.service("hello")
        refused = await looks.ask(query, run="run", **keys)
        assert refused["type"] == "refused" and "needs the role control" in refused["reason"]
        other = await page.ask(query, run="another", **keys)
        assert other["type"] == "refused" and not stage.fake.orders

    play(tmp_path, story)


def test_look_commands_nothing(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("look")
        for action in ({"command": "hold"}, {"command": "stop"}, {"command": "arm"}, {"command": "nonsense"}, {}):
            assert (await page.command(action))["type"] == "refused"
        assert not stage.fake.orders

    play(tmp_path, story)


def test_a_run_needs_the_code_on_the_machines_screen(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("control")
        action = {"command": "run", "recipe": "quickstart"}
        assert (await page.command(action))["reason"].startswith("code:")
        (code,) = (await stage.desk()).asked
        assert code.page == "page 1: Anna's phone" and "quickstart" in code.what
        assert any(code.digits in line for line in stage.printed)
        wrong = f"{(int(code.digits) + 1) % 10**6:06d}"
        assert (await page.command(action, code=wrong))["reason"].startswith("code:") and not stage.fake.orders
        other = {"command": "run", "recipe": "quickstart", "seed": 9}
        stage.fake.results["run"] = {"run": "r", "folder": "runs/r"}
        assert (await page.command(action, code=code.digits))["result"]["run"] == "r"
        assert (await page.command(other, code=code.digits))["reason"].startswith("code:")
        assert len(stage.fake.orders) == 1

    play(tmp_path, story)


def test_a_file_of_the_machine_is_not_read(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("control")
        answer = await page.command({"command": "check", "recipe": "/etc/passwd"})
        assert "not a recipe of the service's list" in answer["reason"]

    play(tmp_path, story)


def test_a_page_without_a_service_is_refused_and_not_hung(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("control")
        await stage.fake.__aexit__(None, None, None)
        assert (await page.command({"command": "hold"}))["type"] == "refused"
        assert "STOP has not arrived" in (await page.command({"command": "stop"}))["reason"]

    play(tmp_path, story)


def test_stop_goes_to_its_own_door_in_a_message_of_any_form(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        lane = StopLane()
        lane.open(stage.fake.address)
        try:
            page = await stage.paired("stop")
            await page.send(type="command", id=7, action={"command": "stop", "fast": True, "new": [1]}, more={})
            assert (await page.until("accepted", "refused", number=7))["type"] == "accepted"
            (wish,) = lane.taken()
            assert wish.fast and wish.name.startswith("page 1: Anna's phone")
            assert not stage.fake.orders  # not through the gateway
        finally:
            lane.close()

    play(tmp_path, story)


# -- admission -----------------------------------------------------------------------------------------------


def test_a_thousand_wrong_codes_open_nothing_and_leave_paired_pages_their_stop(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reception, "WRONG_S", 0.0)

    async def story(stage: PageStage) -> None:
        lane = StopLane()
        lane.open(stage.fake.address)
        try:
            page = await stage.paired("stop")
            right = (await stage.desk(NewCode("control"))).code
            assert right is not None

            async def guess(n: int) -> str:
                browser = await stage.browser()
                await browser.send(type="pair", code=f"{(int(right.digits) + 1 + n) % 10**6:06d}", name="guess")
                return str((await browser.until("paired", "refused"))["type"])

            for first in range(0, 1000, 20):
                answers = await asyncio.gather(*(guess(first + n) for n in range(20)))
                assert set(answers) == {"refused"}
                if first % 200 == 0:
                    assert (await page.command({"command": "stop"}))["type"] == "accepted"
            late = await stage.browser()
            await late.send(type="pair", code=right.digits, name="late")
            assert (await late.until("paired", "refused"))["type"] == "refused"
            assert len((await stage.desk()).pairings) == 1
        finally:
            lane.close()

    play(tmp_path, story)


@pytest.mark.parametrize("secret", ["", "guess", "x" * 43])
def test_another_secret_does_not_enter(secret: str, tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        await stage.secret("control")
        page = await stage.browser()
        await page.send(type="enter", secret=secret)
        assert (await page.until("entered", "refused"))["type"] == "refused"
        with pytest.raises(ConnectionClosed):
            await page.connection.recv()
        assert page.connection.close_code == 4003

    play(tmp_path, story)


def test_a_revoked_page_is_closed_and_its_secret_is_over(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("control")
        secret = page.kept[0]["secret"]
        (pairing,) = (await stage.desk()).pairings
        assert (pairing.name, pairing.role, pairing.pages) == ("Anna's phone", "control", 1)
        assert (await stage.desk(Revoke(pairing.number))).pairings == ()
        assert "revoked" in (await page.until("bye"))["reason"]
        again = await stage.browser()
        await again.send(type="enter", secret=secret)
        assert (await again.until("entered", "refused"))["type"] == "refused"

    play(tmp_path, story)


@pytest.mark.parametrize(
    "first", ['{"type":"command","id":1,"action":{"command":"stop"}}', "{", "[]", '{"type":"enter"}']
)
def test_nothing_comes_before_pairing(first: str, tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.browser()
        await page.connection.send(first)
        assert (await page.until("refused"))["reason"] == "the first message is pair or enter"
        with pytest.raises(ConnectionClosed):
            await page.connection.recv()
        assert [m["type"] for m in page.kept] == ["refused"]

    play(tmp_path, story)


@pytest.mark.parametrize(
    "origin", ["http://rebound.example", "https://127.0.0.1:{port}", "http://127.0.0.1:1", "null", None]
)
def test_a_socket_of_another_origin_is_refused(origin: str | None, tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        with pytest.raises(InvalidStatus) as refusal:
            await stage.browser(origin=origin and origin.format(port=stage.port))
        assert refusal.value.response.status_code == 403

    play(tmp_path, story)


@pytest.mark.parametrize(
    "head",
    [
        "GET / HTTP/1.1\nHost: rebound.example:{port}\n\n",
        "GET / HTTP/1.1\nHost: 127.0.0.1:9000\n\n",
        "GET / HTTP/1.1\nHost: 127.0.0.1:{port}\nHost: rebound.example\n\n",
        "GET / HTTP/1.1\nHost: 127.0.0.1:{port}\nOrigin: http://rebound.example\n\n",
        "GET / HTTP/1.1\n\n",
    ],
)
def test_a_request_for_another_name_is_refused(head: str, tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        assert (await stage.http(head.format(port=stage.port))).startswith(b"HTTP/1.1 403 ")

    play(tmp_path, story)


def test_a_forwarded_port_is_accepted_if_it_was_named(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        answer = await stage.http("GET /none HTTP/1.1\nHost: lab.example:9000\n\n")
        assert answer.startswith(b"HTTP/1.1 404 ")

    play(tmp_path, story, origins=("http://lab.example:9000",))


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS"])
def test_a_form_changes_nothing(method: str, tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        host = f"Host: 127.0.0.1:{stage.port}\nOrigin: {stage.origin}"
        empty = f"{method} /socket HTTP/1.1\n{host}\nContent-Length: 0\n\n"
        assert b" 405 " in (await stage.http(empty)).partition(b"\r\n")[0]
        body = f'{method} /socket HTTP/1.1\n{host}\nContent-Length: 15\n\n{{"type":"pair"}}'
        assert not (await stage.http(body)).startswith(b"HTTP/1.1 2")
        assert (await stage.desk()).pairings == () and not stage.fake.orders

    play(tmp_path, story)


def test_every_answer_carries_the_policy(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        for path in ("/", "/none", "/download/guess"):
            answer = await stage.http(f"GET {path} HTTP/1.1\nHost: 127.0.0.1:{stage.port}\n\n")
            head = answer.partition(b"\r\n\r\n")[0]
            assert b"require-trusted-types-for 'script'" in head and b"frame-ancestors 'none'" in head
            assert b"nosniff" in head and b"no-referrer" in head and b"unsafe" not in head

    play(tmp_path, story)


# -- the queue ----------------------------------------------------------------------------------------------


def test_a_page_that_enters_later_gets_the_queue_as_it_is_now(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        first = await stage.paired("look")
        await first.service("hello")
        stage.fake.gateway.take(b"q" + to_json(view("night")))
        assert (await first.service("queue"))["queue"]["items"][0]["name"] == "night"
        late = await stage.paired("look", "late")
        assert (await late.service("hello"))["queue"]["items"][0]["name"] == "night"

    play(tmp_path, story)


def test_a_calendar_reads_times_and_names_with_its_key_until_that_is_revoked(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("look")
        await page.service("hello")
        stage.fake.gateway.take(b"q" + to_json(view("night")))
        await page.service("queue")
        key = new_key(tmp_path / "runs", "phone")
        host = f"HTTP/1.1\nHost: 127.0.0.1:{stage.port}\n\n"
        shown = await stage.http(f"GET /queue.ics?key={key} {host}")
        assert b"SUMMARY:night" in shown and b"text/calendar" in shown and b"secret operator" not in shown
        revoke_key(tmp_path / "runs", 1)
        for wrong in (f"?key={key}", "?key=", "", f"?key={key}&key={key}", "?key=%00"):
            assert (await stage.http(f"GET /queue.ics{wrong} {host}")).startswith(b"HTTP/1.1 403 ")

    play(tmp_path, story)


# -- options -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (PageOptions(lan="192.168.1.20", role="control"), "certificate"),
        (PageOptions(lan="rig.example"), "expected this machine's address"),
        (PageOptions(certificate=Path("c")), "go together"),
        (PageOptions(certificate=Path("c"), key=Path("k")), "--lan"),
    ],
)
def test_options_that_do_not_go_together(options: PageOptions, says: str) -> None:
    with pytest.raises(MisuseError, match=says):
        check_options(options)


def test_in_the_clear_a_page_on_the_network_controls_nothing(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        view = await stage.desk(NewCode("control"))
        assert view.roles == ("look", "stop") and view.code is not None and view.code.what == "look"
        request = f"GET /none HTTP/1.1\nHost: 127.0.0.2:{stage.port}\n\n"
        assert (await stage.http(request)).startswith(b"HTTP/1.1 404 ")

    play(tmp_path, story, lan="127.0.0.2")


def test_a_second_page_for_a_service_is_refused(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        from tester.page.page_process import host_page
        from tests.tester.page.stage import free_port

        with pytest.raises(MisuseError, match="open already"):
            await host_page(PageOptions(free_port(), address=stage.fake.address), lambda _: None)

    play(tmp_path, story)
