"""U from the last printed digit: of known sums, and of a fit without a second fit."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

import pytest

from tester.analysis.fit.fit_law import FitPoint, Source, by_group
from tester.analysis.fit.joint import fit_only
from tester.kinds.wheel_on_belt.fit.data import appendix
from tester.kinds.wheel_on_belt.fit.laws import V2_LAW
from tester.kinds.wheel_on_belt.papers.digits import digits_u, each_once, errors_u, fit_u

ROWS = [
    FitPoint(str(i), "1#", (25.0, 200.0, 0.3), (25.0, 200.0, 0.3), mu, Source("s")) for i, mu in enumerate((0.5, 1.0))
]
ROUNDING = 2.0 * 0.005 / sqrt(3.0)
"""U of one printed coefficient."""


def test_a_sum_has_the_u_of_its_terms() -> None:
    assert digits_u(lambda rows: [sum(row.value for row in rows)], ROWS) == pytest.approx([sqrt(2.0) * ROUNDING])


def test_a_result_without_a_row_has_no_part_of_it() -> None:
    assert digits_u(lambda rows: [rows[0].value, 1.0], ROWS) == pytest.approx([ROUNDING, 0.0])


def test_rows_whose_error_rounding_may_carry_over_the_limit_are_counted_both_ways() -> None:
    assert errors_u(lambda rows: [1.051 * row.value for row in rows], ROWS).endswith("0 to 2 rows")


def test_a_fit_is_made_once_of_the_same_rows() -> None:
    asked: list[Sequence[FitPoint]] = []
    fit = each_once(lambda rows: asked.append(rows) or len(rows))
    assert (fit(ROWS), fit(ROWS), len(asked)) == ({"1#": 2}, {"1#": 2}, 1)


def test_u_of_a_fit_is_that_of_fits_to_moved_rows() -> None:
    pytest.importorskip("scipy", reason="needs the extra `report`")
    rows = by_group(appendix("appendix-a").points)["2#"]

    def peak_c(points: Sequence[FitPoint]) -> list[float]:
        return [fit_only(V2_LAW, "2#", points)[2]]

    ours = fit_u(V2_LAW, fit_only(V2_LAW, "2#", rows), rows, lambda parameters: parameters[2])
    assert ours == pytest.approx(digits_u(peak_c, rows)[0], rel=0.05)
