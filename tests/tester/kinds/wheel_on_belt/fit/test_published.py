"""The paper held against its own appendices."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest

from sim.physics.friction import COMPOUNDS
from tester.fit.part import PublishedTable, TableLine
from tester.fit.text import table_lines
from tester.kinds.wheel_on_belt.fit import published
from tester.kinds.wheel_on_belt.fit.data import appendix
from tester.kinds.wheel_on_belt.fit.laws import table_3_of
from tester.kinds.wheel_on_belt.fit.staged import staged

pytest.importorskip("scipy", reason="needs the extra `report`")


@pytest.fixture(scope="module")
def table() -> PublishedTable:
    return published.published_table()


@pytest.fixture(scope="module")
def lines(table: PublishedTable) -> Mapping[str, TableLine]:
    return {line.way: line for line in table.lines}


EXPECTED = {
    "Eqs 7 to 9 with Table 3": (10.62, 5.90, 50.1, 36, 54),
    "the paper's staged way": (11.4, 6.0, 60.1, 32, 54),
    "Eq 6, all parameters at once": (10.6, 6.7, 53.8, 30, 55),
    "v2, fitted to appendix A": (6.4, 5.1, 23.2, 37, 64),
    "v2, fitted to A and B (*)": (4.3, 3.8, 19.6, 50, 73),
}
"""Mean, median, largest error in %, rows within 5 and 10 %, of an independent calculation."""


@pytest.mark.parametrize("way", EXPECTED)
def test_a_line_of_the_table_is_as_calculated_elsewhere(way: str, lines: Mapping[str, TableLine]) -> None:
    mean, middle, largest, near, far = EXPECTED[way]
    found = lines[way].validation
    assert (found.rows, found.near, found.far) == (79, near, far)
    assert 100.0 * found.mean == pytest.approx(mean, abs=0.051)
    assert (100.0 * found.median, 100.0 * found.largest) == pytest.approx((middle, largest), abs=0.051)


def test_what_is_asked_is_met(table: PublishedTable) -> None:
    assert [line.way for line in table.lines if line.asked] == ["Eqs 7 to 9 with Table 3", "v2, fitted to appendix A"]
    assert table.missed == []


def test_another_table_3_misses(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = {name: replace(one, b1=1.02 * one.b1) for name, one in COMPOUNDS.items()}
    monkeypatch.setattr(published, "COMPOUNDS", wrong)
    table = published.published_table()
    assert table.missed == ["Eqs 7 to 9 with Table 3"]
    assert any(line.startswith("  MISSED Eqs 7 to 9") for line in table_lines(table))


def test_the_errors_that_the_paper_quotes_are_those_of_measured_values_times_f_of_t(table: PublishedTable) -> None:
    told = {claim.said: claim.found for claim in table.claims}
    (three,) = (found for said, found in told.items() if said.startswith("0.8 %"))
    assert three == "3.4%, 0.5%, 5.1% by Eqs 7 to 9; 0.8%, 2.0%, 2.5% by the value measured at 25 degC times f(T)"
    (one,) = (found for said, found in told.items() if said.startswith("2.4 %"))
    assert one == "21.2% by Eqs 7 to 9; 2.1% by the value measured at 25 degC times f(T)"


def test_the_staged_way_gives_back_what_table_3_says_of_speed() -> None:
    for compound, joint in staged(appendix("appendix-a").points).items():
        found, printed = table_3_of(joint), COMPOUNDS[compound]
        f25 = printed.alpha * 2.718281828459045 ** (-printed.beta * (25.0 - printed.tm) ** 2) + printed.gamma
        assert found.b2 == pytest.approx(printed.b2, abs=2e-3)
        assert found.a2 / f25 == pytest.approx(printed.a2, rel=0.03)


def test_the_table_is_told_with_its_verdict(table: PublishedTable) -> None:
    told = list(table_lines(table))
    assert "79 rows of appendix B" in told[0]
    assert sum(line.startswith("  ok ") for line in told) == 2
    assert any("within 5 %: 36 of 79 rows" in line for line in told)
