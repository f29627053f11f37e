"""Cells: numbers stay numbers, text reads back unchanged and is never a formula."""

from __future__ import annotations

import csv
import io

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from tester.base.words import harmless
from tester.results.table_cells import Number, encode, exact, line, nominal, number, text
from tests.tester.results.made import unescaped

TEXTS = st.text(st.characters(exclude_categories=("Cs",)), max_size=30)


def read(data: bytes) -> list[list[str]]:
    return list(csv.reader(io.StringIO(data.decode(), newline="")))


@given(TEXTS, TEXTS)
@example("=cmd|' /C calc'!A0", "+1")
@example("a,b", 'say "no"')
@example("line\nline\r", "\r")
@example("'quoted", " spaces ")
@example("", "")
def test_any_text_reads_back_as_it_was_meant(a: str, b: str) -> None:
    ((one, two),) = read(encode_all([[a, b]]))
    assert (unescaped(one), unescaped(two)) == (harmless(a), harmless(b))


def test_no_text_cell_steers_a_terminal() -> None:
    assert text("\x1b[31mred\x9b\u202e") == "?[31mred??"


def encode_all(rows: list[list[str | int | float | None]] | list[list[str]]) -> bytes:
    return b"".join(encode(rows))


@given(TEXTS)
def test_no_text_cell_begins_like_a_formula(value: str) -> None:
    assert text(value)[:1] not in ("=", "+", "-", "@", "\t", "\r", "\n", "＝", "＋", "－", "＠")


def test_numbers_stay_numbers_also_negative_ones() -> None:
    assert line([-0.5, -3, nominal(-100.0), number(1e-9)]) == "-0.5,-3,-100,1e-09\n"


def test_text_that_looks_like_a_number_is_text() -> None:
    assert line(["-3"]) == "'-3\n"


@pytest.mark.parametrize(
    ("value", "cell"),
    [
        (300.0, "300"),
        (0.1 * 3000, "300"),
        (-0.0, "0"),
        (0.8, "0.8"),
        (12.5, "12.5"),
        (1e6, "1000000"),
        (-100.0, "-100"),
    ],
)
def test_setpoints_are_integers_where_they_are_integral(value: float, cell: str) -> None:
    assert nominal(value) == cell


@pytest.mark.parametrize(
    ("value", "cell"),
    [(None, ""), (float("nan"), ""), (float("inf"), ""), (-0.0, "0"), (7, "7"), (0.72977123456, "0.7297712")],
)
def test_numbers_have_seven_digits_and_no_value_is_an_empty_cell(value: float | None, cell: str) -> None:
    assert number(value) == cell


def test_exact_numbers_read_back_as_the_same_float() -> None:
    assert float(exact(0.1 + 0.2)) == 0.1 + 0.2
    assert exact(float("nan")) == ""


def test_a_formatted_number_is_left_alone() -> None:
    assert line([Number("-0.70")]) == "-0.70\n"


def test_a_byte_order_mark_comes_first_where_asked() -> None:
    assert b"".join(encode([["a"]], bom=True)) == b"\xef\xbb\xbfa\n"


def test_many_rows_come_in_pieces() -> None:
    pieces = list(encode([[i] for i in range(1100)]))
    assert len(pieces) == 3
    assert b"".join(pieces).count(b"\n") == 1100
