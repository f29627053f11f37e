"""A session: the files in a run's folder, and its exit codes."""

from __future__ import annotations

import errno
import os
import re
import shutil
import signal
import sqlite3
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from tester.analysis.flags import CARRY_OVER
from tester.base.processes import HANG_UP
from tester.base.source import InvalidSource
from tester.cli.ending import ending_lines
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.context import Attendant
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.run.past_runs import heating_data
from tester.machine.context import Progress
from tester.machine.rig_ports import Ports
from tester.machine.tickers import TickedWorld
from tester.machine.time_left import RunPosition
from tester.run import folder as folder_module
from tester.run import part_run
from tester.run.bus_log import BusLog
from tester.run.folder import make_folder
from tester.run.reporter import ReportScreen
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.run.simulated import simulated_ports
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter
from tests.tester.kinds.wheel_on_belt.bench import HOT, QUIET, SHORT
from tests.tester.store.build import CONDITION, RUN, SPECIMENS, open_writer, record

TABLES = ("appendix.csv", "conditions.csv", "repeats.csv")


class Screen(ReportScreen):
    """Keeps its messages."""

    def __init__(self, *, answer_yes: bool = True) -> None:
        self.answer_yes = answer_yes
        self.messages: list[str] = []
        self.records: list[dict[str, object]] = []
        self.results: list[str] = []

    def begin(self, name: str) -> None:
        self.messages.append(f"begin {name}")

    def message(self, text: str) -> None:
        self.messages.append(text)

    def emit(self, record: dict[str, object]) -> None:
        self.records.append(record)

    def result(self, line: str) -> None:
        self.results.append(line)


class Ended:
    """Results of a session."""

    def __init__(self, code: int, screen: Screen, out: Path) -> None:
        self.code, self.screen, self.out = code, screen, out

    @property
    def folder(self) -> Path:
        return Path(self.screen.results[0])

    def stored(self) -> tuple[str, str]:
        with RunReader(self.folder / "run.db") as reader:
            return reader.run().status, reader.run().reason

    def status(self) -> str:
        with RunReader(self.folder / "run.db") as reader:
            return reader.run().status


def run(home: Path, *overrides: str, seed: int = 0, text: str = SHORT, screen: Screen | None = None) -> Ended:
    """Run a recipe in ``home`` to its end."""
    home.mkdir(parents=True, exist_ok=True)
    recipe = home / "short.yaml"
    recipe.write_text(text, encoding="utf-8")
    screen = screen or Screen()
    options = SessionOptions(recipe=str(recipe), out=home / "runs", overrides=overrides, seed=seed)
    return Ended(Session(options, screen).run(), screen, home / "runs")


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Ended:
    """A complete run."""
    return run(tmp_path_factory.mktemp("done"), *QUIET)


@pytest.fixture(scope="module")
def incomplete(tmp_path_factory: pytest.TempPathFactory) -> Ended:
    """A run whose only condition cannot be held: on the hot rig 3# at 400 N leaves the band within one turn."""
    text = SHORT.replace("1#", "3#").replace("200 N", "400 N")
    return run(tmp_path_factory.mktemp("incomplete"), *HOT, text=text)


@pytest.fixture(scope="module")
def undecided(tmp_path_factory: pytest.TempPathFactory) -> Ended:
    """A run on the default rig, whose window is too short to show that the coefficient is constant."""
    return run(tmp_path_factory.mktemp("undecided"), seed=1)


Prepare = Callable[[TickedWorld, Attendant], Attendant]


@pytest.fixture
def at_the_rig(monkeypatch: pytest.MonkeyPatch) -> Callable[[Prepare], None]:
    """Call a function with the simulated rig before the run begins; it returns the rig's hands."""

    def arrange(prepare: Prepare) -> None:
        def connect(rig: RigConfig, seed: int, log: BusLog | None, **_: object) -> tuple[Ports, TickedWorld, Attendant]:
            ports, world, attendant = simulated_ports(rig, seed, log)
            return ports, world, prepare(world, attendant)

        monkeypatch.setattr(part_run, "connect_ports", connect)

    return arrange


class Interrupting:
    """Hands at the rig that send signals to this process when a repeat begins."""

    def __init__(self, hands: Attendant, *signals: int) -> None:
        self.hands, self.signals = hands, signals

    def install(self, specimen: int, wheel: int, compound: str, *, new_specimen: bool) -> None:
        self.hands.install(specimen, wheel, compound, new_specimen=new_specimen)

    def keep(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        self.hands.keep(specimen, wheel, compound, diameter_mm, sliding_m)

    def begin_repeat(self, condition: int, repeat: int, attempt: int, held: Mapping[str, float]) -> None:
        self.hands.begin_repeat(condition, repeat, attempt, held)
        for number in self.signals:
            signal.raise_signal(number)


# -- the folder ---------------------------------------------------------------------------------------------------


def test_a_complete_run_exits_0(done: Ended) -> None:
    assert done.code == 0 and done.status() == "done"


def test_the_folder_is_named_by_date_and_recipe(done: Ended) -> None:
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d-?\d\d-?\d\d-short", done.folder.name)
    assert done.folder.parent == done.out


def test_the_folder_holds_inputs_and_results(done: Ended) -> None:
    names = {path.name for path in done.folder.iterdir()}
    assert names >= {"run.db", "recipe.yaml", "rig.yaml", "manifest.json", *TABLES}
    assert (done.folder / "recipe.yaml").read_text(encoding="utf-8") == SHORT


def test_the_folder_is_given_as_the_result(done: Ended) -> None:
    assert done.screen.results == [str(done.folder)] and done.screen.records[-1]["exit"] == 0


def test_the_table_holds_the_condition(done: Ended) -> None:
    lines = (done.folder / "appendix.csv").read_text(encoding="utf-8-sig").splitlines()
    assert len(lines) == 2 and lines[1] == "1#,300,200,0,25,0.73"


def test_the_store_knows_seed_recipe_and_drive_parameters(done: Ended) -> None:
    with sqlite3.connect(done.folder / "run.db") as database:
        (count,) = database.execute("SELECT count(*) FROM device_parameter WHERE device = 'wheel'").fetchone()
        seed, text = database.execute("SELECT seed, recipe_text FROM run").fetchone()
    assert count > 5 and seed == 0 and text == SHORT


@pytest.mark.parametrize(
    "name, slug",
    [("Table 2, compound 1#", "table-2-compound-1"), ("../../etc", "etc"), ("°°", "run"), ("a" * 100, "a" * 40)],
)
def test_no_recipe_name_leads_out_of_the_folder(tmp_path: Path, name: str, slug: str) -> None:
    folder = make_folder(tmp_path / "runs", name)
    assert folder.parent == tmp_path / "runs" and folder.name.endswith(f"-{slug}")


def test_two_runs_of_one_second_have_two_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(folder_module.clock, "local_stamp", lambda: "2024-02-21T14-05-09")
    assert [make_folder(tmp_path, "x").name for _ in range(3)] == [
        "2024-02-21T14-05-09-x",
        "2024-02-21T14-05-09-x-2",
        "2024-02-21T14-05-09-x-3",
    ]


# -- exit codes ---------------------------------------------------------------------------------------------------


def test_missing_conditions_exit_6_and_are_named(incomplete: Ended) -> None:
    assert incomplete.code == 6
    assert any("400 N" in text and "temperature cannot be held" in text for text in incomplete.screen.messages)
    assert len((incomplete.folder / "appendix.csv").read_text(encoding="utf-8-sig").splitlines()) == 1


def test_a_drift_that_is_not_shown_is_a_row_with_a_flag(undecided: Ended) -> None:
    assert undecided.code == 0
    assert "drift not shown" in (undecided.folder / "conditions.csv").read_text(encoding="utf-8-sig")
    assert len((undecided.folder / "appendix.csv").read_text(encoding="utf-8-sig").splitlines()) == 2


def test_tried_conditions_are_listed_and_the_others_share_a_line(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [replace(CONDITION, condition=i, row=i) for i in range(1, 166)])
    record(writer, 1, [0.9] * 3)
    record(writer, 2, [float("nan")])
    record(writer, 3, [0.9] * 3, flags=CARRY_OVER)
    writer.finish("done", rig_seconds=60.0)  # interrupted before its tables
    writer.close()
    screen = Screen()
    Session(SessionOptions(), screen).resume(tmp_path)
    lost, doubted = screen.messages
    assert "none of 1 repeats is valid" in lost and "max_bursts" in lost
    assert "carry-over" in doubted and "pre_grind" in doubted
    (end,) = (event for event in screen.records if event["event"] == "end")
    assert len(end["missing"]) == 163  # type: ignore[arg-type]


def test_no_person_to_ask_is_a_usage_error_without_a_trace(tmp_path: Path) -> None:
    ended = run(tmp_path, screen=Screen(answer_yes=False))
    assert ended.code == 2 and not ended.out.exists()
    assert ended.screen.messages == ["the recipe has prompts, and this is no interactive terminal: use --yes"]


def test_an_invalid_recipe_is_refused_without_a_trace(tmp_path: Path) -> None:
    with pytest.raises(InvalidSource):
        run(tmp_path, text=SHORT.replace("200 N", "200 kg"))
    assert not (tmp_path / "runs").exists()


def test_a_rig_that_does_not_answer_exits_4(tmp_path: Path, at_the_rig: Callable[[Prepare], None]) -> None:
    def dark(world: TickedWorld, hands: Attendant) -> Attendant:
        world.axes["belt"].power(False)  # type: ignore[attr-defined]
        return hands

    at_the_rig(dark)
    ended = run(tmp_path)
    assert ended.code == 4 and ended.status() == "rig unreachable"
    assert any("belt drive (node 2)" in text for text in ended.screen.messages)


def test_a_guard_that_is_open_from_the_start_exits_4_and_is_reported(
    tmp_path: Path, at_the_rig: Callable[[Prepare], None]
) -> None:
    def open_guard(world: TickedWorld, hands: Attendant) -> Attendant:
        world.axes["press"].set_guard(False)  # type: ignore[attr-defined]
        return hands

    at_the_rig(open_guard)
    ended = run(tmp_path)
    assert ended.code == 4 and any("guard" in text for text in ended.screen.messages)


def test_a_trip_exits_5_with_its_cause(tmp_path: Path, at_the_rig: Callable[[Prepare], None]) -> None:
    class OpensTheGuard:
        def __init__(self, world: TickedWorld, hands: Attendant) -> None:
            self.world = world
            self.install, self.remount = hands.install, hands.remount

        def begin_repeat(self, condition: int, repeat: int, attempt: int, held: Mapping[str, float]) -> None:
            self.world.axes["press"].set_guard(False)  # type: ignore[attr-defined]

    at_the_rig(OpensTheGuard)
    ended = run(tmp_path)
    assert ended.code == 5 and ended.status() == "tripped"
    assert any(text.startswith("tripped: guard open") for text in ended.screen.messages)


@pytest.mark.parametrize(
    "signals, code",
    [((signal.SIGINT,), 130), ((signal.SIGINT, signal.SIGINT), 5), ((signal.SIGTERM,), 5)],
)
def test_signals_stop_a_run(
    tmp_path: Path, at_the_rig: Callable[[Prepare], None], signals: tuple[int, ...], code: int
) -> None:
    at_the_rig(lambda _, hands: Interrupting(hands, *signals))
    ended = run(tmp_path)
    assert ended.code == code and ended.status() == "stopped"


def test_a_run_interrupted_by_an_error_can_be_resumed(tmp_path: Path) -> None:
    with pytest.raises(KeyError):
        run(tmp_path, *QUIET, screen=Breaking(KeyError("a bug")))
    (folder,) = (tmp_path / "runs").iterdir()
    assert Session(SessionOptions(), Screen()).resume(folder) == 0


@pytest.mark.skipif(not HANG_UP, reason="this system has no SIGHUP")
def test_a_closed_terminal_stops_a_run_as_termination_does(
    tmp_path: Path, at_the_rig: Callable[[Prepare], None]
) -> None:
    at_the_rig(lambda _, hands: Interrupting(hands, HANG_UP))
    before = signal.signal(HANG_UP, signal.SIG_DFL)
    try:
        ended = run(tmp_path)
    finally:
        signal.signal(HANG_UP, before)
    assert ended.code == 5 and ended.stored() == ("stopped", "the terminal is gone")


@pytest.mark.parametrize("cools, signals", [(True, (signal.SIGINT,)), (False, (signal.SIGINT, signal.SIGTERM))])
def test_termination_after_an_interrupt_takes_the_cool_down_away(
    tmp_path: Path, at_the_rig: Callable[[Prepare], None], cools: bool, signals: tuple[int, ...]
) -> None:
    at_the_rig(lambda _, hands: Interrupting(hands, *signals))
    ended = run(tmp_path, "interlocks.cooldown_hub=26 degC", text=SHORT.replace("25 degC", "30 degC"))
    with RunReader(ended.folder) as reader:
        assert any("cooldown" in event.text for event in reader.events()) is cools


class Breaking(Screen):
    """Fails when a repeat is shown."""

    def __init__(self, error: Exception) -> None:
        super().__init__()
        self.error = error

    def show(self, now_s: float, run: Progress, at: RunPosition) -> None:
        if run.repeat:
            raise self.error


def test_a_run_that_can_no_longer_be_shown_stops_in_a_controlled_way(tmp_path: Path) -> None:
    ended = run(tmp_path, "interlocks.cooldown_hub=26 degC", screen=Breaking(BrokenPipeError(32, "Broken pipe")))
    assert ended.code == 5 and ended.stored() == ("stopped", "the run can no longer be shown: its reader is gone")


def test_an_unexpected_error_leaves_an_interrupted_run_and_a_safe_rig(tmp_path: Path) -> None:
    with pytest.raises(KeyError, match="a bug"):
        run(tmp_path, screen=Breaking(KeyError("a bug")))
    (folder,) = (tmp_path / "runs").iterdir()
    with RunReader(folder) as reader:
        stored, events = reader.run(), [event.text for event in reader.events()]
    assert (stored.status, stored.reason) == ("interrupted", "the program broke off: KeyError: 'a bug'")
    assert events[-1] == "the program broke off: KeyError: 'a bug': safe outputs sent"


HANDLER_BEFORE = signal.getsignal(signal.SIGINT)
"""A process started in the background by a shell ignores the key."""


def test_the_handlers_of_before_are_back_after_a_run(done: Ended) -> None:
    assert signal.getsignal(signal.SIGINT) is HANDLER_BEFORE


def test_a_store_that_cannot_be_written_fails_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write = RunWriter._write_transaction  # pyright: ignore[reportPrivateUsage]

    def full(writer: RunWriter) -> None:
        if any("INSERT INTO repeat" in sql for batch in writer._batches for sql, _ in batch.statements):  # pyright: ignore[reportPrivateUsage]
            raise sqlite3.OperationalError("database or disk is full")
        write(writer)

    monkeypatch.setattr(RunWriter, "_write_transaction", full)
    ended = run(tmp_path)
    assert ended.code == 1
    assert any("not everything could be recorded" in text for text in ended.screen.messages)


class Removing(Screen):
    """Removes the runs when a repeat is shown."""

    def __init__(self, runs: Path) -> None:
        super().__init__()
        self.runs = runs

    def show(self, now_s: float, run: Progress, at: RunPosition) -> None:
        if run.repeat:
            shutil.rmtree(self.runs, ignore_errors=True)


@pytest.mark.skipif(os.name != "posix", reason="Windows removes no file that is open")
def test_a_run_whose_folder_is_removed_stops_in_a_controlled_way_and_reports_it(tmp_path: Path) -> None:
    ended = run(tmp_path, "interlocks.cooldown_hub=26 degC", screen=Removing(tmp_path / "runs"))
    assert ended.code == 1
    (stopped,) = [text for text in ended.screen.messages if text.startswith("stopped: ")]
    assert "the run can no longer be recorded" in stopped and "run.db was removed" in stopped
    assert any("the tables cannot be written" in text for text in ended.screen.messages)


@pytest.mark.skipif(os.name != "posix", reason="a file system of its own")
def test_a_run_on_a_full_disk_stops_in_a_controlled_way_with_its_status_and_reason(tmp_path: Path) -> None:
    def grow(writer: RunWriter) -> None:
        if writer._reserve is not None and any("repeat" in sql for b in writer._batches for sql, _ in b.statements):  # pyright: ignore[reportPrivateUsage]
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        write(writer)

    write = RunWriter._write_transaction  # pyright: ignore[reportPrivateUsage]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(RunWriter, "_write_transaction", grow)
        ended = run(tmp_path, "interlocks.cooldown_hub=26 degC")
    status, reason = ended.stored()
    assert (ended.code, status) == (5, "stopped")
    assert reason.startswith("the run can no longer be recorded: the disk is full: make room")
    assert (ended.folder / "manifest.json").is_file() and not [*ended.folder.glob("*.part")]


# -- determinism --------------------------------------------------------------------------------------------------


def tables(ended: Ended) -> dict[str, bytes]:
    return {name: (ended.folder / name).read_bytes() for name in TABLES}


def test_the_same_seed_gives_the_same_tables_byte_for_byte(tmp_path: Path, undecided: Ended) -> None:
    assert tables(run(tmp_path, seed=1)) == tables(undecided)


def test_another_seed_gives_other_repeats(tmp_path: Path, undecided: Ended) -> None:
    assert tables(run(tmp_path, seed=2))["repeats.csv"] != tables(undecided)["repeats.csv"]


# -- ceilings -------------------------------------------------------------------------------------------------------


LOOSE = "interlocks.hold_at_most=3 h"


def test_an_accepted_risk_is_kept_with_the_run_and_shown_at_its_end(tmp_path: Path) -> None:
    recipe = tmp_path / "short.yaml"
    recipe.write_text(SHORT, encoding="utf-8")
    screen = Screen()
    options = SessionOptions(
        recipe=str(recipe), out=tmp_path / "runs", overrides=(*QUIET, LOOSE), accept_risk="nobody comes"
    )
    assert Session(options, screen).run() == 0
    folder = Path(screen.results[-1])
    told = "interlocks.hold_at_most 10800 s is looser than 7200 s"
    assert f"accepted risk (nobody comes): {told}" in screen.messages
    with RunReader(folder) as reader:
        assert reader.run().info.risk == f"{told} (accepted: nobody comes)"
        assert [event.text for event in reader.events() if event.kind == "risk"] == [reader.run().info.risk]
    header, row, *_ = (folder / "conditions.csv").read_text(encoding="utf-8").splitlines()
    assert "accepted_risk" in header.split(",") and "nobody comes" in row
    assert "RISK ACCEPTED" in "\n".join(ending_lines(folder))


def test_an_unaccepted_risk_begins_nothing(tmp_path: Path) -> None:
    with pytest.raises(InvalidSource, match="hold_at_most"):
        run(tmp_path, *QUIET, LOOSE)
    assert not (tmp_path / "runs").exists()


def test_a_run_without_risks_does_not_mention_them(done: Ended) -> None:
    with RunReader(Path(done.screen.results[-1])) as reader:
        assert reader.run().info.risk == ""
        assert "accepted_risk" not in reader.run().info.metadata


def test_a_run_begins_with_the_heat_evidence_of_the_runs_beside_it(tmp_path: Path) -> None:
    heating = heating_data(load_rig("sim", QUIET), 20.4e3, 20e3, 35.0)
    before = tmp_path / "runs" / "2024-02-21T14-05-09-small"
    before.mkdir(parents=True)
    writer = open_writer(before)
    writer.begin_run(RUN, [], [])
    for _ in range(3):
        writer.event(1.0, "heat", "heat balance", data=heating)
    writer.finish("done", "", 2.0)
    writer.close()
    with RunReader(run(tmp_path, *QUIET).folder) as reader:
        said = [event.text for event in reader.events() if event.kind == "arming"]
    assert "heat balance: known from 3 heatings, ratio 1.02, 0.00 apart; a row tells from 11 %" in said
