"""``tester runs``: list, filters, lines of interrupted runs; ``tester compare``."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from tester.base.lock import RUN_LOCK, ExclusiveUse
from tester.cli.compare_command import compare
from tester.cli.runs_command import runs
from tester.store.records import SpecimenInfo
from tests.tester.store.build import CONDITIONS, PIECE, RUN, SPECIMENS, open_writer, record, small_run


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder whose runs/ holds one finished run, ``one``."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("TESTER_CATALOGUE", raising=False)
    small_run(tmp_path / "runs" / "one")
    return tmp_path


def invoke(command: object, *arguments: str) -> Result:
    return CliRunner().invoke(command, list(arguments), prog_name="tester")  # type: ignore[arg-type]


def listed(*arguments: str) -> list[dict[str, object]]:
    return json.loads(invoke(runs, "--json", *arguments).stdout)


def open_run(folder: Path, repeats: int = 2) -> Path:
    """Write a run that never ended."""
    folder.mkdir(parents=True)
    writer = open_writer(folder)
    writer.begin_run(replace(RUN, started_utc="2024-05-01T08:00:00.000Z"), SPECIMENS, CONDITIONS)
    record(writer, 1, [0.9, 0.91, 0.92][:repeats])
    writer.close()
    return folder


def test_runs_lists_name_status_and_committed_repeats(home: Path) -> None:
    result = invoke(runs)
    assert result.exit_code == 0
    assert result.stdout == "one  done  0:45:00  2 conditions, 6 repeats  Small, two loads\n"


def test_runs_as_json(home: Path) -> None:
    (found,) = listed()
    assert (found["run"], found["status"], found["rig_seconds"]) == ("one", "done", 2700.5)
    assert (found["conditions"], found["repeats"], found["seed"], found["values"]) == (2, 6, 1, 2)


def test_runs_of_another_folder(home: Path) -> None:
    small_run(home / "elsewhere" / "two")
    assert invoke(runs, "--out", "elsewhere").stdout.startswith("two ")


def test_no_runs_are_an_empty_list(home: Path) -> None:
    assert invoke(runs, "--out", "nowhere").stdout == ""
    assert listed("--out", "nowhere") == []


def test_an_interrupted_run_lists_its_committed_repeats(home: Path) -> None:
    open_run(home / "runs" / "two")
    assert "two  interrupted, 2 of 6 repeats committed  " in invoke(runs).stdout
    assert [(run["run"], run["status"], run["can_resume"]) for run in listed("--status", "interrupted")] == [
        ("two", "interrupted", True)
    ]


def test_a_run_under_way_names_its_process(home: Path) -> None:
    folder = open_run(home / "runs" / "two")
    with ExclusiveUse() as use:
        use.lock_file("two", folder / RUN_LOCK, "two", lasting=False)
        assert "two  running, process " in invoke(runs).stdout
        (found,) = listed("--status", "running")
    assert found["can_resume"] is False


def test_a_run_that_cannot_be_read_is_named_on_stderr(home: Path) -> None:
    (home / "runs" / "bad").mkdir()
    (home / "runs" / "bad" / "run.db").touch()
    result = invoke(runs)
    assert result.exit_code == 0
    assert result.stderr.startswith("bad: ")
    assert "bad" not in result.stdout


@pytest.mark.parametrize(
    "arguments, found",
    [
        (("--since", "2024-03-01"), ["two"]),
        (("--until", "2024-02-21"), ["one"]),
        (("--compound", "1#"), ["one", "two"]),
        (("--compound", "1"), []),
        (("--recipe", "TWO loads"), ["one", "two"]),
        (("--recipe", "%"), []),
        (("--status", "done"), ["one"]),
    ],
)
def test_runs_are_chosen(home: Path, arguments: tuple[str, ...], found: list[str]) -> None:
    open_run(home / "runs" / "two")
    assert [run["run"] for run in listed(*arguments)] == found


def test_a_date_that_is_none_is_a_usage_error(home: Path) -> None:
    result = invoke(runs, "--since", "yesterday")
    assert result.exit_code == 2 and "2026-11-01" in result.stderr


def test_the_index_follows_the_runs(home: Path) -> None:
    assert len(listed()) == 1
    open_run(home / "runs" / "two", repeats=1)
    assert [run["repeats"] for run in listed()] == [6, 1]
    for path in (home / "runs" / "one").iterdir():
        path.unlink()
    assert [run["run"] for run in listed()] == ["two"]


@pytest.mark.parametrize("damage", [b"", b"not a database at all, " * 50])
def test_a_damaged_index_is_made_again_from_the_runs(home: Path, damage: bytes) -> None:
    before = listed()
    (home / "runs" / ".catalogue.db").write_bytes(damage)
    assert listed() == before


def test_two_runs_are_compared_condition_by_condition(home: Path) -> None:
    small_run(home / "runs" / "two", ([1.00, 1.01, 0.99], [0.73, 0.74, 0.72]))
    rows = json.loads(invoke(compare, "one", "two", "--json").stdout)
    assert [row["load_n"] for row in rows] == [100.0, 200.0]
    assert rows[0]["difference"] == pytest.approx(0.1) and rows[0]["z"] > 2.0
    assert rows[1]["difference"] == pytest.approx(0.0) and rows[1]["u_difference"] > 0.0


def test_replicates_are_compared_by_their_mean(home: Path) -> None:
    for name, values in (("three", (0.70, 0.73, 0.76)), ("others", (0.80, 0.83, 0.86))):
        (home / "runs" / name).mkdir()
        writer = open_writer(home / "runs" / name)
        conditions = [replace(CONDITIONS[0], condition=i, replicate=i) for i in (1, 2, 3)]
        writer.begin_run(RUN, SPECIMENS, conditions)
        writer.piece_mounted(PIECE)
        for condition, mu in zip(conditions, values, strict=True):
            record(writer, condition.condition, [mu, mu + 0.01, mu - 0.01])
        writer.close()
    (row,) = json.loads(invoke(compare, "three", "others", "--json").stdout)
    assert (row["pieces_1"], row["difference"]) == (3, pytest.approx(0.1)) and row["differs"]


def test_a_difference_explained_by_chance_is_not_reported_as_one(home: Path) -> None:
    small_run(home / "runs" / "two", ([0.93, 0.94, 0.92], [0.73, 0.74, 0.72]))
    rows = json.loads(invoke(compare, "one", "two", "--json").stdout)
    assert not rows[0]["differs"] and abs(rows[0]["z"]) < rows[0]["k"]
    assert "differs" not in invoke(compare, "one", "two").stdout


def test_another_seed_is_another_rig_whose_errors_are_its_own(home: Path) -> None:
    def u(seed: int) -> float:
        folder = home / "runs" / f"seed {seed}"
        folder.mkdir()
        writer = open_writer(folder)
        writer.begin_run(replace(RUN, seed=seed), SPECIMENS, CONDITIONS[:1])
        writer.piece_mounted(PIECE)
        record(writer, 1, [0.90, 0.91, 0.89])
        writer.close()
        return json.loads(invoke(compare, "one", f"seed {seed}", "--json").stdout)[0]["u_difference"]

    assert u(2) > 1.05 * u(1)


def test_two_compounds_are_compared_by_their_names(home: Path) -> None:
    (home / "runs" / "new").mkdir()
    writer = open_writer(home / "runs" / "new")
    held = CONDITIONS[0].setpoint
    writer.begin_run(RUN, SPECIMENS, [replace(CONDITIONS[0], setpoint=held.but("new"))])
    writer.piece_mounted(PIECE)
    record(writer, 1, [1.2, 1.21, 1.19])
    writer.close()
    found = json.loads(invoke(compare, "one", "new", "--compounds", "1#", "new", "--json").stdout)
    assert [row["difference"] is None for row in found] == [False, True] and found[0]["differs"]
    wrong = invoke(compare, "one", "new", "--compounds", "new", "new")
    assert wrong.exit_code == 1 and "one has no compound new" in wrong.stderr


def test_the_two_compounds_of_one_run_are_compared_without_another_run(home: Path) -> None:
    (home / "runs" / "both").mkdir()
    writer = open_writer(home / "runs" / "both")
    held = CONDITIONS[0].setpoint
    second = replace(CONDITIONS[0], condition=2, row=2, specimen=2, setpoint=held.but("2#"))
    writer.begin_run(RUN, [SPECIMENS[0], SpecimenInfo(2, "2#", "")], [replace(CONDITIONS[0], row=1), second])
    writer.piece_mounted(PIECE)
    record(writer, 1, [0.7, 0.71, 0.69])
    record(writer, 2, [1.2, 1.21, 1.19])
    writer.close()
    for named in ([], ["--compounds", "1#", "2#"]):
        (row,) = json.loads(invoke(compare, "both", *named, "--json").stdout)
        assert row["difference"] == pytest.approx(0.5) and row["differs"]
    alone = invoke(compare, "one")
    assert alone.exit_code == 2 and "one alone has the compounds 1#: which two? (expected RUN2)" in alone.stderr


def test_a_condition_that_only_one_run_has_is_compared_with_nothing(home: Path) -> None:
    small_run(home / "runs" / "two", ([0.9, 0.91, 0.89],))
    rows = json.loads(invoke(compare, "one", "two", "--json").stdout)
    assert rows[1]["mu_2"] is None and rows[1]["z"] is None
    assert " — " in invoke(compare, "one", "two").stdout.splitlines()[3]
