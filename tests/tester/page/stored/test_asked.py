"""Questions about stored runs: the values match `tester show`, and bad questions are refused."""

from __future__ import annotations

import json
import shutil
import sqlite3
from base64 import b64decode
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from tester.cli.main import root
from tester.page.stored.asked import answer
from tester.page.stored.run_cache import QuestionError, RunCache
from tester.results.exclude import CannotExcludeError
from tester.results.verify import verify
from tests.tester.service.views import HOSTILE
from tests.tester.store.build import RUN, small_run


def ask(under: Path, query: str, **keys: Any) -> Any:
    return answer(RunCache(under), query, keys, "page 1: Anna's phone")


@pytest.fixture
def own(run: Path, tmp_path: Path) -> Path:
    """Return a copy of the run, under its own name."""
    return Path(shutil.copytree(run, tmp_path / run.name))


def printed(*arguments: str) -> Any:
    result = CliRunner().invoke(root, list(arguments))
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def test_conditions_agree_with_tester_show_value_by_value(runs: Path, run: Path) -> None:
    shown = printed("show", "--json", str(run))
    page = ask(runs, "run", run=run.name)
    rows = {row["condition"]: row for row in shown["conditions"] if row["level"] == "condition"}
    assert len(rows) == len(page["conditions"]) == 2
    for condition in page["conditions"]:
        row = rows[condition["n"]]
        assert (condition["mu"], condition["u"], condition["u_compound"], condition["mark"]) == (
            row["mu"], row["u_expanded"], row["u_expanded_compound"], row["mark"],
        )  # fmt: skip
        state = "doubtful" if row["mark"] == "?" else "done"
        assert (condition["repeats"], condition["asked"], condition["state"]) == (row["valid"], row["asked"], state)
        assert condition["axes"]["slip_velocity"] == row["slip_velocity_mm_s"]


def test_repeats_agree_with_the_table_of_repeats(runs: Path, run: Path) -> None:
    import csv

    with (run / "repeats.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["condition"] == "1"]
    page = ask(runs, "condition", run=run.name, n=1)
    assert [one["mu"] for one in page["repeats"]] == pytest.approx([float(row["mu_as_measured"]) for row in rows])
    assert [one["from_s"] for one in page["repeats"]] == pytest.approx([float(row["started_s"]) for row in rows])
    assert len(rows) >= 3 and [one["state"] for one in page["repeats"]] == ["valid"] * len(rows)


def test_runs_are_those_of_tester_runs(runs: Path, run: Path) -> None:
    (page,) = ask(runs, "runs")["runs"]
    tags = page.pop("tags")
    assert [page] == printed("runs", "--json", "--out", str(runs)) and tags == []


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        ({"recipe": "short"}, 1), ({"compound": "1#"}, 1), ({"compound": "2#"}, 0), ({"status": "done"}, 1),
        ({"status": "tripped"}, 0), ({"text": "SHORT"}, 1), ({"text": "nothing"}, 0), ({"tag": "night"}, 0),
        ({"from": "2100-01-01"}, 0), ({"to": "2000-01-01"}, 0), ({"person": "nobody"}, 0),
    ],
)  # fmt: skip
def test_runs_are_found_by_their_properties(wanted: dict[str, str], found: int, runs: Path, run: Path) -> None:
    assert len(ask(runs, "runs", **wanted)["runs"]) == found


def test_samples_are_those_of_the_record(runs: Path, run: Path) -> None:
    repeat = ask(runs, "condition", run=run.name, n=1)["repeats"][0]
    window = {"from_s": repeat["from_s"], "to_s": repeat["to_s"]}
    found = ask(runs, "samples", run=run.name, columns=["load_n", "load_setpoint_n"], points=4000, **window)
    t_s = np.frombuffer(b64decode(found["t"]), "<f8")
    load = np.frombuffer(b64decode(found["columns"]["load_n"]["max"]), "<f4")
    wanted = np.frombuffer(b64decode(found["columns"]["load_setpoint_n"]["min"]), "<f4")
    assert len(t_s) == len(load) > 100 and t_s[0] >= 0.0
    assert (wanted == 100.0).all() and abs(np.mean(load) - 100.0) < 5.0


def test_a_moment_shows_values_beside_their_set_points(runs: Path, run: Path) -> None:
    repeat = ask(runs, "condition", run=run.name, n=1)["repeats"][0]
    moment = ask(runs, "moment", run=run.name, t_s=0.5 * (repeat["from_s"] + repeat["to_s"]))
    values = {value["key"]: value for value in moment["values"]}
    assert values["load"]["setpoint"] == 100.0 and abs(values["load"]["value"] - 100.0) < 20.0
    assert moment["step"] and moment["events"]


def test_before_the_first_sample_nothing_is_known(runs: Path, run: Path) -> None:
    moment = ask(runs, "moment", run=run.name, t_s=-1.0)
    assert [value["value"] for value in moment["values"]] == [None] * len(moment["values"]) and not moment["step"]


def test_a_run_laid_over_itself_differs_by_nothing(own: Path) -> None:
    twin = Path(shutil.copytree(own, own.parent / "twin"))
    page = ask(own.parent, "overlay", runs=[own.name, twin.name], against="slip_velocity")
    first, second = page["runs"]
    assert [p["mu"] for p in first["points"]] == [p["mu"] for p in second["points"]]
    assert [p["y"] for p in page["difference"][0]["points"]] == [0.0, 0.0]
    assert [p["y"] for p in page["ratio"][0]["points"]] == [1.0, 1.0]


@pytest.mark.parametrize("along", ["repeat", "time", "sliding"])
def test_repeats_are_aligned_on_number_time_or_sliding(along: str, runs: Path, run: Path) -> None:
    (only,) = ask(runs, "overlay", runs=[run.name], against=along)["runs"]
    places = [point["x"] for point in only["points"]]
    made = [one["n"] for n in (1, 2) for one in ask(runs, "condition", run=run.name, n=n)["repeats"]]
    assert len(made) >= 6
    assert places == (made if along == "repeat" else sorted(places)) and len(places) == len(made)


@pytest.mark.parametrize("along", ["repeat", "time", "sliding"])
def test_along_repeats_a_run_differs_from_its_twin_by_the_change(along: str, own: Path) -> None:
    twin = Path(shutil.copytree(own, own.parent / "twin"))
    with sqlite3.connect(twin / "run.db") as store:
        store.execute("UPDATE repeat SET mu_resultant = mu_resultant * 1.1 WHERE condition = 1")
    store.close()
    page = ask(own.parent, "overlay", runs=[own.name, twin.name], against=along)
    differences, ratios = page["difference"][0]["points"], page["ratio"][0]["points"]
    first, second = (p["label"] for p in (differences[0], differences[-1]))
    assert first != second and all(p["u"] > 0.0 for p in differences) and page["how"]
    assert {round(p["y"], 9) for p in ratios if p["label"] == first} == {1.1}
    assert {round(p["y"], 9) for p in ratios if p["label"] == second} == {1.0}
    mus = [p["mu"] for p in page["runs"][0]["points"]]
    assert differences[0]["y"] == pytest.approx(0.1 * mus[0])


def test_an_exclusion_is_on_record_with_the_page_that_asked(own: Path) -> None:
    before = ask(own.parent, "run", run=own.name)["conditions"][0]["mu"]
    ask(own.parent, "exclude", run=own.name, n=1, repeat=2, reason="debris")
    repeat = ask(own.parent, "condition", run=own.name, n=1)["repeats"][1]
    assert repeat["state"] == "excluded" and repeat["by_hand"]["by"] == "page 1: Anna's phone"
    assert ask(own.parent, "run", run=own.name)["conditions"][0]["mu"] != before
    ask(own.parent, "exclude", run=own.name, n=1, repeat=2, reason="it was none", include=True)
    assert ask(own.parent, "run", run=own.name)["conditions"][0]["mu"] == before
    assert verify(own).problems == ()


def test_a_whole_condition_is_excluded(own: Path) -> None:
    repeats = ask(own.parent, "condition", run=own.name, n=1)["repeats"]
    assert ask(own.parent, "exclude", run=own.name, n=1, reason="wrong wheel")["repeats"] == len(repeats)
    assert ask(own.parent, "run", run=own.name)["conditions"][0]["state"] == "excluded"


def test_notes_and_tags_are_on_record_and_find_the_run(own: Path) -> None:
    ask(own.parent, "note", run=own.name, text="belt changed before", tags=["night", "best"])
    ask(own.parent, "note", run=own.name, tags=["-best"])
    page = ask(own.parent, "run", run=own.name)
    assert page["tags"] == ["night"]
    assert [(note["by"], note["text"]) for note in page["notes"]] == [("page 1: Anna's phone", "belt changed before")]
    assert [run["tags"] for run in ask(own.parent, "runs", tag="night")["runs"]] == [["night"]]
    assert verify(own).problems == ()


@pytest.mark.parametrize(
    "note", [{"text": HOSTILE}, {"tags": [HOSTILE]}, {"tags": ["two words"]}, {}, {"text": "x" * 2001}]
)
def test_a_note_that_cannot_be_recorded_is_refused(note: dict[str, Any], own: Path) -> None:
    with pytest.raises((CannotExcludeError, QuestionError)):
        ask(own.parent, "note", run=own.name, **note)
    assert ask(own.parent, "run", run=own.name)["notes"] == []


@pytest.mark.parametrize("name", ["", "..", ".", "../x", "/etc", "a/b", "a\\b", ".recipes", "none", 7, None])
@pytest.mark.parametrize("query", ["run", "moment", "note"])
def test_a_run_is_named_without_a_folder(name: object, query: str, runs: Path, run: Path) -> None:
    further: dict[str, Any] = {"moment": {"t_s": 1.0}, "note": {"text": "x"}}.get(query, {})
    with pytest.raises(QuestionError):
        ask(runs, query, run=name, **further)


@pytest.mark.parametrize(
    ("query", "keys"),
    [
        ("samples", {"columns": [], "from_s": 0, "to_s": 1}), ("samples", {"columns": ["x"], "from_s": 0, "to_s": 1}),
        ("samples", {"columns": ["load_n"], "from_s": 0, "to_s": 1, "points": 10**9}),
        ("samples", {"columns": ["load_n"], "from_s": float("nan"), "to_s": 1}),
        ("condition", {"n": 99}), ("condition", {"n": "1; DROP TABLE run"}), ("run", {"more": 1}),
    ],
)  # fmt: skip
def test_a_bad_question_is_refused(query: str, keys: dict[str, Any], runs: Path, run: Path) -> None:
    with pytest.raises(QuestionError):
        ask(runs, query, run=run.name, **keys)


def test_an_overlay_of_seven_runs_is_refused(runs: Path, run: Path) -> None:
    with pytest.raises(QuestionError):
        ask(runs, "overlay", runs=[f"r{n}" for n in range(7)], against="load")




def test_a_run_in_which_nothing_is_mounted_yet_is_shown(tmp_path: Path) -> None:
    folder = small_run(tmp_path / RUN.name, ([], []), rows=0)
    with sqlite3.connect(folder / "run.db") as database:
        database.execute("DELETE FROM piece")
    page = ask(tmp_path, "run", run=folder.name)
    assert len(page["conditions"]) == 2 and "wheel" not in {region["kind"] for region in page["regions"]}
