"""A table of results on a terminal: headings in two lines, numbers at the right, flags behind a row or below it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from textwrap import wrap

import click
from rich.cells import cell_len

from tester.base.words import NONE, Json, finite
from tester.results.columns import R, Table


def shown(text: str) -> str:
    """Return a text with every character that could steer a terminal replaced."""
    return "".join(c if c.isprintable() else "�" for c in text)


def dump(value: Json) -> None:
    """Print JSON, indented."""
    click.echo(json.dumps(value, ensure_ascii=False, allow_nan=False, indent=1))


def fields(record: object, names: str, **instead: Json) -> dict[str, Json]:
    """Return some of a record's fields as JSON, by their names; ``instead``: values in place of fields."""
    values = {name: getattr(record, name) for name in names.split()}
    return {name: finite(value) if isinstance(value, float) else value for name, value in values.items()} | instead


WIDTH = 80
"""Columns of a terminal; remarks that do not fit get a line of their own."""
NAME_AT_MOST = 12
"""Cells of a row's name; what is longer is cut and ends in an ellipsis."""


def table_lines(table: Table[R], remarks: str, width: int = WIDTH) -> Iterator[str]:
    """Yield headings and rows; the first column names a row, the column ``remarks`` is behind it or below."""
    behind = table[remarks]
    columns = [column for column in table.columns if column.key != remarks]
    pads = [" " if any(column.mark_at(row) for row in table.rows) else "" for column in columns]
    heads = zip(*(_two_lines(column.narrow_head, column.unit) for column in columns), strict=True)
    lines = [[text + pad for text, pad in zip(head, pads, strict=True)] for head in heads]
    lines += [
        [_cut(shown(columns[0].text(row))),
         *(column.text(row) + ("" if column.mark_at(row) else pad)
           for column, pad in zip(columns[1:], pads[1:], strict=True))]
        for row in table.rows
    ]  # fmt: skip
    widths = [max(map(cell_len, cells)) for cells in zip(*lines, strict=True)]
    notes = ["", "", *(text if (text := shown(behind.text(row))) != NONE else "" for row in table.rows)]
    for line, note in zip(lines, notes, strict=True):
        yield from _line(line, widths, note, width)


def plain_lines(table: Table[R]) -> Iterator[str]:
    """Yield headings and rows, words at the left and numbers at the right."""
    texts = [tuple(column.head for column in table.columns), *table.texts()]
    lines = [[shown(text) for text in cells] for cells in texts]
    widths = [max(map(cell_len, column)) for column in zip(*lines, strict=True)]
    for cells in lines:
        padded: list[str] = []
        for column, text, width in zip(table.columns, cells, widths, strict=True):
            space = " " * (width - cell_len(text))
            padded.append(space + text if column.numeric else text + space)
        yield "  ".join(padded).rstrip()


def _two_lines(head: str, unit: str) -> tuple[str, str]:
    """Return a heading in two lines: its unit in the second; without a unit, half of its words in each."""
    name = head.removesuffix(f"({unit})").removesuffix(unit).rstrip()
    if name != head:
        return name, unit
    words = head.split()
    return " ".join(words[: len(words) - len(words) // 2]), " ".join(words[len(words) - len(words) // 2 :])


def _line(cells: Sequence[str], widths: Sequence[int], remarks: str, width: int) -> Iterator[str]:
    """Yield a row: the name at the left, numbers at the right, remarks behind them or below."""
    room = [" " * (wide - cell_len(cell)) for cell, wide in zip(cells, widths, strict=True)]
    line = "  ".join([cells[0] + room[0], *(space + cell for space, cell in zip(room[1:], cells[1:], strict=True))])
    if not remarks or cell_len(line) + 2 + cell_len(remarks) <= width:
        yield f"{line}  {remarks}".rstrip()
        return
    yield line.rstrip()
    yield from wrap(remarks, width, initial_indent="    ", subsequent_indent="    ")


def _cut(name: str) -> str:
    """Return a name of at most NAME_AT_MOST cells."""
    if cell_len(name) <= NAME_AT_MOST:
        return name
    while cell_len(name) >= NAME_AT_MOST:
        name = name[:-1]
    return f"{name}…"
