"""The words of the notice of an item's end."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tester.queue.events import ItemAdded, ItemBegan, ItemTaken, QueueStarted
from tester.queue.fold import Queue
from tester.service.item_notice import EMPTY, HOLDS, LOOK, item_end
from tester.service.notifier import ItemEnd
from tests.tester.queue.made import item, queue_of
from tests.tester.service.test_notifier import RUN

BEGUN = (QueueStarted("A"), ItemTaken(1), ItemBegan(1, "night-1"))


def _ended(queue: Queue, outcome: str, *, reason: str = "", latched: bool = False) -> ItemEnd | None:
    return item_end(queue, replace(RUN, outcome=outcome, reason=reason), latched=latched)


@pytest.mark.parametrize("outcome", ["done", "incomplete"])
def test_after_done_and_short_the_next_item_is_named(outcome: str) -> None:
    found = _ended(queue_of(ItemAdded(item(1)), ItemAdded(item(2)), *BEGUN), outcome)
    assert found is not None and found.follows == "item 2 begins once the rig is checked"


def test_after_the_last_item_nothing_begins() -> None:
    found = _ended(queue_of(ItemAdded(item(1)), *BEGUN), "done")
    assert found is not None and found.follows == EMPTY and "tester show night-1" in found.todo


@pytest.mark.parametrize(
    ("outcome", "latched"), [("tripped", True), ("failed", False), ("stopped", False), ("done", True)]
)
def test_after_any_other_end_a_person_is_needed(outcome: str, latched: bool) -> None:
    found = _ended(queue_of(ItemAdded(item(1)), ItemAdded(item(2)), *BEGUN), outcome, latched=latched)
    assert found is not None and (found.follows, found.todo) == (HOLDS, LOOK)


def test_the_item_is_named_with_its_end_and_the_reason() -> None:
    found = _ended(queue_of(ItemAdded(item(1)), *BEGUN), "tripped", reason="overload", latched=True)
    assert found is not None and found.item == "item 1 of the queue, recipe 1: tripped: overload"


def test_a_run_that_a_person_began_is_no_item() -> None:
    assert _ended(queue_of(ItemAdded(item(1)), *BEGUN[:1]), "done") is None
