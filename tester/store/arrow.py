"""Samples as an Arrow table; pyarrow is loaded only here and for Parquet."""

from __future__ import annotations

from importlib import import_module
from typing import Protocol, cast

from tester.store.reader import RunReader


class ArrowTable(Protocol):
    """What is promised of a ``pyarrow.Table``, which has no type information."""

    @property
    def num_rows(self) -> int:
        """Rows."""
        ...

    @property
    def column_names(self) -> list[str]:
        """Names of the columns."""
        ...


class _Arrow(Protocol):
    def table(self, data: object) -> ArrowTable: ...


def sample_table(
    reader: RunReader, condition: int | None = None, repeat: int | None = None, attempt: int | None = None
) -> ArrowTable:
    """Return samples as a ``pyarrow.Table`` of float64, chosen as in ``RunReader.samples``; raises StoreError."""
    return cast(_Arrow, import_module("pyarrow")).table(reader.samples(condition, repeat, attempt))
