"""Notes and tags of people on a run: rows of its journal, which may be added after its end as well.

A tag is added with a note or alone; a tag with a minus before it takes an earlier one back.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, cast

from tester.base.words import plain_text
from tester.store.amend import amended
from tester.store.journal_records import StoredEvent
from tester.store.run_reader import RunReader
from tester.store.sql import columns_in, insert

NOTE: Final = "note"
"""Kind of the events."""
LONGEST, LONGEST_TAG, MOST_TAGS = 2000, 40, 20
"""Most characters of a note and of a tag; most tags added at once."""
_TAG = re.compile(r"-?[^\s,;-][^\s,;]*")


@dataclass(frozen=True, slots=True)
class RunNote:
    """A note: when, who, the text ("" where only tags changed), the tags added or, with a minus, taken back.

    ``manifest_before``: the folder's manifest before it, as an exclusion keeps it.
    """

    utc: str
    by: str
    text: str
    tags: tuple[str, ...] = ()
    manifest_before: str = ""


def checked(note: RunNote) -> RunNote:
    """Return a note with its tags once each. Raises ValueError for one that cannot be recorded."""
    if not (note.text or note.tags) or len(note.text) > LONGEST or len(note.tags) > MOST_TAGS:
        raise ValueError(f"expected a text of at most {LONGEST} characters, or at most {MOST_TAGS} tags")
    plain_text(note.text, "note")
    plain_text(note.by, "name")
    for tag in note.tags:
        plain_text(tag, "tag")
        if len(tag) > LONGEST_TAG or _TAG.fullmatch(tag) is None:
            raise ValueError(
                f'tag "{tag}": expected a word of at most {LONGEST_TAG} characters without comma or semicolon; a minus '
                "before it takes it back"
            )
    return RunNote(note.utc, note.by, note.text, tuple(dict.fromkeys(note.tags)), note.manifest_before)


def add_note(folder: Path, note: RunNote) -> None:
    """Add a note to the record in ``folder``; it is on disk when this returns. Raises StoreError, ValueError."""
    note = checked(note)
    with amended(folder) as database:
        last, t_s = database.execute("SELECT coalesce(max(sequence), 0), coalesce(max(t_s), 0.0) FROM event").fetchone()
        event = StoredEvent(last + 1, t_s, note.utc, NOTE, "info", words_of(note), data_of(note))
        database.execute(*insert("event", columns_in(event)))


def words_of(note: RunNote) -> str:
    """Return the text of a note's event."""
    return note.text or f"tags: {', '.join(note.tags)}"


def data_of(note: RunNote) -> str:
    """Return the data of a note's event, as JSON."""
    return json.dumps({"by": note.by, "tags": note.tags, "manifest_before": note.manifest_before}, ensure_ascii=False)


def notes_of(reader: RunReader) -> list[RunNote]:
    """Return a run's notes in order, those of its start too. Raises StoreError."""
    return [_of(event) for event in reader.events() if event.kind == NOTE]


def tags_of(reader: RunReader) -> list[str]:
    """Return the tags that a run has now, in the order in which they were added. Raises StoreError."""
    return tags_in(notes_of(reader))


def tags_in(notes: list[RunNote]) -> list[str]:
    """Return the tags that remain after some notes."""
    tags: dict[str, None] = {}
    for note in notes:
        for tag in note.tags:
            if tag.startswith("-"):
                tags.pop(tag[1:], None)
            else:
                tags[tag] = None
    return list(tags)


def _of(event: StoredEvent) -> RunNote:
    try:
        data = cast("dict[str, Any]", json.loads(event.data))
        tags = tuple(str(tag) for tag in data["tags"])
        by, before = str(data["by"]), str(data["manifest_before"])
    except (ValueError, TypeError, KeyError):  # a note of the run's start has no data
        return RunNote(event.utc, "", event.text)
    return RunNote(event.utc, by, "" if tags and event.text.startswith("tags: ") else event.text, tags, before)
