"""The screen of the queue."""

from __future__ import annotations

from pathlib import Path

from pydantic_core import to_json

from tester.queue.events import ItemAdded, ItemBegan, ItemTaken, QueueEvent, QueueStarted
from tester.queue.view import QueueView, view_of
from tester.service.commands import QueueAdd, QueueDrop, QueueMove, QueueSkip, QueueStand, QueueStart
from tester.tui.pages.queue_page import QueuePage, cells
from tests.tester.queue.made import UTC, item, queue_of
from tests.tester.tui.stage import Stage, play

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
