"""Workbooks: the tables of a run as another program reads them; no text is a formula, a link or a number."""

from __future__ import annotations

import csv
import io
import random
import sys
from pathlib import Path
from typing import Any

import openpyxl
import pytest

from tester.base.plugins import MissingExtraError
from tester.base.words import harmless
from tester.results.columns import Output
from tester.results.conditions_table import conditions_table
from tester.results.formats import FORMATS, Record
from tester.results.table_cells import Number, begins_like_a_formula, encode
from tester.results.workbook import LONGEST, write_workbook
from tester.store.run_reader import RunReader
from tests.tester.results.made import made, unescaped
from tests.tester.store.build import small_run

UTC = "2026-01-15T10:00:00.000Z"
BEGINNINGS = ("=", "+", "-", "@", "\t=", "\r+", "\n@", "'=", "＝", "＋", "－", "＠", " =", "|", "%0A=")
BODIES = (
    "cmd|' /C calc'!A0", "1+1", 'HYPERLINK("http://a.example","x")', "SUM(A1:A9)",
    'IMPORTXML("http://a.example","//a")',
    'WEBSERVICE("http://a.example")', "DDE(\"cmd\";\"/C calc\";\"1\")", "2026-01-01", "1e9", "http://a.example",
    "x,y\"z", "_x003D_1", "\u202egnp", "", "[1]Sheet1!A1",
)  # fmt: skip
HOSTILE = [f"{begins}{body}" for begins in BEGINNINGS for body in BODIES][:200]


def book(sheets: list[tuple[str, list[list[Any]]]], utc: str = UTC) -> tuple[bytes, Any]:
    file = io.BytesIO()
    write_workbook(sheets, utc, file)
    return file.getvalue(), openpyxl.load_workbook(io.BytesIO(file.getvalue()))


def test_no_hostile_text_is_a_formula_a_link_or_a_number_and_all_read_back() -> None:
    assert len(set(HOSTILE)) == 200
    _, read = book([("texts", [["text"], *([text] for text in HOSTILE)])])
    for text, (cell,) in zip(HOSTILE, read["texts"].iter_rows(min_row=2), strict=True):
        assert cell.data_type == "s" and cell.hyperlink is None, text
        assert cell.value.replace("\r", "\n") == harmless(text).replace("\r", "\n")
        assert cell.quotePrefix or not begins_like_a_formula(harmless(text)), text


def test_no_hostile_text_begins_like_a_formula_in_csv_and_all_read_back() -> None:
    data = b"".join(encode([[text] for text in HOSTILE])).decode()
    for text, (cell,) in zip(HOSTILE, csv.reader(io.StringIO(data, newline="")), strict=True):
        assert cell[:1] not in tuple("=+-@\t\r\n＝＋－＠"), text
        assert unescaped(cell) == harmless(text)


def test_a_hostile_heading_is_text() -> None:
    _, read = book([("a", [["=1+1"], [Number("0.5")]])])
    assert (read["a"]["A1"].data_type, read["a"]["A2"].value) == ("s", 0.5)


def test_numbers_are_numbers_and_no_value_is_an_empty_cell() -> None:
    _, read = book([("a", [["x"], [Number("0.7297712")], [7], [None], [float("nan")], [Number("")], ["7"]])])
    values = [cell.value for (cell,) in read["a"].iter_rows(min_row=2)]
    assert values == [0.7297712, 7, None, None, None, "7"]


def test_a_text_longer_than_a_cell_is_cut() -> None:
    _, read = book([("a", [["x"], ["y" * 40_000]])])
    assert len(read["a"]["A2"].value) == LONGEST and read["a"]["A2"].value.endswith("…")


@pytest.mark.parametrize("utc", [UTC, "unknown"])
def test_the_same_tables_give_the_same_bytes(utc: str) -> None:
    rows = [["x"], *([random.Random(1).random()] for _ in range(5))]
    assert book([("a", rows)], utc)[0] == book([("a", rows)], utc)[0]


def test_a_workbook_has_the_tables_that_a_runs_folder_keeps_cell_by_cell(tmp_path: Path) -> None:
    with RunReader(small_run(tmp_path)) as reader:
        read = openpyxl.load_workbook(io.BytesIO(made("xlsx", reader)))
        results = Record(reader).results
        kept = [one.name for one in FORMATS.values() if one.rows and one.kept is not None and one.kept(results)]
        assert read.sheetnames == kept and "conditions" in kept
        for name in kept:
            texts = [*csv.reader(io.StringIO(made(name, reader).decode("utf-8-sig"), newline=""))]
            for row, cells in zip(texts, read[name].iter_rows(values_only=True), strict=True):
                for text, cell in zip(row, cells, strict=True):
                    same = float(text) == cell if isinstance(cell, float | int) else unescaped(text) == (cell or "")
                    assert same, (name, text, cell)


def test_a_workbook_agrees_with_show(tmp_path: Path) -> None:
    with RunReader(small_run(tmp_path)) as reader:
        sheet = openpyxl.load_workbook(io.BytesIO(made("xlsx", reader)))["conditions"]
        table = conditions_table(Record(reader).results)
    heads, *rows = sheet.iter_rows(values_only=True)
    shown = table.view(Output.SHOW)
    keys = [column for column in shown.columns if column.decimals is not None and column.key in heads]
    assert {"mu", "u_expanded", "u_expanded_compound"} <= {column.key for column in keys}
    for row, cells in zip(table.rows, rows, strict=True):
        for column in keys:
            cell = cells[heads.index(column.key)]
            mark = column.mark(row) if column.mark is not None else ""
            assert column.text(row) == (f"{cell:.{column.decimals}f}{mark}" if cell is not None else "—")


def test_without_its_library_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xlsxwriter", None)
    with pytest.raises(MissingExtraError, match=r"friction-tester\[xlsx\]"):
        write_workbook([], UTC, io.BytesIO())
