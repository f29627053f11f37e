"""A record in a format, as bytes."""

from __future__ import annotations

from io import BytesIO

from tester.results.formats import FORMATS, Record
from tester.store.run_reader import RunReader


def made(kind: str, reader: RunReader, decimals: int = 2) -> bytes:
    """Return a record in a format."""
    file = BytesIO()
    FORMATS[kind].write(Record(reader, decimals), file)
    return file.getvalue()


def unescaped(cell: str) -> str:
    """Return the original of an escaped text cell, as far as it was harmless."""
    return cell[1:] if cell[:1] == "'" else cell
