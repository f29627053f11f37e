"""A repeat excluded by a person: on record for good, honoured by every table, reported by `tester verify`."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest

from tester.analysis.flags import SHORT
from tester.base.lock import RUN_LOCK, ExclusiveUse
from tester.results import exclude
from tester.results.exclude import CannotExcludeError, Word, parse_target, record_word
from tester.results.run_files import write_all
from tester.results.run_results import RunResults, results_of
from tester.results.table_rows import TableRow
from tester.results.verify import verify
from tester.store.run_reader import RunReader
from tests.tester.store.build import RUN, small_run

REASON = "debris on the belt"
OUT = Word(2, 1, True, REASON, "ada")
IN = Word(2, 1, False, "it was not", "ben")
FOUR = ([0.90, 0.91, 0.89], [0.70, 0.74, 0.72, 0.73])
TABLES = ("appendix.csv", "conditions.csv", "repeats.csv")


@pytest.fixture
def run(tmp_path: Path) -> Path:
    folder = small_run(tmp_path / RUN.name, FOUR, rows=0)
    (folder / "recipe.yaml").write_text(RUN.recipe_text, encoding="utf-8")
    (folder / "rig.yaml").write_text(RUN.rig_text, encoding="utf-8")
    write_all(folder)
    return folder


def problems(folder: Path) -> tuple[str, ...]:
    """Return the findings of a verification, apart from the missing samples of these small runs."""
    return tuple(line for line in verify(folder).problems if "no samples" not in line)


def results(folder: Path) -> RunResults:
    with RunReader(folder) as reader:
        return results_of(reader)


def tables(folder: Path) -> dict[str, bytes]:
    return {name: (folder / name).read_bytes() for name in TABLES}


def test_an_excluded_repeat_is_left_out_of_the_mean_with_its_reason(run: Path) -> None:
    record_word(run, OUT)
    measured = list(results(run).conditions())[1]
    assert measured.result.mu_resultant == pytest.approx((0.74 + 0.72 + 0.73) / 3)
    assert (measured.result.n_valid, measured.result.flags) == (3, "excluded; extended")
    assert measured.exclusion(measured.repeats[0]) == f"excluded by hand: {REASON}"
    found = measured.left_out_by(measured.repeats[0])
    assert found is not None and found.operator == "ada"


def test_the_folders_tables_are_made_anew_and_only_there(run: Path) -> None:
    before = tables(run)
    record_word(run, OUT)
    after = tables(run)
    assert b"0.72" in before["appendix.csv"] and b"0.73" in after["appendix.csv"]
    changed = [row for row in after["repeats.csv"].splitlines() if row not in before["repeats.csv"].splitlines()]
    assert len(changed) == 1 and b",0,excluded by hand: debris on the belt," in changed[0]
    assert problems(run) == () and verify(run).excluded == 1


def test_included_again_the_tables_are_identical_to_the_byte(run: Path) -> None:
    before = tables(run)
    record_word(run, OUT)
    record_word(run, IN)
    assert tables(run) == before
    with RunReader(run) as reader:
        said = [(one.id, one.excluded, one.reason, one.operator) for one in reader.exclusions()]
    assert said == [(1, 1, REASON, "ada"), (2, 0, "it was not", "ben")]


def test_too_few_repeats_left_flag_the_value(run: Path) -> None:
    record_word(run, Word(1, 3, True, REASON, ""))
    found = results(run).rows[0].result
    assert (found.n_valid, found.doubts) == (2, (SHORT,))


def test_without_any_repeat_left_the_value_is_missing_with_a_reason(run: Path) -> None:
    for repeat in (1, 2, 3):
        record_word(run, Word(1, repeat, True, REASON, ""))
    (row,) = results(run).missing()
    assert "none of 3 repeats is valid: repeat 1 excluded by hand: debris on the belt" in row.describe()
    assert len((run / "appendix.csv").read_text("utf-8").splitlines()) == 2


@pytest.mark.parametrize(
    ("word", "message"),
    [
        (Word(2, 1, True, "  ", "ada"), "a reason is needed"),
        (Word(2, 1, True, "debris \x1b[31m", "ada"), r"reason: the character U\+001B, number 8"),
        (Word(2, 1, True, REASON, "ada\x07"), r"operator: the character U\+0007, number 4"),
        (Word(2, 9, True, REASON, "ada"), "condition 2 has repeats 1, 2, 3, 4"),
        (Word(7, 1, True, REASON, "ada"), "condition 7 has no committed repeat"),
        (IN, "2/1 has not been excluded"),
    ],
)
def test_nonsense_is_refused_and_changes_nothing(run: Path, word: Word, message: str) -> None:
    before = (run / "run.db").read_bytes()
    with pytest.raises(CannotExcludeError, match=message):
        record_word(run, word)
    assert (run / "run.db").read_bytes() == before


def test_excluding_twice_is_refused_with_the_earlier_reason(run: Path) -> None:
    record_word(run, OUT)
    with pytest.raises(CannotExcludeError, match=f"excluded already, .* by ada: {REASON}"):
        record_word(run, OUT)


def test_a_run_under_way_is_left_alone(run: Path) -> None:
    with ExclusiveUse() as use:
        use.lock_file("run", run / RUN_LOCK, "run", lasting=False)
        with pytest.raises(CannotExcludeError, match="under way"):
            record_word(run, OUT)


def test_a_folder_that_was_changed_is_not_given_a_new_manifest(run: Path) -> None:
    (run / "appendix.csv").write_text("better\n", encoding="utf-8")
    with pytest.raises(CannotExcludeError, match=r"appendix\.csv: changed"):
        record_word(run, OUT)
    assert problems(run) == ("appendix.csv: changed",)


@pytest.mark.parametrize("sql", ["UPDATE exclusion SET reason = 'x'", "DELETE FROM exclusion"])
def test_an_exclusion_cannot_be_changed_or_deleted(run: Path, sql: str) -> None:
    record_word(run, OUT)
    database = sqlite3.connect(run / "run.db")
    with pytest.raises(sqlite3.IntegrityError, match="only added"):
        database.execute(sql)
    database.close()


def test_a_row_that_was_taken_out_all_the_same_is_found(run: Path) -> None:
    for word in (OUT, IN):
        record_word(run, word)
    database = sqlite3.connect(run / "run.db")
    with database:
        database.execute("DROP TRIGGER exclusion_is_not_deleted")
        database.execute("DELETE FROM exclusion WHERE id = 1")
    database.close()
    assert "run.db: exclusion 1 is gone" in verify(run).problems


def test_cut_off_before_the_tables_it_is_found_and_the_same_again_finishes_it(
    run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def killed(folder: Path) -> list[TableRow]:
        raise OSError("killed here")

    with monkeypatch.context() as patch, pytest.raises(OSError, match="killed here"):
        patch.setattr(exclude, "write_all", killed)
        record_word(run, OUT)
    assert any(f"`tester results exclude {run.name} 2/1` was cut off" in problem for problem in problems(run))
    record_word(run, OUT)
    assert problems(run) == ()
    with RunReader(run) as reader:
        assert len(reader.exclusions()) == 1


def test_the_earlier_manifest_is_kept_so_that_the_first_record_can_still_be_verified(run: Path) -> None:
    before = (run / "manifest.json").read_text("utf-8")
    record_word(run, OUT)
    with RunReader(run) as reader:
        assert reader.exclusions()[0].manifest_before == before


def test_a_run_that_was_cut_off_takes_the_word_and_gets_no_tables_yet(tmp_path: Path) -> None:
    folder = small_run(tmp_path / RUN.name, FOUR, rows=0)
    record_word(folder, OUT)
    assert results(folder).rows[1].result.n_valid == 3
    assert [path.name for path in folder.iterdir()] == ["run.db"]


@pytest.mark.parametrize("text", ["", "3", "3/", "/2", "3/2/1", "a/b", "-1/2", "٣/2", "3/0"])
def test_a_repeat_that_is_not_named_as_in_the_table_is_refused(text: str) -> None:
    with pytest.raises(CannotExcludeError, match="CONDITION/REPEAT"):
        parse_target(text)


def test_a_repeat_is_named_by_condition_and_repeat() -> None:
    assert parse_target(" 12 / 3 ") == (12, 3)
