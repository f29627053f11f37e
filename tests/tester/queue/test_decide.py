"""The next decision: nothing begins without all the evidence, and every wait has a reason."""

from __future__ import annotations

from datetime import datetime, timedelta
from itertools import product

import pytest

from tester.base.screen import Check
from tester.queue.decide import FRESH_S, NEEDED, PASSES, Evidence, Look, StartItem, Wait, decide
from tester.queue.events import ItemAdded, ItemBegan, ItemSkipped, ItemTaken, QueueEvent, QueueStarted, QueueStood
from tester.queue.fold import Queue
from tests.tester.queue.made import UTC, evidence_for, item, queue_of

GOING: tuple[QueueEvent, ...] = (ItemAdded(item(1)), ItemAdded(item(2)), QueueStarted("anna"))


def test_with_all_the_evidence_the_first_item_starts() -> None:
    queue = queue_of(*GOING)
    assert decide(queue, evidence_for(queue), UTC) == StartItem(1)


@pytest.mark.parametrize("name", NEEDED)
def test_without_one_check_nothing_starts(name: str) -> None:
    queue = queue_of(*GOING)
    assert decide(queue, evidence_for(queue, lacks=name), UTC) == Wait(
        f"item 1 does not begin: {name}: not known", name not in PASSES
    )


@pytest.mark.parametrize("name", NEEDED)
def test_with_one_check_that_fails_nothing_starts(name: str) -> None:
    queue = queue_of(*GOING)
    found = decide(queue, evidence_for(queue, fails=name), UTC)
    assert found == Wait(f"item 1 does not begin: {name}: as it must be", name not in PASSES)


def test_over_every_combination_of_known_checks_only_the_whole_set_starts() -> None:
    queue = queue_of(*GOING)
    for oks in product((True, False, None), repeat=len(NEEDED) - 4):
        checks = [Check(name, ok, "") for name, ok in zip(NEEDED, [*oks, True, True, True, True], strict=True)]
        found = decide(queue, Evidence(1, queue.revision, tuple(checks)), UTC)
        assert isinstance(found, StartItem) is all(ok is True for ok in oks)
        assert isinstance(found, StartItem) or (isinstance(found, Wait) and len(found.reason) > 20)


def test_a_further_check_that_fails_also_counts() -> None:
    queue = queue_of(*GOING)
    whole = evidence_for(queue)
    more = Evidence(1, queue.revision, (*whole.checks, Check("extractor", None, "")))
    assert decide(queue, more, UTC) == Wait("item 1 does not begin: extractor: not known", stands=True)


@pytest.mark.parametrize("age_s", [FRESH_S + 0.1, -1.0, float("nan")])
def test_old_evidence_is_collected_again(age_s: float) -> None:
    queue = queue_of(*GOING)
    assert isinstance(decide(queue, evidence_for(queue, age_s=age_s), UTC), Look)


def test_evidence_for_another_item_or_revision_is_none() -> None:
    queue = queue_of(*GOING)
    good = evidence_for(queue)
    for other in (None, Evidence(2, good.revision, good.checks), Evidence(1, good.revision - 1, good.checks)):
        assert decide(queue, other, UTC) == Look(1, "the rig is checked for item 1")


@pytest.mark.parametrize(
    ("events", "reason"),
    [
        ((), "standing: not started yet"),
        ((*GOING, QueueStood("the service was started anew")), "standing: the service was started anew"),
        ((*GOING, ItemTaken(1)), "item 1 begins"),
        ((*GOING, ItemTaken(1), ItemBegan(1, "run-1")), "item 1 runs"),
        ((*GOING, ItemSkipped(1, "a"), ItemSkipped(2, "a")), "standing: it came to its end"),
    ],
)
def test_the_queue_waits_with_a_reason(events: tuple[QueueEvent, ...], reason: str) -> None:
    queue = queue_of(*events)
    assert decide(queue, evidence_for(queue), UTC) == Wait(reason)


def test_an_empty_queue_waits() -> None:
    assert decide(Queue(), None, UTC) == Wait("standing: not started yet")


@pytest.mark.parametrize(("minutes", "begins"), [(66, False), (67, True)])
def test_no_item_begins_that_may_last_beyond_the_time_limit(minutes: int, begins: bool) -> None:
    until = (datetime.fromisoformat(UTC) + timedelta(minutes=minutes)).isoformat()
    queue = queue_of(ItemAdded(item(1, share=0.1)), QueueStarted("anna", until))  # 60 min, 66 at most
    found = decide(queue, evidence_for(queue), UTC)
    if begins:
        assert found == StartItem(1)
    else:
        assert isinstance(found, Wait) and found.stands
        assert found.reason.startswith("item 1 may last until ")


def test_beyond_the_time_limit_the_rig_is_not_even_looked_at() -> None:
    queue = queue_of(ItemAdded(item(1)), QueueStarted("anna", UTC))
    assert isinstance(decide(queue, None, UTC), Wait)
