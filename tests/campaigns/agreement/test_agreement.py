"""The comparison itself: what counts as printed, as agreeing, as left out."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.campaigns.agreement.compare import contradictions
from tests.campaigns.agreement.facts import Fact, printed, seconds_of
from tests.campaigns.agreement.mutants import MUTANTS, Patched
from tests.campaigns.agreement.names import MU, MU_MEASURED, U_THIS, quantity_of
from tests.campaigns.agreement.read_text import read_ending
from tests.campaigns.agreement.record import Record, RecordedAxis, RecordedCondition
from tests.campaigns.agreement.table import headings_of

AT = ("condition", "run", 1)


def fact(value: float | str | None, half: float, output: str) -> Fact:
    """Return a statement about the coefficient of a condition."""
    return Fact(AT, MU, value, half, output)


@pytest.mark.parametrize(
    ("text", "significant", "value", "half"),
    [
        ("0.984?", 0, 0.984, 5e-4),
        ("−0.02", 0, -0.02, 5e-3),
        ("6.9 %", 0, 6.9, 0.05),
        ("0.8", 7, 0.8, 5e-8),
        ("1.2e-05", 0, 1.2e-5, 5e-7),
        ("12", -1, 12.0, 0.0),
    ],
)
def test_a_printed_number_is_known_to_half_a_unit_of_its_last_digit(
    text: str, significant: int, value: float, half: float
) -> None:
    assert printed(text, significant) == (value, pytest.approx(half))


@pytest.mark.parametrize("text", ["ok", "1 of 10 revolutions", "2026-11-25T17:00", ""])
def test_a_sentence_is_no_number(text: str) -> None:
    assert printed(text) is None


def test_durations_are_seconds() -> None:
    assert [seconds_of(text) for text in ("1:02:03", "~4:05", "soon")] == [3723.0, 245.0, None]


def test_roundings_of_one_value_agree() -> None:
    facts = [fact(0.98369227, 0.0, "json"), fact(0.984, 5e-4, "terminal"), fact(0.9837, 5e-5, "page")]
    assert not [*contradictions(AT, MU, facts, valued=True)]


def test_a_last_digit_that_is_off_disagrees() -> None:
    facts = [fact(0.98369227, 0.0, "json"), fact(0.985, 5e-4, "terminal")]
    (found,) = contradictions(AT, MU, facts, valued=True)
    assert [one.output for one in found.facts] == ["json", "terminal"]


def test_a_dash_beside_a_value_disagrees_only_where_the_value_is_to_be_trusted() -> None:
    facts = [fact(0.98, 0.0, "json"), fact(None, 0.0, "terminal")]
    assert [*contradictions(AT, MU, facts, valued=True)]
    assert not [*contradictions(AT, MU, facts, valued=False)]


@pytest.mark.parametrize(
    ("heading", "quantity"),
    [("mu", MU), ("Friction Coefficient", MU), ("mu_as_measured", MU_MEASURED), ("U this wheel", U_THIS),
     ("u_expanded", U_THIS)],
)  # fmt: skip
def test_a_heading_names_one_quantity_in_every_output(heading: str, quantity: str) -> None:
    assert quantity_of(heading, "wheel") == quantity


def test_headings_in_two_lines_are_joined_by_the_right_edge_of_their_column() -> None:
    first = "compound  Slip  Temp     mu      mu as  valid"
    second = "          mm/s    °C          measured       "
    assert headings_of(first, second) == ["compound", "Slip mm/s", "Temp °C", "mu", "mu as measured", "valid"]


def test_a_row_of_the_terminal_is_found_by_its_setpoint_and_its_remarks_are_flags() -> None:
    axis = RecordedAxis("load", "load_n", "N", 1.0, frozenset({"load n", "load (n)"}))
    conditions = tuple(
        RecordedCondition(number, number, 1, "1#", "g", {"load": load}, 3, 0.0, 1.0)
        for number, load in ((1, 100.0), (2, 200.0))
    )
    record = Record(Path("run"), "wheel_on_belt", 0.0, (axis,), conditions, frozenset(), 1, False, True)
    lines = ["compound  Load     mu", "             N       ", "1#         200  0.98?  carry-over, short"]
    facts = read_ending(record, "wheel", lines, "end")
    found = {one.quantity: one.value for one in facts.collected if one.subject == record.of_condition(2)}
    assert found == {"mu": 0.98, "mark": "?", "flags": frozenset({"carry-over", "short"})}
    assert not facts.strange


def test_there_are_mutants_of_every_way_in_which_a_run_is_shown() -> None:
    assert len(MUTANTS) >= 12


@pytest.mark.parametrize("name", MUTANTS)
def test_the_text_that_a_mutant_changes_is_in_its_module_once(name: str) -> None:
    assert MUTANTS[name].new in Patched(MUTANTS[name]).text
