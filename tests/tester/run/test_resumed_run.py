"""An interrupted run resumes: at the right repeat, with the same wheel, and only if it is the same test."""

from __future__ import annotations

import shutil
import sqlite3
from dataclasses import replace
from pathlib import Path

import pytest

from tester.analysis.results import RepeatStatus
from tester.cli.main import invoke
from tester.kinds import load_rig
from tester.run.provenance import git_revision, rig_source
from tester.run.session import CannotStartError, Session
from tester.run.session_options import SessionOptions
from tester.store.resumable import resume_point
from tester.store.run_reader import RunReader
from tests.tester.run.cut_short import SETS, TEXT, cut_short
from tests.tester.run.test_session import Screen

SETS_ARGUMENTS = [argument for override in SETS for argument in ("--set", override)]


@pytest.fixture(scope="module")
def cut(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that died in the middle of its second repeat."""
    return cut_short(tmp_path_factory.mktemp("cut"))


@pytest.fixture
def again(cut: Path, tmp_path: Path) -> Path:
    """A copy of that run, to be resumed."""
    shutil.copytree(cut, tmp_path / cut.name)
    return tmp_path / cut.name


def resume(folder: Path, reason: str = "") -> tuple[int, Screen]:
    screen = Screen()
    return Session(SessionOptions(), screen).resume(folder, reason), screen


def test_committed_repeats_are_known(cut: Path) -> None:
    with RunReader(cut) as reader:
        point = resume_point(reader)
    assert not point.finished and point.next_repeat == (1, 2) and point.session == 2
    assert len(point.conditions[1].results) == 1 and point.conditions[1].attempts == {1: 1, 2: 1}
    (wheel,) = point.stand.mounted
    assert wheel.number == 1 and 0.0 < 90.0 - wheel.diameter_mm < 0.1 and wheel.sliding_m > 0.5


def test_a_run_resumes_at_the_first_uncommitted_repeat(again: Path) -> None:
    code, screen = resume(again)
    assert code == 0 and screen.results == [str(again)]
    assert "resumes at repeat 2 of condition 1" in screen.messages[0]
    with RunReader(again) as reader:
        repeats = reader.repeats(attempts=True)
        (condition,) = reader.conditions()
        first, second = reader.sessions()
    assert [(r.repeat, r.attempt, r.result.status) for r in repeats] == [
        (1, 1, RepeatStatus.VALID),
        (2, 1, RepeatStatus.VOID),
        (2, 2, RepeatStatus.VALID),
        (3, 1, RepeatStatus.VALID),
    ]
    assert condition.status is not None and condition.status.value == "ok"
    # Rig time continues: nothing of the second stretch lies before the end of the first.
    assert first.origin_s == 0.0 and second.origin_s > repeats[1].begun_s - 1.0
    assert repeats[0].result.ended_s < second.origin_s < repeats[2].result.started_s


def test_the_tables_hold_every_repeat_of_both_stretches(again: Path) -> None:
    resume(again)
    assert len((again / "repeats.csv").read_text(encoding="utf-8").splitlines()) == 4
    assert len((again / "appendix.csv").read_text(encoding="utf-8-sig").splitlines()) == 2
    assert invoke(["verify", str(again)]) == 0


def test_a_run_that_was_cut_off_between_its_end_and_its_tables_gets_them(again: Path) -> None:
    resume(again)
    tables = {name: (again / name).read_bytes() for name in ("appendix.csv", "conditions.csv", "repeats.csv")}
    for name in (*tables, "manifest.json"):
        (again / name).unlink()
    resume(again)
    assert {name: (again / name).read_bytes() for name in tables} == tables
    assert (again / "manifest.json").is_file()


def test_times_of_samples_and_events_do_not_go_back(again: Path) -> None:
    resume(again)
    with RunReader(again) as reader:
        times = [t for block in reader.sample_blocks() for t in block.columns["time_s"]]
    assert times == sorted(times) and len(set(times)) == len(times)


def test_the_wheel_and_its_reference_tare_stay(again: Path) -> None:
    with RunReader(again) as reader:
        (before,) = reader.pieces()
    resume(again)
    with RunReader(again) as reader:
        (after,) = reader.pieces()
        tares = [tare.kind for tare in reader.tares()]
    assert after.installed_s == before.installed_s and after.sliding_m > before.sliding_m
    assert after.diameter_mm < before.diameter_mm and tares.count("reference") == 1


def test_a_run_that_is_complete_is_left_alone(again: Path) -> None:
    resume(again)
    before = (again / "manifest.json").read_bytes()
    code, screen = resume(again)
    assert code == 0 and screen.results == [str(again)]
    assert (again / "manifest.json").read_bytes() == before


def test_a_run_under_way_is_not_resumed(again: Path) -> None:
    from tester.base.lock import RUN_LOCK, ExclusiveUse

    with ExclusiveUse() as use:
        use.lock_file("x", again / RUN_LOCK, "x", lasting=False)
        with pytest.raises(CannotStartError, match="is in use: process"):
            resume(again)


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


@pytest.mark.parametrize(
    "name, old, new, subjects",
    [
        ("recipe.yaml", "recipe: short", "recipe: another name", ["recipe"]),
        ("rig.yaml", "emissivity: 0.95", "emissivity: 0.93", ["rig", "calibration"]),
        ("rig.yaml", "outer_gain:", "outer_gain: 1.25 #", ["rig"]),
    ],
)
def test_changes_are_refused_unless_a_reason_is_given_and_stored(
    again: Path, name: str, old: str, new: str, subjects: list[str]
) -> None:
    edit(again / name, old, new)
    with pytest.raises(CannotStartError, match=f"{subjects[0]}.* changed since the run began .*{name}.*--reason") as no:
        resume(again)
    assert no.value.code == 3
    assert resume(again, "the thermometer was cleaned")[0] == 0
    with RunReader(again) as reader:
        changes = reader.changes()
    assert [change.subject for change in changes] == subjects
    assert {change.reason for change in changes} == {"the thermometer was cleaned"}
    assert all(change.before_sha256 != change.after_sha256 for change in changes)
    assert invoke(["verify", str(again)]) == 0


def test_a_risk_is_asked_for_again_and_is_in_the_record_and_every_table(again: Path) -> None:
    edit(again / "rig.yaml", "hold_at_most:", "hold_at_most: 3 h #")
    with pytest.raises(CannotStartError, match=r"hold_at_most.*--accept-risk REASON"):
        resume(again, "longer holds")
    session = Session(SessionOptions(accept_risk="nobody comes"), Screen())
    assert session.resume(again, "longer holds") == 0
    with RunReader(again) as reader:
        risk = reader.run().info.risk
    assert "hold_at_most 10800 s is looser than 7200 s" in risk and "nobody comes" in risk
    for name in ("appendix.csv", "repeats.csv", "wheel.csv", "conditions.csv"):
        header, *rows = (again / name).read_text(encoding="utf-8-sig").splitlines()
        assert "accepted_risk" in header and rows and all("nobody comes" in row for row in rows)


def test_a_recipe_file_that_was_edited_after_the_start_is_found(again: Path, cut: Path) -> None:
    source = cut.parent.parent / "short.yaml"
    edit(source, "recipe: short", "recipe: shorter")
    try:
        with pytest.raises(CannotStartError, match=r"the original of recipe\.yaml"):
            resume(again)
    finally:
        edit(source, "recipe: shorter", "recipe: short")


def test_another_test_is_refused_whatever_the_reason(again: Path) -> None:
    edit(again / "recipe.yaml", "load: 50 N", "load: 60 N")
    with pytest.raises(CannotStartError, match="condition 1, which has measurements"):
        resume(again, "no reason will do")


def test_the_command_exits_3_for_a_change_and_names_it(again: Path, capsys: pytest.CaptureFixture[str]) -> None:
    edit(again / "recipe.yaml", "recipe: short", "recipe: another name")
    assert invoke(["resume", str(again), "--yes"]) == 3
    assert "recipe changed since the run began" in capsys.readouterr().err


def test_the_command_prints_the_folder_last(again: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["resume", str(again), "--yes", "--json"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == str(again)


def test_no_run_is_a_usage_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["resume", str(tmp_path / "nothing"), "--yes"]) == 2


def test_verify_names_changed_files(again: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["verify", str(again)]) == 6  # interrupted, but valid up to there
    resume(again)
    with (again / "conditions.csv").open("a") as file:
        file.write("1\n")
    edit(again / "recipe.yaml", "recipe: short", "recipe: other")
    assert invoke(["verify", str(again)]) == 1
    told = capsys.readouterr().err
    assert "conditions.csv: changed" in told and "recipe.yaml: not what the run was made with" in told


def test_verify_finds_a_damaged_sample_block(again: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with sqlite3.connect(again / "run.db") as database:
        database.execute("UPDATE sample_block SET data = substr(data, 1, length(data) - 5) WHERE id = 2")
    assert invoke(["verify", str(again)]) == 1
    assert "block 2" in capsys.readouterr().err


def test_a_run_knows_where_its_numbers_come_from(cut: Path) -> None:
    with RunReader(cut) as reader:
        run, parameters = reader.run(), list(reader.parameters())
        prompts, calibration = list(reader.prompts()), reader.calibration()
    assert run.info.rig_source.startswith("sim sim.noise=0") and run.info.recipe_source.endswith("short.yaml")
    assert run.info.git_revision == git_revision() and "numpy" in run.info.versions
    assert {p.device for p in parameters} >= {"wheel", "belt", "press", "load cell", "jacket"}
    assert [(p.text, p.answer) for p in prompts] == [("install wheel 1: 1#", "yes (automatic)")]
    assert ("infrared thermometer", "emissivity", "0.95") in [(c.device, c.quantity, c.value) for c in calibration]


def test_too_little_room_is_refused_with_the_numbers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import tester.store.disk as space

    usage = shutil.disk_usage(tmp_path)
    monkeypatch.setattr(space.shutil, "disk_usage", lambda _path: usage._replace(free=1_000_000))
    (tmp_path / "short.yaml").write_text(TEXT, encoding="utf-8")
    assert invoke(["run", str(tmp_path / "short.yaml"), "--yes", "--out", str(tmp_path / "runs")]) == 1
    assert "1.0 MB free" in capsys.readouterr().err
    assert list((tmp_path / "runs").iterdir()) == []


def test_the_source_of_a_rig_keeps_its_overrides() -> None:
    assert rig_source("sim", ("sim.noise=0", "a b")) == "sim sim.noise=0 'a b'"


def test_a_rig_read_back_from_its_own_text_is_the_same() -> None:
    from tester.kinds import load_rig_text

    rig = load_rig("sim", SETS)
    assert load_rig_text(rig.text).text == rig.text and replace(rig) == load_rig_text(rig.text)
