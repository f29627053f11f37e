"""Notes and exclusions on the run under way: on record with the sender, in the tables; bad ones are refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tester.results.run_results import results_of
from tester.results.verify import verify
from tester.service.commands import AddNote, ExcludeRepeat, Hold, Release, RigAction, RunRecipe, Stop
from tester.service.state_view import StateView
from tester.store.notes import notes_of, tags_of
from tester.store.run_reader import RunReader
from tests.tester.kinds.wheel_on_belt.bench import QUIET, SHORT
from tests.tester.service.stage import Script, Stage, play

LONG = SHORT.replace("repeats: 1", "repeats: 3").replace("window: 14 rev", "window: 5 rev")
RUN = RunRecipe("long", text=LONG, seed=1, speed=None, yes=True)
WHO = "user id 1000"


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.tester.service.stage.MOST_POLLS", 2_000_000)  # meanwhile a thread reads the record


def in_mode(mode: str) -> Callable[[StateView], bool]:
    return lambda view: view.mode == mode


def over(view: StateView) -> bool:
    return view.run is not None and view.run.exit is not None


def answered(stage: Stage, action: RigAction) -> Script:
    """Send an order of a client with a known user, and wait for its answer."""
    stage.accepted.pop(action.command, None)
    stage.refused.pop(action.command, None)
    yield replace(stage.order(action, 2), peer=WHO)
    while action.command not in stage.accepted and action.command not in stage.refused:
        yield None


def held_after_two_repeats(stage: Stage) -> Script:
    """Begin a run and hold it once two repeats are committed."""
    yield stage.order(RUN)
    while len(stage.texts("repeat")) < 2:
        yield None
    yield stage.order(Hold())
    yield from stage.until(in_mode("HOLD"))


def name_of(stage: Stage) -> str:
    run = stage.views[-1].run
    assert run is not None
    return run.name


def folder_of(stage: Stage) -> Path:
    run = stage.views[-1].run
    assert run is not None
    return Path(run.folder)


def test_a_note_and_an_exclusion_are_on_record_with_the_person_and_in_the_tables(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from held_after_two_repeats(stage)
        name = name_of(stage)
        yield from answered(stage, ExcludeRepeat(name, 1, "debris", repeat=1))
        yield from answered(stage, AddNote(name, "the belt was swept", ("swept",)))
        yield stage.order(Release())
        yield from stage.until(over)

    stage = play(tmp_path, script, *QUIET)
    assert stage.accepted["exclude"] == {"repeats": 1} and "note" in stage.accepted
    assert f"condition 1, repeat 1 excluded by client 2 ({WHO}): debris" in stage.texts("exclusion")
    folder = folder_of(stage)
    with RunReader(folder) as reader:
        (exclusion,) = reader.exclusions()
        assert (exclusion.target[:2], exclusion.reason, exclusion.operator) == ((1, 1), "debris", f"client 2 ({WHO})")
        assert exclusion.utc.startswith("20")
        note = notes_of(reader)[-1]
        assert (note.text, note.by, note.tags) == ("the belt was swept", f"client 2 ({WHO})", ("swept",))
        assert tags_of(reader) == ["swept"]
        measured = next(iter(results_of(reader).conditions()))
    assert "excluded" in measured.result.flags and measured.exclusion(measured.repeats[0])
    assert "debris" in (folder / "repeats.csv").read_text("utf-8")
    assert verify(folder).problems == ()


def test_a_repeat_may_be_included_again_while_the_run_continues(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from held_after_two_repeats(stage)
        name = name_of(stage)
        yield from answered(stage, ExcludeRepeat(name, 1, "debris"))
        assert stage.accepted["exclude"] == {"repeats": 2}
        yield from answered(stage, ExcludeRepeat(name, 1, "it was none", repeat=2, include=True))
        yield stage.order(Stop())
        yield from stage.until(over)

    stage = play(tmp_path, script, *QUIET)
    assert stage.accepted["exclude"] == {"repeats": 1}
    with RunReader(folder_of(stage)) as reader:
        assert [(one.repeat, one.excluded) for one in reader.exclusions()] == [(1, 1), (2, 1), (2, 0)]
    assert verify(folder_of(stage)).problems == ()


def test_impossible_edits_are_refused_with_a_reason_and_not_recorded(tmp_path: Path) -> None:
    why: dict[str, str] = {}

    def script(stage: Stage) -> Script:
        yield from held_after_two_repeats(stage)
        name = name_of(stage)
        for what, action in {
            "another": AddNote("2020-01-01T00-00-00-other", "x"),
            "empty": AddNote(name, " "),
            "tag": AddNote(name, "", ("two words",)),
            "reason": ExcludeRepeat(name, 1, " ", repeat=1),
            "future": ExcludeRepeat(name, 1, "x", repeat=3),
            "none": ExcludeRepeat(name, 9, "x"),
            "included": ExcludeRepeat(name, 1, "x", repeat=1, include=True),
        }.items():
            yield from answered(stage, action)
            why[what] = stage.refused[action.command]
        yield stage.order(Stop())
        yield from stage.until(over)
        yield from answered(stage, AddNote(name, "too late"))
        why["over"] = stage.refused["note"]

    folder = folder_of(play(tmp_path, script, *QUIET))
    assert "is not under way here" in why["another"] and why["over"] == f"{folder.name} is not under way here"
    assert "expected a text" in why["empty"] and "expected a word" in why["tag"] and "a reason" in why["reason"]
    assert why["future"] == "1/3 is not a committed repeat: condition 1 has repeats 1, 2"
    assert "no committed repeat" in why["none"] and "has not been excluded" in why["included"]
    with RunReader(folder) as reader:
        assert reader.exclusions() == [] and [note for note in notes_of(reader) if note.by] == []


def test_an_exclusion_in_a_part_of_a_simulated_run_is_refused(tmp_path: Path) -> None:
    two = LONG.replace('  - compound: "1#"\n', '  - compound: "1#"\n  - compound: "2#"\n')

    def script(stage: Stage) -> Script:
        yield stage.order(replace(RUN, text=two))
        yield from stage.until(in_mode("RUN"))
        yield from answered(stage, ExcludeRepeat(name_of(stage), 1, "debris"))
        yield from answered(stage, AddNote(name_of(stage), "swept"))
        yield stage.order(Stop())
        yield from stage.until(over)

    stage = play(tmp_path, script, *QUIET)
    assert "recorded in parts" in stage.refused["exclude"]
    with RunReader(folder_of(stage)) as reader:
        assert notes_of(reader)[-1].text == "swept"
