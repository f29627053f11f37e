"""The screen of the queue."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic_core import to_json

from tester.queue.events import ItemAdded, ItemBegan, ItemTaken, QueueEvent, QueueStarted
from tester.queue.view import QueueView, view_of
from tester.service.commands import QueueAdd, QueueDrop, QueueMove, QueueSkip, QueueStand, QueueStart
from tester.tui.pages.queue_page import QueuePage, cells
from tests.tester.queue.made import UTC, item, queue_of
from tests.tester.tui.stage import Stage, play
from tests.tester.tui.test_screens import SIZES, compare

EVENTS: tuple[QueueEvent, ...] = (
    ItemAdded(item(1, name="night")), ItemAdded(item(2, name="[red]day[/]")), ItemAdded(item(3)), QueueStarted("anna"),
    ItemTaken(1), ItemBegan(1, "run-1"),
)  # fmt: skip


def view() -> QueueView:
    return view_of(queue_of(*EVENTS), "item 1 runs", UTC)


def test_an_item_is_a_row_of_plain_text() -> None:
    rows = [cells(one) for one in view().items]
    assert [row[:3] for row in rows] == [
        ("1", "running", "night"), ("2", "waiting", "[red]day[/]"), ("3", "waiting", "recipe 3")
    ]  # fmt: skip


@pytest.fixture(autouse=True)
def _utc(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tester.tui.formatting.local", lambda moment: moment)


async def at_queue(on: Stage) -> QueuePage:
    on.fake.gateway.take(b"q" + to_json(view()))
    await on.pilot.press("f8")
    await on.until(lambda: "Queue: item 1 runs" in on.text(), "the queue is shown")
    page = on.app.view
    assert isinstance(page, QueuePage)
    return page


def test_keys_change_the_queue_as_it_is_shown(tmp_path: Path) -> None:
    async def script(on: Stage) -> None:
        page = await at_queue(on)
        page.table.move_cursor(row=1)
        for keys in (["right_square_bracket"], ["k"], ["delete"], ["s"], ["w"], ["y"], ["n"]):
            count = len(on.fake.orders)
            await on.pilot.press(*keys)
            await on.until(lambda count=count: len(on.fake.orders) > count, "the order arrives")
        actions = [order.action for order in on.fake.orders]
        assert actions[:6] == [
            QueueMove(2, 6, 0), QueueSkip(2, 6), QueueDrop(2, 6), QueueStart(), QueueStand(), QueueStart(agree=(2,))
        ]  # fmt: skip
        assert isinstance(actions[6], QueueAdd)

    play(script, tmp_path, (120, 30))


@pytest.mark.parametrize("size", SIZES)
def test_the_page_and_its_dialogs_look_as_they_did(size: str, tmp_path: Path) -> None:
    async def script(on: Stage) -> None:
        await at_queue(on)
        compare(f"queue-{size}", on.text())
        for key, name in (("o", "add"), ("u", "until"), ("f1", "help")):
            await on.pilot.press(key)
            await on.pilot.pause()
            compare(f"queue-{name}-{size}", on.text())
            await on.pilot.press("escape")

    play(script, tmp_path, SIZES[size])


def test_a_recipe_is_added_several_times_with_a_limit_for_its_questions(tmp_path: Path) -> None:
    async def script(on: Stage) -> None:
        await at_queue(on)
        await on.pilot.press("o", "backspace", "3", "tab", *"2 h", "tab", "space", "tab", "enter")
        order = await on.ordered(QueueAdd)
        assert isinstance(order, QueueAdd)
        assert (order.copies, order.answer_within_s, order.unanswered) == (3, 7200.0, "skip")
        await on.until(lambda: "is added as 3 items" in on.text(), "it is said")
        assert len(on.app.screen_stack) == 1

    play(script, tmp_path)


def test_enter_alone_adds_it_once_without_a_limit(tmp_path: Path) -> None:
    async def script(on: Stage) -> None:
        await at_queue(on)
        await on.pilot.press("n")
        plain = await on.ordered(QueueAdd)
        await on.pilot.press("o", "enter")
        await on.until(lambda: len(on.fake.orders) == 2, "the order arrives")
        assert on.fake.orders[1].action == plain

    play(script, tmp_path)


@pytest.mark.parametrize(
    ("keys", "message", "where"),
    [
        (["o", "backspace", "0", "enter"], "copies: expected a number from 1 to 50", "copies"),
        (["o", "tab", *"2", "enter"], "answer within: ", "within"),
        (["o", "tab", *"5 s", "enter"], "expected 1 min to 7 days", "within"),
        (["o", "tab", "tab", "space", "tab", "enter"], "expected a time such as 2 h", "within"),
        (["u", *"25:00", "enter"], "expected a time of day such as 18:00", "until"),
        (["u", "enter"], "expected a time of day such as 18:00", "until"),
    ],
)
def test_invalid_input_is_named_and_nothing_is_ordered(
    keys: list[str], message: str, where: str, tmp_path: Path
) -> None:
    async def script(on: Stage) -> None:
        await at_queue(on)
        await on.pilot.press(*keys)
        await on.until(lambda: message in on.text(), "it is said")
        assert on.app.focused is not None and on.app.focused.id == where and not on.fake.orders

    play(script, tmp_path)


def test_the_queue_starts_until_a_time_of_day(tmp_path: Path) -> None:
    async def script(on: Stage) -> None:
        await at_queue(on)
        await on.pilot.press("u", *"6:30", "enter")
        assert await on.ordered(QueueStart) == QueueStart((), "06:30")
        await on.pilot.press("u", *"07:00", "tab", "space", "tab", "enter")
        await on.until(lambda: len(on.fake.orders) == 2, "the order arrives")
        assert on.fake.orders[1].action == QueueStart((2,), "07:00")

    play(script, tmp_path)
