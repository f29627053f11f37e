"""Predicted times of items: sums, and intervals that grow as independent deviations do."""

from __future__ import annotations

from datetime import datetime, timedelta
from math import sqrt
from random import Random

import pytest

from tester.queue.events import ItemAdded, ItemSkipped, QueueStarted
from tester.queue.items import PersonAsk
from tester.queue.predict import BETWEEN_S, SHARED, PlannedItem, planned, predicted
from tester.queue.view import next_ask, view_of
from tests.tester.queue.made import UTC, item, queue_of


def of(count: int, share: float = 0.2) -> list[PlannedItem]:
    return [PlannedItem(number, item(number, share=share).needs) for number in range(1, count + 1)]


def test_items_follow_one_another() -> None:
    times = predicted(of(3))
    assert [one.start_s for one in times] == [0.0, 3600.0 + BETWEEN_S, 7200.0 + 2 * BETWEEN_S]
    assert times[-1].end_s == 3 * 3600.0 + 2 * BETWEEN_S


def test_one_item_has_the_range_of_its_estimate() -> None:
    (one,) = predicted(of(1))
    assert (one.low_s, one.high_s) == pytest.approx((0.8 * 3600.0, 1.2 * 3600.0))


def test_a_skewed_item_has_the_range_of_its_estimate_around_a_later_mean() -> None:
    needs = item(1).needs.__class__(1000.0, 900.0, 1400.0, 1, 1)
    (one,) = predicted([PlannedItem(1, needs)])
    assert (one.low_s, one.high_s) == pytest.approx((900.0, 1400.0))
    assert one.end_s == pytest.approx(1030.0)


def test_half_ranges_add_up_as_squares_except_for_common_errors_of_items() -> None:
    last = predicted(of(9))[-1]
    expected = sqrt(9 * 0.2**2 + 9 * 8 * SHARED**2) * 3600.0
    assert last.high_s - last.end_s == pytest.approx(expected)


def test_items_of_an_exact_duration_have_nothing_in_common() -> None:
    last = predicted(of(9, share=0.0))[-1]
    assert last.low_s == last.end_s == last.high_s


def test_the_rest_of_the_item_under_way_has_its_share_of_the_range() -> None:
    (one,) = predicted([PlannedItem(1, item(1, share=0.2).needs, left_s=900.0)])
    assert (one.end_s, one.high_s) == pytest.approx((900.0, 900.0 + 0.25 * 0.2 * 3600.0))


def test_a_skipped_item_takes_no_time() -> None:
    queue = queue_of(ItemAdded(item(1)), ItemAdded(item(2)), ItemSkipped(1, "anna"))
    assert [one.id for one in planned(queue)] == [2]
    view = view_of(queue, "standing", UTC)
    assert [bool(one.start_utc) for one in view.items] == [False, True]


def test_deviations_that_are_common_in_part_end_inside_the_interval_in_95_per_cent() -> None:
    random, inside = Random(7), 0
    last = predicted(of(12))[-1]
    own_s, common_s = 3600.0 * sqrt(0.2**2 - SHARED**2) / 1.96, 3600.0 * SHARED / 1.96
    for _ in range(2000):
        mean_s = random.gauss(3600.0, common_s)
        total = sum(random.gauss(mean_s, own_s) for _ in range(12)) + 11 * BETWEEN_S
        inside += last.low_s <= total <= last.high_s
    assert inside / 2000 == pytest.approx(0.95, abs=4 * sqrt(0.05 * 0.95 / 2000))


def test_the_next_question_is_that_of_the_first_item_that_asks() -> None:
    asks = (PersonAsk(600.0, "wheel 3: 1#"),)
    items = [ItemAdded(item(1)), ItemAdded(item(2, asks=asks)), ItemAdded(item(3, asks=asks))]
    going = view_of(queue_of(*items, QueueStarted("anna")), "item 1 is next", UTC)
    expected = datetime.fromisoformat(going.items[1].start_utc) + timedelta(minutes=10)
    found = next_ask(going)
    assert found is not None
    assert (datetime.fromisoformat(found[0]), found[1]) == (expected, "item 2, recipe 2: wheel 3: 1#")


def test_a_stopped_queue_with_items_needs_a_person_now() -> None:
    standing = view_of(queue_of(ItemAdded(item(1))), "standing: not started yet", UTC)
    assert next_ask(standing) == (UTC, "the queue waits for a person: standing: not started yet")


def test_an_empty_queue_needs_no_person() -> None:
    assert next_ask(view_of(queue_of(), "standing: not started yet", UTC)) is None
