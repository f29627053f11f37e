"""The paper compared with its own appendices."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sim.physics.friction import COMPOUNDS, V2
from tester.analysis.fit.fit_law import by_group
from tester.analysis.fit.fit_part import PublishedTable
from tester.analysis.fit.fit_text import table_lines
from tester.analysis.fit.joint import fit_only
from tester.kinds.wheel_on_belt.fit import published
from tester.kinds.wheel_on_belt.fit.data import Reading, appendix
from tester.kinds.wheel_on_belt.fit.laws import V2_LAW, of_v2, table_3_of
from tester.kinds.wheel_on_belt.fit.staged import staged

pytest.importorskip("scipy", reason="needs the extra `report`")


@pytest.fixture(scope="module")
def table() -> PublishedTable:
    return published.published_table()


EXPECTED = {
    "Eqs 7 to 9 with Table 3": (10.62, 5.90, 50.1, 36, 54),
}
AS_INFERRED = {
    "the paper's staged way": (11.4, 6.0, 60.1, 32, 54),
    "Eq 6, all parameters at once": (10.6, 6.7, 53.8, 30, 55),
    "v2, fitted to appendix A": (6.4, 5.1, 23.2, 37, 64),
    "v2, fitted to A and B (*)": (4.3, 3.8, 19.6, 50, 73),
}
"""Mean, median, largest error in %, rows within 5 and 10 %, of an independent calculation with inferred rows."""


@pytest.mark.parametrize("way", [*EXPECTED, *AS_INFERRED])
def test_a_line_of_the_table_is_as_calculated_elsewhere(way: str, table: PublishedTable) -> None:
    mean, middle, largest, near, far = (EXPECTED | AS_INFERRED)[way]
    lines = table.lines if way in EXPECTED else table.compared["with A027 and A036 as inferred"]
    found = next(line for line in lines if line.way == way).validation
    assert (found.rows, found.near, found.far) == (79, near, far)
    assert 100.0 * found.mean == pytest.approx(mean, abs=0.051)
    assert (100.0 * found.median, 100.0 * found.largest) == pytest.approx((middle, largest), abs=0.051)


def test_the_requirements_are_met(table: PublishedTable) -> None:
    assert [line.way for line in table.lines if line.asked] == ["Eqs 7 to 9 with Table 3", "v2, fitted to appendix A"]
    assert table.missed == []


def test_another_table_3_misses(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = {name: replace(one, b1=1.02 * one.b1) for name, one in COMPOUNDS.items()}
    monkeypatch.setattr(published, "COMPOUNDS", wrong)
    table = published.published_table()
    assert table.missed == ["Eqs 7 to 9 with Table 3"]
    assert any(line.startswith("  MISSED Eqs 7 to 9") for line in table_lines(table))


def test_no_verdict_rests_on_an_inferred_row(table: PublishedTable) -> None:
    used = {line.fitted.rows for line in table.lines if line.fitted.rows}
    assert used == {34, 34 + 79}
    assert not any(line.asked for lines in table.compared.values() for line in lines)


def test_without_its_value_at_25_degc_a_condition_is_not_scaled(table: PublishedTable) -> None:
    way = "measured at 25 degC, times f(T) (*)"
    rows = {next(line for line in lines if line.way == way).validation.rows for lines in table.compared.values()}
    assert next(line for line in table.lines if line.way == way).validation.rows == 71
    assert rows == {79}


def test_all_eight_errors_that_the_paper_quotes_are_answered(table: PublishedTable) -> None:
    told = {claim.statement: claim.found for claim in table.claims}
    (of_load,) = (found for said, found in told.items() if said.startswith("1.5, 1.0, 2.5, 2.4 %"))
    assert of_load == (
        "8.1%, 2.9%, 4.4%, 21.2% by Eqs 7 to 9; 0.9%, 1.4%, 2.2%, 2.1% by the value measured at 25 degC times f(T)"
    )
    (of_slip,) = (found for said, found in told.items() if said.startswith("0.8, 2.1, 1.1, 2.47 %"))
    assert of_slip.startswith("3.4%, 0.5%, 0.6%, 5.1% by Eqs 7 to 9; none by the value measured at 25 degC")
    assert "11.3%, 13.9%, 14.8%, 9.9% with it as printed" in of_slip
    assert "0.8%, 2.0%, 3.1%, 2.5% with it as inferred" in of_slip


def test_the_staged_way_gives_back_table_3_where_no_row_is_inferred() -> None:
    found, printed = table_3_of(staged(appendix("appendix-a").points)["3#"]), COMPOUNDS["3#"]
    assert found.b2 == pytest.approx(printed.b2, rel=1e-3)


@pytest.mark.parametrize("compound", ["1#", "2#"])
def test_inferred_rows_alone_give_table_3_of_their_compound_back(compound: str) -> None:
    b2 = {one: table_3_of(staged(appendix("appendix-a", one).points)[compound]).b2 for one in Reading}
    printed = COMPOUNDS[compound].b2
    assert b2[Reading.INFERRED] == pytest.approx(printed, rel=2e-3)
    assert abs(b2[Reading.WITHOUT] / printed - 1.0) > 0.1 and abs(b2[Reading.PRINTED] / printed - 1.0) > 0.1


def test_the_table_is_printed_with_its_verdict(table: PublishedTable) -> None:
    told = list(table_lines(table))
    assert "79 rows of appendix B" in told[0]
    assert sum(line.startswith("  ok ") for line in told) == 2
    assert any("within 5 %: 36 of 79 rows" in line for line in told)


def test_the_simulators_v2_is_the_fit_to_all_rows_that_can_be_read() -> None:
    rows = by_group((*appendix("appendix-a").points, *appendix("appendix-b").points))
    for compound, own in rows.items():
        assert fit_only(V2_LAW, compound, own) == pytest.approx(of_v2(V2[compound]), rel=3e-4)
