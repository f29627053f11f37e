"""The table of planned and actual steps reads a stored run."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest

from tests.campaigns.seeds.steps import took


@pytest.fixture
def run(tmp_path: Path) -> Path:
    store = sqlite3.connect(tmp_path / "run.db")
    store.executescript(
        """
        CREATE TABLE event (sequence INTEGER, t_s REAL, kind TEXT, text TEXT);
        CREATE TABLE repeat (id INTEGER, begun_s REAL);
        CREATE TABLE burst (repeat_id INTEGER, started_s REAL, ended_s REAL);
        INSERT INTO event VALUES
            (1, 4.0, 'step', 'heat'), (2, 104.0, 'step', 'a condition'), (3, 304.0, 'mode', 'run -> stopping: end'),
            (4, 900.0, 'step', 'heat again'), (5, 950.0, 'mode', 'run -> stopping: finished');
        INSERT INTO repeat VALUES (1, 165.0), (2, 200.0);
        INSERT INTO burst VALUES (1, 170.0, 180.0), (1, 182.0, 190.0), (2, 210.0, 225.0);
        """
    )
    store.close()
    return tmp_path


def test_a_step_ends_with_the_next_or_with_its_part(run: Path) -> None:
    assert [(one.title, one.seconds) for one in took(run)] == [
        ("heat", 100.0),
        ("a condition", 200.0),
        ("heat again", 50.0),
    ]


def test_a_condition_is_taken_apart(run: Path) -> None:
    condition = took(run)[1]
    assert (condition.repeats, condition.soak_s, condition.sliding_s) == (2, 61.0, 33.0)
    assert condition.between_s == pytest.approx(200.0 - 61.0 - 33.0)
