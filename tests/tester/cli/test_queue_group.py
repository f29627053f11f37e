"""`tester queue` with a service played by a test, and on a stored queue without a service."""

from __future__ import annotations

import json
from datetime import datetime
from pathlib import Path

import pytest
from click.testing import CliRunner

from tester.cli.queue_group import add, check, key, list_
from tester.queue.calendar import key_valid
from tester.queue.events import ItemAdded
from tester.queue.places import queue_folder
from tester.queue.record import QueueRecord
from tests.tester.queue.made import item

RIG = "simulated rubber friction tester"


@pytest.fixture
def stored(tmp_path: Path) -> list[str]:
    """Return the options for a stored queue of two items without a service."""
    runs = tmp_path / "runs"
    with QueueRecord(queue_folder(runs, RIG, simulated=True)) as record:
        record.append(ItemAdded(item(1, name="first")))
        record.append(ItemAdded(item(2, name="second")))
    return ["--out", str(runs), "--connect", f"unix:{tmp_path / 'none.sock'}"]


def test_without_a_service_the_list_is_that_of_the_record(stored: list[str]) -> None:
    done = CliRunner().invoke(list_, [*stored, "--json"])
    view = json.loads(done.output)
    assert [(one["id"], one["name"], one["state"]) for one in view["items"]] == [
        (1, "first", "waiting"), (2, "second", "waiting")
    ]  # fmt: skip
    assert view["state"].startswith("standing: no service is running")


def test_the_list_in_words_has_a_line_for_each_item(stored: list[str]) -> None:
    lines = CliRunner().invoke(list_, stored).output.splitlines()
    assert [line.split()[:3] for line in lines[1:3]] == [["1", "waiting", "first,"], ["2", "waiting", "second,"]]
    assert lines[-1].startswith("end ") and "if it starts now" in lines[-1]


def test_a_queue_that_ends_before_the_window_does_exits_with_1(
    stored: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    evening = datetime(2026, 7, 27, 17).astimezone().isoformat()  # in the last hours of the window it would fill it
    monkeypatch.setattr("tester.base.clock.utc_now", lambda: evening)
    done = CliRunner().invoke(check, [*stored, "--from", "18:00", "--to", "08:00"], standalone_mode=False)
    assert done.return_value == 1
    assert "the queue is at its end" in done.output and "does not fill the window alone" in done.output


def test_the_check_as_json_has_the_interval_of_the_end(stored: list[str]) -> None:
    found = json.loads(CliRunner().invoke(check, [*stored, "--json"]).output)
    assert found["alone_low_utc"] < found["alone_until_utc"] < found["alone_high_utc"]


def test_a_wrong_time_of_day_is_a_usage_error(stored: list[str]) -> None:
    done = CliRunner().invoke(check, [*stored, "--from", "25:00"])
    assert done.exit_code == 2 and "expected a time of day such as 18:00" in done.output


def test_adding_needs_a_service(stored: list[str]) -> None:
    done = CliRunner().invoke(add, ["quickstart", *stored[2:]], standalone_mode=False)
    assert done.return_value == 4 and "no service is running" in done.output


def test_another_end_is_a_usage_error(stored: list[str]) -> None:
    done = CliRunner().invoke(add, ["quickstart", "--after", "tripped", *stored[2:]])
    assert done.exit_code == 2 and '"tripped" is no end after which a queue continues' in done.output


def test_a_key_is_shown_once_listed_without_itself_and_revoked(tmp_path: Path) -> None:
    out = ["--out", str(tmp_path)]
    made = CliRunner().invoke(key, ["phone", *out]).output.strip().partition("key=")[2]
    assert key_valid(tmp_path, made)
    listed = CliRunner().invoke(key, ["--list", *out]).output
    assert listed.startswith("1  phone, made") and made not in listed
    CliRunner().invoke(key, ["--revoke", "1", *out])
    assert not key_valid(tmp_path, made)
