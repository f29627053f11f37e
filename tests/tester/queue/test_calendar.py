"""The calendar: its entries, hostile names, and its keys."""

from __future__ import annotations

import os
import stat
from dataclasses import replace
from pathlib import Path

import pytest

from tester.queue.calendar import KEYS, calendar_keys, calendar_text, key_valid, new_key, revoke_key
from tester.queue.events import ItemAdded, ItemSkipped, QueueStarted
from tester.queue.fold import QueueError
from tester.queue.view import QueueView, view_of
from tests.tester.queue.made import UTC, item, queue_of

LATER = "2024-02-21T18:10:00.000Z"


def view(*names: str, now: str = UTC) -> QueueView:
    items = [replace(item(number, name=name), operator="secret operator") for number, name in enumerate(names, 1)]
    return view_of(queue_of(*map(ItemAdded, items), QueueStarted("anna")), "item 1 is next", now)


def lines(text: str) -> list[str]:
    """Return the unfolded lines."""
    assert text.endswith("\r\n")
    return text.replace("\r\n ", "").split("\r\n")[:-1]


def field(text: str, name: str) -> list[str]:
    return [line.partition(":")[2] for line in lines(text) if line.startswith(f"{name}:")]


def test_an_item_is_an_event_with_its_predicted_times() -> None:
    text = calendar_text(view("night", "day"))
    assert field(text, "SUMMARY") == ["night", "day"]
    assert field(text, "DTSTART") == ["20240221T180000Z", "20240221T190003Z"]
    assert field(text, "DTEND") == ["20240221T190000Z", "20240221T200003Z"]


def test_it_holds_times_and_names_and_nothing_else() -> None:
    text = calendar_text(view("night"))
    assert "secret" not in text and "anna" not in text
    names = {line.partition(":")[0] for line in lines(text)}
    assert names == {"BEGIN", "END", "VERSION", "PRODID", "CALSCALE", "METHOD", "UID", "DTSTAMP", "SEQUENCE", "DTSTART",
                     "DTEND", "SUMMARY", "STATUS", "TRANSP"}  # fmt: skip


def test_a_later_prediction_keeps_the_uid_and_raises_the_sequence() -> None:
    first, second = calendar_text(view("night")), calendar_text(view("night", now=LATER))
    assert field(first, "UID") == field(second, "UID")
    assert int(field(first, "SEQUENCE")[0]) < int(field(second, "SEQUENCE")[0])


def test_skipped_items_are_left_out() -> None:
    queue = queue_of(ItemAdded(item(1)), ItemAdded(item(2)), ItemSkipped(1, "anna"))
    assert field(calendar_text(view_of(queue, "standing", UTC)), "SUMMARY") == ["recipe 2"]


@pytest.mark.parametrize(
    "name",
    [
        "a\r\nEND:VCALENDAR",
        "a\nATTACH:http://x",
        "semi;colon,comma\\back",
        "\u2028line",
        "ü" * 200,
        "\x00\x1b[2J",
        "🛞" * 60,
    ],
)
def test_a_hostile_name_stays_one_value(name: str) -> None:
    text = calendar_text(view(name))
    assert len(field(text, "SUMMARY")) == 1 and text.count("BEGIN:") == 2
    assert all(len(line.encode()) <= 75 for line in text.split("\r\n"))
    assert not any(character < " " for character in text.replace("\r\n", ""))


def test_a_key_is_valid_until_it_is_revoked(tmp_path: Path) -> None:
    first, second = new_key(tmp_path, "phone"), new_key(tmp_path, "wall")
    assert key_valid(tmp_path, first) and key_valid(tmp_path, second)
    revoke_key(tmp_path, 1)
    assert not key_valid(tmp_path, first) and key_valid(tmp_path, second)
    assert [(one.number, one.name, bool(one.revoked_utc)) for one in calendar_keys(tmp_path)] == [
        (1, "phone", True), (2, "wall", False)
    ]  # fmt: skip


def test_only_the_hash_of_a_key_is_kept_where_only_its_user_reads(tmp_path: Path) -> None:
    key = new_key(tmp_path, "phone")
    file = tmp_path / ".queue" / KEYS
    assert key not in file.read_text(encoding="utf-8")
    if os.name == "posix":
        assert stat.S_IMODE(file.stat().st_mode) == 0o600


@pytest.mark.parametrize("key", ["", "x", "ü", "a" * 10_000, "\udce4"])
def test_another_text_is_no_key(tmp_path: Path, key: str) -> None:
    assert not key_valid(tmp_path, key)
    new_key(tmp_path, "phone")
    assert not key_valid(tmp_path, key)


def test_a_damaged_file_makes_no_key_valid(tmp_path: Path) -> None:
    key = new_key(tmp_path, "phone")
    (tmp_path / ".queue" / KEYS).write_text("[{}]", encoding="utf-8")
    assert not key_valid(tmp_path, key)
    with pytest.raises(QueueError, match="cannot be read"):
        new_key(tmp_path, "again")


def test_a_key_that_is_revoked_or_unknown_cannot_be_revoked(tmp_path: Path) -> None:
    new_key(tmp_path, "phone")
    revoke_key(tmp_path, 1)
    for number in (1, 2):
        with pytest.raises(QueueError, match="there is no key"):
            revoke_key(tmp_path, number)
