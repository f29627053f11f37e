"""A run's tables as one workbook, a sheet each; XlsxWriter comes with the extra ``xlsx``.

A text is a text cell: it never becomes a formula, a link or a number. One that begins like a formula has the sheet's
"quote prefix" as well, so that it stays a text when a person edits the cell. The bytes depend on the run alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import datetime
from importlib import import_module
from typing import Any, BinaryIO, Final

from tester.base.plugins import MissingExtraError, needs
from tester.base.words import harmless
from tester.results.table_cells import Cell, Number, begins_like_a_formula, number

LONGEST: Final = 32_767
"""Most characters of a cell (Microsoft, "Excel specifications and limits")."""
_AS_TEXT: Final = {"strings_to_formulas": False, "strings_to_urls": False, "strings_to_numbers": False}
_NO_MOMENT: Final = "2000-01-01T00:00:00"
"""Date of a workbook whose run has no readable start."""

Sheet = tuple[str, Iterable[Sequence[Cell]]]
"""Name, of at most 31 characters, and the rows; the first holds the headings."""


def write_workbook(sheets: Iterable[Sheet], started_utc: str, file: BinaryIO) -> None:
    """Write ``sheets`` to ``file``; the workbook is dated ``started_utc`` (ISO 8601).

    Raises OSError, and MissingExtraError without XlsxWriter.
    """
    try:
        library: Any = import_module("xlsxwriter")
    except ModuleNotFoundError as error:
        raise MissingExtraError(needs("the format xlsx", "XlsxWriter", "xlsx")) from error
    book = library.Workbook(file, {**_AS_TEXT, "in_memory": True})
    book.set_properties({"created": _moment(started_utc)})
    head, quoted = book.add_format({"bold": True, "bottom": 1}), book.add_format({"quote_prefix": True})
    for name, rows in sheets:
        sheet = book.add_worksheet(name)
        for down, row in enumerate(rows):
            for across, cell in enumerate(row):
                _write(sheet, down, across, cell, head if down == 0 else None, quoted)
        sheet.freeze_panes(1, 0)
        sheet.autofit(300)
    book.close()


def _write(sheet: Any, down: int, across: int, cell: Cell, form: Any, quoted: Any) -> None:
    """Write one cell: a number as a number, no value as an empty cell, any other text as text."""
    if isinstance(cell, str) and not isinstance(cell, Number):
        text = harmless(cell)
        text = text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"
        sheet.write_string(down, across, text, quoted if form is None and begins_like_a_formula(text) else form)
    elif written := cell if isinstance(cell, Number) else number(cell):  # the digits of the CSV file
        sheet.write_number(down, across, float(written), form)


def _moment(utc: str) -> datetime:
    try:
        return datetime.fromisoformat(utc).replace(tzinfo=None)
    except ValueError:
        return datetime.fromisoformat(_NO_MOMENT)
