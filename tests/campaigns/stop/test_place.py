"""The lateness of scans, from the records of one run or of several."""

from __future__ import annotations

import pytest

from tests.campaigns.stop.place import ROLLING, late_scans


def notes(origin_s: float, count: int, late: dict[int, float]) -> list[tuple[float, float]]:
    return [(origin_s + 0.01 * i + late.get(i, 0.0), 0.01 * i) for i in range(count)]


def test_lateness_is_what_a_scan_is_behind_the_most_punctual_ones() -> None:
    found = late_scans(notes(500.0, 100, {40: 0.006}))
    assert [round(late, 6) for _, late in found] == [0.006 if i == 40 else 0.0 for i in range(100)]


def test_a_second_run_is_not_late_by_the_time_that_lies_between() -> None:
    found = late_scans([*notes(500.0, 30, {}), *notes(600.0, ROLLING + 30, {7: 0.004})])
    assert len(found) == ROLLING + 60
    assert max(late for _, late in found) == pytest.approx(0.004, abs=1e-9)
