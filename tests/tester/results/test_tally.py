"""Counts of conditions and of their flags, in words."""

from __future__ import annotations

from math import nan
from pathlib import Path

from tester.analysis.flags import CARRY_OVER
from tester.results.run_results import results_of
from tester.results.tally import flag_lines, tally_of
from tester.store.run_reader import RunReader
from tests.tester.results.test_reference import BLUNT, SHARP, watched_run
from tests.tester.store.build import CONDITION, RUN, SPECIMENS, open_writer, record, small_run


def sentence(folder: Path) -> str:
    with RunReader(folder) as reader:
        return tally_of(results_of(reader)).sentence


def test_notes_are_counted_beside_doubts(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [CONDITION])
    record(writer, 1, [0.9] * 3, flags=CARRY_OVER)
    writer.close()
    assert sentence(tmp_path) == (
        "The condition has a value; 1 carries a doubt (carry-over), 1 carries a note (extended)."
    )


def test_no_doubt_and_a_note_are_distinguished(tmp_path: Path) -> None:
    assert sentence(small_run(tmp_path)) == (
        "All 2 conditions have a value; none carries a doubt, 2 carry a note (extended)."
    )


def test_a_condition_without_a_value_counts_as_none(tmp_path: Path) -> None:
    told = sentence(small_run(tmp_path, ([nan] * 3, [0.73, 0.74, 0.72])))
    assert told.startswith("1 of 2 conditions has a value; none carries a doubt, 1 carries a note")


def test_references_are_in_no_count(tmp_path: Path) -> None:
    assert sentence(watched_run(tmp_path, (SHARP, [nan] * 3, BLUNT))).startswith("All 2 conditions have a value; ")


def test_every_raised_flag_comes_with_its_meaning_and_remedy(tmp_path: Path) -> None:
    with RunReader(watched_run(tmp_path)) as reader:
        lines = [*flag_lines(results_of(reader))]
    (doubt,) = (line for line in lines if line.startswith("reference out of limits (doubt): "))
    assert "What helps: change or clean the counterface" in doubt
    assert any(line.startswith("reference (note): ") for line in lines)
