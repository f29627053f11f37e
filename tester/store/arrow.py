"""Samples as an Arrow table; pyarrow (extra ``parquet``) is loaded only here, and by Parquet's export."""

from __future__ import annotations

from importlib import import_module
from typing import Protocol, cast

from tester.base.plugins import MissingExtraError, needs
from tester.store.run_reader import RunReader


class ArrowTable(Protocol):
    """The used part of a ``pyarrow.Table``, which has no type information."""

    @property
    def num_rows(self) -> int:
        """Return the number of rows."""
        ...

    @property
    def column_names(self) -> list[str]:
        """Return the names of the columns."""
        ...


class _Arrow(Protocol):
    def table(self, data: object) -> ArrowTable: ...


def sample_table(
    reader: RunReader, condition: int | None = None, repeat: int | None = None, attempt: int | None = None
) -> ArrowTable:
    """Return samples as a ``pyarrow.Table`` of float64, selected as in ``RunReader.samples``.

    Raises StoreError, and MissingExtraError without pyarrow.
    """
    return cast(_Arrow, arrow_module("pyarrow", "a table of samples")).table(
        reader.samples(condition, repeat, attempt)
    )


def arrow_module(name: str, what: str) -> object:
    """Return pyarrow or a module of it; raises MissingExtraError, with ``what`` as the reason, where it is not
    installed."""
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        raise MissingExtraError(needs(what, "pyarrow", "parquet")) from error
