"""The campaign of the queue finds faults that are planted in the queue."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from tester.queue import fold
from tester.queue.decide import Evidence, Look, StartItem, Wait, decide
from tester.queue.events import ItemMoved
from tester.queue.fold import Queue
from tests.campaigns.queue_life import Life

LIVES = 12
"""Maximum number of lives to find a planted fault."""


def misses(folder: Path, lives: int = LIVES) -> list[str]:
    """Return the misses of the first life that has some."""
    for seed in range(lives):
        life = Life(folder / str(seed), Random(seed))
        life.live()
        if life.misses:
            return life.misses
    return []


def test_lives_without_a_fault_miss_nothing(tmp_path: Path) -> None:
    assert misses(tmp_path, 4) == []


def test_a_queue_that_needs_no_evidence_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def careless(queue: Queue, evidence: Evidence | None, now_utc: str) -> StartItem | Wait | Look:
        verdict = decide(queue, evidence, now_utc)
        return StartItem(queue.next.item.id) if isinstance(verdict, Look) and queue.next is not None else verdict

    monkeypatch.setattr("tester.service.queue_desk.decide", careless)
    assert any("without evidence" in miss for miss in misses(tmp_path))


def test_a_queue_that_goes_on_after_a_restart_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tester.service.queue_desk.recovery", lambda *_: iter(()))
    assert misses(tmp_path)


def test_a_move_that_loses_its_item_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def losing(queue: Queue, what: ItemMoved, _utc: str) -> Queue:
        return replace(queue, entries=tuple(entry for entry in queue.entries if entry.item.id != what.id))

    monkeypatch.setitem(fold._CHANGES, ItemMoved, losing)
    assert any("lost" in miss for miss in misses(tmp_path))
