"""The paper's appendices as they ship."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from setuptools import Distribution

from tester.kinds.wheel_on_belt.fit.data import APPENDICES, Reading, appendix, rows

ROOT = Path(__file__).parents[5]


def test_every_row_of_both_appendices_is_there() -> None:
    assert {name: len(rows(name)) for name in APPENDICES} == {"appendix-a": 57, "appendix-b": 84}


def test_rows_have_a_quality_and_doubtful_ones_a_reason() -> None:
    every = [row for name in APPENDICES for row in rows(name)]
    assert Counter(row["quality"] for row in every).keys() == {
        "ok", "reconstructed", "inferred", "suspect", "missing",
    }  # fmt: skip
    assert all(row["note"] for row in every if row["quality"] != "ok")


def test_a_missing_value_is_not_filled_in() -> None:
    missing = [row for row in rows("appendix-b") if row["quality"] == "missing"]
    assert len(missing) == 2 and not any(row["mu"] for row in missing)


def test_fits_get_the_readable_rows_each_once() -> None:
    a, b = appendix("appendix-a"), appendix("appendix-b")
    assert (len(a.points), len(a.left_out)) == (34, 23)
    assert (len(b.points), len(b.left_out)) == (79, 5)
    for one in (a, b):
        assert len({(point.group, point.nominal) for point in one.points}) == len(one.points)


def test_left_out_rows_have_a_reason() -> None:
    reasons = Counter(reason for name in APPENDICES for _, reason in appendix(name).left_out)
    assert reasons == {
        "printed twice": 12,
        "sideslip: the laws know none": 6,
        "quality: suspect": 6,
        "quality: inferred": 2,
        "quality: missing": 2,
    }


@pytest.mark.parametrize(
    ("reading", "values"), [(Reading.PRINTED, [0.51, 0.52]), (Reading.INFERRED, [0.58, 0.61])], ids=lambda one: str(one)
)
def test_inferred_rows_come_as_printed_or_as_inferred_when_asked_for(reading: Reading, values: list[float]) -> None:
    usual, found = appendix("appendix-a"), appendix("appendix-a", reading)
    added = [one for one in found.points if one.label not in {known.label for known in usual.points}]
    assert [(one.label, one.value) for one in added] == [("A027", values[0]), ("A036", values[1])]


def test_speeds_are_in_metres_a_second() -> None:
    first = appendix("appendix-a").points[0]
    assert (first.label, first.group, first.nominal, first.value) == ("A001", "1#", (25.0, 100.0, 0.3), 0.88)


def test_an_appendix_that_is_none_is_refused() -> None:
    with pytest.raises(KeyError):
        appendix("appendix-c")


def test_an_installed_package_has_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    distribution = Distribution()
    distribution.parse_config_files()
    shipped = {path for pattern in distribution.package_data["tester"] for path in (ROOT / "tester").glob(pattern)}
    assert "tester.kinds.wheel_on_belt.fit" in (distribution.packages or [])
    assert {path.name for path in shipped if path.parent.name == "data"} == set(APPENDICES.values())
