"""The fold: the state after each end, refusals, and no duplicate or lost item, over all short histories."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import pytest

from tester.queue.events import (
    ItemAdded,
    ItemBegan,
    ItemDropped,
    ItemEnded,
    ItemMoved,
    ItemReturned,
    ItemSkipped,
    ItemTaken,
    QueueEvent,
    QueueStarted,
    QueueStood,
)
from tester.queue.fold import MOST_COPIES, MOST_WAITING, Queue, QueueError, check_revision
from tester.queue.items import End, ItemState
from tests.tester.queue.made import UTC, item, queue_of

TWO = (ItemAdded(item(1)), ItemAdded(item(2)))
RUNS = (*TWO, QueueStarted("anna"), ItemTaken(1), ItemBegan(1, "run-1"))
DEPTH = 6
"""Length of the histories after two items are added."""


def numbers(queue: Queue) -> list[int]:
    return [entry.item.id for entry in queue.listed]


@pytest.mark.parametrize(
    ("end", "stands", "goes"),
    [
        (End.DONE, False, True),
        (End.SHORT, False, True),
        (End.FAILED, False, False),
        (End.STOPPED, False, False),
        (End.TRIPPED, False, False),
        (End.DONE, True, False),
        (End.SHORT, True, False),
    ],
)
def test_the_queue_continues_after_done_and_short_only(end: End, stands: bool, goes: bool) -> None:
    queue = queue_of(*RUNS, ItemEnded(1, end, "why", "run-1", stands))
    assert queue.going is goes
    assert bool(queue.why) is not goes


def test_an_item_may_let_the_queue_continue_after_a_failure() -> None:
    events = (ItemAdded(item(1, after=(End.FAILED,))), *RUNS[1:])
    assert queue_of(*events, ItemEnded(1, End.FAILED, "", "run-1")).going
    assert not queue_of(*events, ItemEnded(1, End.DONE, "", "run-1")).going


@pytest.mark.parametrize("end", [End.TRIPPED, End.STOPPED])
def test_no_item_may_follow_a_trip_or_a_stop(end: End) -> None:
    with pytest.raises(QueueError, match=f"after {end} the queue always stands"):
        queue_of(ItemAdded(item(1, after=(End.DONE, end))))


def test_a_skipped_run_lets_the_queue_continue_after_its_stop() -> None:
    queue = queue_of(*RUNS, ItemSkipped(1, "anna"), ItemEnded(1, End.STOPPED, "skipped by anna", "run-1"))
    assert queue.going


@pytest.mark.parametrize(("end", "stands"), [(End.TRIPPED, False), (End.STOPPED, True)])
def test_a_skipped_run_that_ends_badly_stops_the_queue(end: End, stands: bool) -> None:
    assert not queue_of(*RUNS, ItemSkipped(1, "anna"), ItemEnded(1, end, "it tripped", "run-1", stands)).going


def test_an_item_that_could_not_begin_waits_again_at_its_place() -> None:
    queue = queue_of(*TWO, QueueStarted("anna"), ItemTaken(1), ItemReturned(1, "the guard is open"))
    assert (numbers(queue), queue.going, queue.entry(1).state) == ([1, 2], False, ItemState.WAITING)
    assert queue.why == "item 1 did not begin: the guard is open"


def test_a_moved_item_that_was_skipped_waits_again() -> None:
    queue = queue_of(*TWO, ItemSkipped(1, "anna"), ItemMoved(1, 0, "anna"))
    assert (numbers(queue), queue.entry(1).state) == ([2, 1], ItemState.WAITING)


@pytest.mark.parametrize(
    ("event", "reason"),
    [
        (ItemMoved(1, 2, "anna"), "item 1 is running: it cannot be moved"),
        (ItemMoved(2, 1, "anna"), "item 1 is running: it cannot be an item's place"),
        (ItemMoved(2, 2, "anna"), "item 2 cannot go before itself"),
        (ItemMoved(7, 0, "anna"), "no item 7: it lists 1, 2"),
        (ItemDropped(1, "anna"), "item 1 is running: it cannot be dropped"),
        (ItemTaken(2), "item 1 is under way"),
        (ItemBegan(1, "run-2"), "item 1 is running"),
        (ItemEnded(2, End.DONE, "", ""), "item 2 is waiting: it cannot end now"),
        (ItemAdded(item(2)), "the next item is number 3, not 2"),
        (ItemAdded(item(4)), "the next item is number 3, not 4"),
        (QueueStarted("anna"), "started already"),
        (QueueStood(""), "only with a reason"),
    ],
)
def test_an_impossible_change_is_refused_with_its_reason(event: QueueEvent, reason: str) -> None:
    with pytest.raises(QueueError, match=reason):
        queue_of(event, start=queue_of(*RUNS))


def test_after_the_last_item_the_queue_is_stopped_and_an_added_item_does_not_begin() -> None:
    queue = queue_of(ItemAdded(item(1)), *RUNS[2:], ItemEnded(1, End.DONE, "", "run-1"), ItemAdded(item(2)))
    assert (queue.going, queue.why) == (False, "it came to its end")


def test_a_queue_in_which_no_item_waits_is_not_started() -> None:
    with pytest.raises(QueueError, match="no item waits"):
        queue_of(*TWO, ItemSkipped(1, "anna"), ItemSkipped(2, "anna"), QueueStarted("anna"))


def test_nothing_is_taken_while_the_queue_is_stopped() -> None:
    with pytest.raises(QueueError, match="the queue stands: not started yet"):
        queue_of(*TWO, ItemTaken(1))


def test_a_change_for_an_older_revision_is_refused() -> None:
    queue = queue_of(*TWO)
    check_revision(queue, 2)
    with pytest.raises(QueueError, match="revision 2, not 1"):
        check_revision(queue, 1)


def test_the_queue_holds_at_most_so_many_items() -> None:
    queue = queue_of(*(ItemAdded(item(number)) for number in range(1, MOST_WAITING + 1)))
    with pytest.raises(QueueError, match="the queue is full"):
        queue_of(ItemAdded(item(MOST_WAITING + 1)), start=queue)


def changes(queue: Queue) -> list[QueueEvent]:
    """Return changes to try, possible or not."""
    tried: list[QueueEvent] = [QueueStarted("anna"), QueueStood("stood"), ItemAdded(item(queue.next_id))]
    for number in (1, 2):
        tried += [ItemMoved(number, 0, "anna"), ItemMoved(number, 3 - number, "anna"), ItemSkipped(number, "anna"),
                  ItemDropped(number, "anna"), ItemTaken(number), ItemBegan(number, f"run-{number}"),
                  ItemReturned(number, "why"), ItemEnded(number, End.DONE, "", ""),
                  ItemEnded(number, End.TRIPPED, "", "")]  # fmt: skip
    return tried


def test_in_every_short_history_no_item_is_twice_or_lost_or_starts_by_itself() -> None:
    seen = 0
    open_queues = [(queue_of(*TWO), Counter[int](), 2)]
    for _ in range(DEPTH):
        following: dict[tuple[object, ...], tuple[Queue, Counter[int], int]] = {}
        for queue, taken, added in open_queues:
            for event in changes(queue):
                try:
                    after = queue_of(event, start=queue)
                except QueueError:
                    continue
                seen += 1
                count = added + isinstance(event, ItemAdded)
                begun = taken + Counter([event.id] if isinstance(event, ItemTaken) else [])
                begun.subtract([event.id] if isinstance(event, ItemReturned) else [])
                assert sorted(entry.item.id for entry in after.entries) == list(range(1, count + 1))
                assert all(times <= 1 for times in begun.values())
                assert sum(entry.state.under_way for entry in after.entries) <= 1
                assert after.going or after.why
                assert after.going <= (queue.going or isinstance(event, QueueStarted))
                key = (after.entries, after.going, tuple(sorted(begun.items())))
                following[key] = (after, begun, count)
        open_queues = list(following.values())
    assert seen > 5_000


def test_copies_are_items_of_their_own_with_the_next_seeds() -> None:
    queue = queue_of(ItemAdded(item(1)), ItemAdded(replace(item(2, name="cold"), seed=7), copies=3), ItemAdded(item(5)))
    copies = [(one.item.id, one.item.name, one.item.seed) for one in queue.listed[1:4]]
    assert copies == [(2, "cold (1 of 3)", 7), (3, "cold (2 of 3)", 8), (4, "cold (3 of 3)", 9)]


def test_copies_of_a_real_rig_keep_their_seed() -> None:
    queue = queue_of(ItemAdded(replace(item(1), simulated=False), copies=2))
    assert [one.item.seed for one in queue.listed] == [0, 0]


@pytest.mark.parametrize("copies", [0, MOST_COPIES + 1])
def test_a_wrong_number_of_copies_is_refused(copies: int) -> None:
    with pytest.raises(QueueError, match="expected 1 to 50"):
        queue_of(ItemAdded(item(1), copies=copies))


def test_copies_beyond_the_queue_are_refused_together() -> None:
    full = queue_of(*(ItemAdded(item(number)) for number in range(1, MOST_WAITING)))
    with pytest.raises(QueueError, match="the queue is full"):
        queue_of(ItemAdded(item(MOST_WAITING), copies=2), start=full)


def test_a_time_limit_ends_when_the_queue_stops() -> None:
    going = queue_of(*TWO, QueueStarted("anna", UTC))
    assert going.until_utc == UTC
    stands = queue_of(QueueStood("enough"), start=going)
    assert stands.until_utc == ""
    assert queue_of(QueueStarted("anna"), start=stands).until_utc == ""
