"""The check of a night: how long the queue runs alone, who is needed when, and a better order."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from time import process_time

import pytest

from tester.queue.check import NightCheck, following, night_check, window
from tester.queue.events import ItemAdded, QueueStarted
from tester.queue.items import PersonAsk, QueueItem
from tester.queue.view import view_of
from tests.tester.queue.made import item, queue_of

NOW = "2024-02-21T17:00:00Z"
START = datetime(2024, 2, 21, 18, tzinfo=UTC)
HOUR = 3600.0
WHEEL = PersonAsk(0.0, "wheel 1: 1#")


def checked(*items: QueueItem, going: bool = False) -> NightCheck:
    queue = queue_of(*(ItemAdded(one) for one in items), *([QueueStarted("anna")] if going else []))
    return night_check(view_of(queue, "standing: not started yet", NOW), NOW, START, START + timedelta(hours=14))


def at(text: str) -> datetime:
    return datetime.fromisoformat(text)


def test_a_queue_without_questions_runs_alone_to_its_end() -> None:
    found = checked(item(1, seconds=2 * HOUR), item(2, seconds=2 * HOUR))
    assert at(found.alone_until_utc) == START + timedelta(hours=4, seconds=3)
    assert (found.because, found.covered, found.needed) == ("the queue is at its end", False, ())
    assert at(found.alone_low_utc) < at(found.alone_until_utc) < at(found.alone_high_utc)


def test_the_first_question_after_the_start_ends_the_time_alone() -> None:
    found = checked(item(1, seconds=2 * HOUR, asks=(WHEEL,)), item(2, seconds=HOUR, asks=(WHEEL,)))
    assert at(found.alone_until_utc) == START + timedelta(hours=2, seconds=3)
    assert found.because == "item 2 (recipe 2) asks: wheel 1: 1#"
    assert [one.item for one in found.needed] == [1, 2]


def test_a_queue_that_is_longer_than_the_window_covers_it() -> None:
    assert checked(item(1, seconds=15 * HOUR, asks=(WHEEL,))).covered


def test_a_queue_that_goes_counts_from_now() -> None:
    assert at(checked(item(1, seconds=2 * HOUR), going=True).alone_until_utc) == START + timedelta(hours=1)


def test_an_order_that_runs_longer_is_offered() -> None:
    found = checked(
        item(1, seconds=HOUR, asks=(WHEEL,)), item(2, seconds=HOUR, asks=(WHEEL,)), item(3, seconds=6 * HOUR)
    )
    assert found.better is not None
    assert (found.better.order, found.better.moves) == ((1, 3, 2), ((3, 2),))
    assert at(found.better.alone_until_utc) == START + timedelta(hours=7, seconds=6)


def test_an_order_that_gains_nothing_is_not_offered() -> None:
    assert checked(item(1, seconds=HOUR, asks=(WHEEL,)), item(2, seconds=HOUR, asks=(WHEEL,))).better is None


def test_an_empty_queue_covers_nothing() -> None:
    found = checked()
    assert (found.covered, found.because) == (False, "the queue is empty")


def test_twenty_items_take_a_fraction_of_two_seconds() -> None:
    items = [
        item(number, seconds=(1 + number % 5) * HOUR, asks=(WHEEL, PersonAsk(1800.0, "look")) if number % 3 else ())
        for number in range(1, 21)
    ]
    began_s = process_time()
    assert checked(*items).better is not None
    assert process_time() - began_s < 1.0


@pytest.mark.parametrize(
    ("now", "begins", "ends"),
    [
        ("2024-02-21T17:00", "2024-02-21T18:00", "2024-02-22T08:00"),
        ("2024-02-21T19:00", "2024-02-21T18:00", "2024-02-22T08:00"),
        ("2024-02-22T07:00", "2024-02-21T18:00", "2024-02-22T08:00"),
        ("2024-02-22T08:00", "2024-02-22T18:00", "2024-02-23T08:00"),
    ],
)
def test_the_window_is_the_present_or_the_next_one(now: str, begins: str, ends: str) -> None:
    found = window("18:00", "08:00", datetime.fromisoformat(now).astimezone().isoformat())
    assert [moment.strftime("%Y-%m-%dT%H:%M") for moment in found] == [begins, ends]


def test_a_window_in_the_past_is_that_of_tomorrow() -> None:
    found = window("08:00", "09:00", datetime.fromisoformat("2024-02-21T10:00").astimezone().isoformat())
    assert found[0].strftime("%d %H:%M") == "22 08:00"


@pytest.mark.parametrize("text", ["25:00", "noon", "", "8"])
def test_another_text_is_no_time_of_day(text: str) -> None:
    with pytest.raises(ValueError, match="expected a time of day such as 18:00"):
        window(text, "08:00", NOW)


def test_with_a_time_limit_the_queue_runs_alone_until_the_last_item_that_begins() -> None:
    until = (datetime.fromisoformat(NOW) + timedelta(hours=4)).isoformat()
    items = [ItemAdded(item(number, seconds=1.5 * HOUR)) for number in (1, 2, 3)]
    view = view_of(queue_of(*items, QueueStarted("anna", until)), "item 1 is next", NOW)
    assert [bool(one.end_utc) for one in view.items] == [True, True, False]
    assert view.end_utc == view.items[1].end_utc
    found = night_check(view, NOW, datetime.fromisoformat(NOW), START + timedelta(hours=14))
    assert at(found.alone_until_utc) == datetime.fromisoformat(NOW) + timedelta(hours=3, seconds=3)
    assert found.because.startswith("item 3 may last beyond ")
    assert (found.covered, found.better) == (False, None)


@pytest.mark.parametrize(("now", "expected"), [("17:00", "18:00"), ("18:00", "18:00")])
def test_the_next_time_of_day_is_never_now(now: str, expected: str) -> None:
    here = datetime.fromisoformat(f"2024-02-21T{now}:00").astimezone()
    found = datetime.fromisoformat(following(expected, here.isoformat()))
    assert found == here + (timedelta(hours=1) if now != expected else timedelta(days=1))
