"""``tester results exclude`` and ``tester results include``: output and effect."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tester.base.lock import RUN_LOCK, ExclusiveUse
from tester.cli.main import invoke
from tester.service.address import HAS_UNIX
from tester.service.commands import AddNote, ExcludeRepeat
from tester.store.notes import notes_of
from tester.store.run_reader import RunReader
from tests.tester.service.fake import FakeService
from tests.tester.service.views import state
from tests.tester.store.build import small_run


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder whose runs/ holds one finished run, ``one``."""
    monkeypatch.chdir(tmp_path)
    small_run(tmp_path / "runs" / "one", ([0.90, 0.91, 0.89], [0.70, 0.74, 0.72, 0.73]))
    return tmp_path


def said(*arguments: str) -> int:
    return invoke(["results", *arguments, "--operator", "ada [b]"])


def test_it_prints_the_new_result_of_the_condition(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert said("exclude", "one", "2/1", "--reason", "debris") == 0
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.startswith("2/1 excluded: 1#, 300 mm/s, 200 N, 25 degC: ok")
    told, head = captured.err.splitlines()
    with RunReader(home / "runs" / "one") as reader:
        assert told.endswith("valid 3 of 3") and head == f"record head: {reader.record_head()}"


def test_show_lists_every_exclusion_with_person_and_reason(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert said("exclude", "one", "2/1", "--reason", "debris") == said("include", "one", "2/1", "--reason", "none") == 0
    assert invoke(["show", "one"]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("2/1 ")]
    assert [line.split()[1] for line in lines] == ["excluded", "included"]
    assert lines[0].endswith("by ada [b]: debris") and lines[1].endswith("by ada [b]: none")


def test_show_as_json_has_the_words_and_the_repeats_exclusion(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert said("exclude", "one", "2/1", "--reason", "debris") == 0
    assert invoke(["show", "one", "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert [(word["condition"], word["repeat"], word["excluded"]) for word in shown["exclusions"]] == [(2, 1, True)]
    assert shown["conditions"][1]["repeats"][0]["exclusion"] == "excluded by hand: debris"


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("exclude", "one", "2/1"), 2, "--reason"),
        (("exclude", "one", "2-1", "--reason", "x"), 2, "CONDITION/REPEAT"),
        (("exclude", "none", "2/1", "--reason", "x"), 2, "no run none"),
        (("exclude", "one", "9/1", "--reason", "x"), 1, "not a committed repeat"),
        (("include", "one", "2/1", "--reason", "x"), 1, "has not been excluded"),
    ],
)
def test_mistakes_are_reported(
    arguments: tuple[str, ...], code: int, message: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["results", *arguments]) == code
    assert message in capsys.readouterr().err


# A run under way: its service writes

posix = pytest.mark.skipif(not HAS_UNIX, reason="Unix sockets")


@pytest.fixture
def live(home: Path, folder: Path) -> Iterator[str]:
    """Return the name of a run in progress: the one that the played service shows."""
    shown = state().run
    assert shown is not None
    run = small_run(home / shown.folder)
    with ExclusiveUse() as use:
        use.lock_file(shown.name, run / RUN_LOCK, shown.name, lasting=False)
        yield shown.name


@posix
def test_an_exclusion_on_a_run_under_way_goes_to_its_service(
    live: str, fake: FakeService, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (Path("runs") / live / "run.db").read_bytes()
    assert said("exclude", live, "2/1", "--reason", "debris") == said("include", live, "2/1", "--reason", "none") == 0
    assert [order.action for order in fake.orders] == [
        ExcludeRepeat(live, 2, "debris", 1), ExcludeRepeat(live, 2, "none", 1, include=True)
    ]  # fmt: skip
    err = capsys.readouterr().err
    assert err.startswith("2/1 excluded: 1#, ") and "its tables are made anew at the run's end" in err
    assert (Path("runs") / live / "run.db").read_bytes() == before


@posix
def test_a_note_goes_there_under_the_operators_name(live: str, fake: FakeService) -> None:
    assert said("note", live, "belt swept", "--tag", "swept") == 0
    (order,) = fake.orders
    assert order.action == AddNote(live, "belt swept", ("swept",))
    assert order.name.startswith("ada [b] at ") and order.name.endswith(" (command)")


@posix
def test_the_notes_of_a_run_under_way_are_printed_without_a_service(
    live: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["results", "note", live]) == 0
    assert capsys.readouterr().out.endswith("tags: none\n")


@posix
def test_a_refusal_of_the_service_has_its_reason(
    live: str, fake: FakeService, capsys: pytest.CaptureFixture[str]
) -> None:
    fake.refusals["exclude"] = "this simulated run is recorded in parts: exclude the repeat after its end"
    assert said("exclude", live, "2/1", "--reason", "debris") == 1
    assert capsys.readouterr().err == f"refused: {fake.refusals['exclude']}\n"


@posix
@pytest.mark.parametrize("command", [("exclude", "2/1", "--reason", "x"), ("note", "x")])
def test_without_a_service_it_names_the_process_and_changes_nothing(
    command: tuple[str, ...], live: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert said(command[0], live, *command[1:]) == 4
    err = capsys.readouterr().err
    assert f"{live} is under way: process " in err and "no service answers: wait for its end, or --connect" in err
    with RunReader(Path("runs") / live) as reader:
        assert reader.exclusions() == [] and notes_of(reader) == []


@posix
def test_another_run_of_the_service_gets_nothing(
    live: str, fake: FakeService, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = small_run(tmp_path / "elsewhere" / live)  # of the same name, in another folder
    with ExclusiveUse() as use:
        use.lock_file(live, run / RUN_LOCK, live, lasting=False)
        assert said("exclude", str(run), "2/1", "--reason", "x") == 1
    assert "not at this service" in capsys.readouterr().err and fake.orders == []
