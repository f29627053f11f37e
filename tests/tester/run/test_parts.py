"""A run of several parts from the outside: the same results with one job and with several, and early ends."""

from __future__ import annotations

import json
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
from collections.abc import Callable, Mapping
from contextlib import closing
from pathlib import Path

import pytest

from tester.kinds import hardware_text
from tester.kinds.wheel_on_belt.context import Attendant
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.rig_ports import Ports
from tester.machine.tickers import TickedWorld
from tester.run import part_run
from tester.run.folder import PARTS
from tester.run.merge_parts import recover
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.run.simulated import simulated_ports
from tester.store import record_schema
from tester.store.record_schema import VERSION
from tester.store.run_reader import RunReader
from tests.tester.kinds.wheel_on_belt.bench import AT_ONCE
from tests.tester.run.test_session import TABLES, Ended, Screen

TWO = AT_ONCE.replace('  - compound: "1#"\n', '  - compound: "1#"\n  - compound: "2#"\n').replace("14 rev", "7 rev")
STEADY = ("sim.running_in=0", "sim.scatter=0")
"""A constant coefficient, with the noise of every sensor: the window is soon long enough."""
ROOT = Path(__file__).parents[3]


def run(
    home: Path, *overrides: str, jobs: int = 1, text: str = TWO, screen: Screen | None = None, **options: object
) -> Ended:
    """Run a recipe of two specimens in ``home`` to its end."""
    home.mkdir(parents=True, exist_ok=True)
    recipe = home / "two.yaml"
    recipe.write_text(text, encoding="utf-8")
    screen = screen or Screen()
    bus_log = home / "bus" if options.get("bus_log") else None
    chosen = SessionOptions(str(recipe), overrides=overrides or STEADY, out=home / "runs", jobs=jobs, bus_log=bus_log)
    return Ended(Session(chosen, screen).run(), screen, home / "runs")


@pytest.fixture(scope="module")
def one(tmp_path_factory: pytest.TempPathFactory) -> Ended:
    """Two parts one after the other, on the default rig, with a bus log."""
    return run(tmp_path_factory.mktemp("one"), bus_log=True)


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Ended:
    """The same, side by side."""
    return run(tmp_path_factory.mktemp("two"), jobs=2)


def test_one_job_and_two_give_the_same_tables_byte_for_byte(one: Ended, two: Ended) -> None:
    for name in TABLES:
        assert (one.folder / name).read_bytes() == (two.folder / name).read_bytes()


def test_one_job_and_two_store_the_same_samples_and_events(one: Ended, two: Ended) -> None:
    def stored(ended: Ended) -> tuple[list[object], list[object]]:
        with closing(sqlite3.connect(ended.folder / "run.db")) as database:
            # How samples are cut into blocks depends on when the disk was ready.
            counts = database.execute(
                "SELECT repeat_id, sum(rows), min(first_s), max(last_s) FROM sample_block GROUP BY 1"
            )
            return counts.fetchall(), database.execute("SELECT t_s, kind, text FROM event ORDER BY sequence").fetchall()

    assert stored(one) == stored(two)


def test_nothing_is_left_of_the_parts(one: Ended, two: Ended) -> None:
    for ended in (one, two):
        names = {path.name for path in ended.folder.iterdir()}
        assert "run.db" in names and not [name for name in names if name.startswith(PARTS)]


def test_times_of_the_second_part_follow_those_of_the_first(one: Ended) -> None:
    with RunReader(one.folder) as reader:
        first, second = reader.conditions()
        assert first.ended_s < second.started_s < second.ended_s < reader.run().rig_seconds
        assert [one.piece for one in reader.pieces()] == [1, 2]
        times = reader.samples()["time_s"]
    assert (times[1:] > times[:-1]).all()


def test_every_part_has_a_bus_log_of_its_own(one: Ended) -> None:
    logs = one.out.parent / "bus"
    assert sorted(path.name for path in logs.iterdir()) == ["part-1", "part-2"]
    assert all((logs / part / "can.log").stat().st_size > 10_000 for part in ("part-1", "part-2"))


@pytest.mark.parametrize("ended", ["one", "two"])
def test_the_end_of_every_part_is_reported(ended: str, request: pytest.FixtureRequest) -> None:
    records = request.getfixturevalue(ended).screen.records
    assert sorted(r["part"] for r in records if r["event"] == "part end") == [1, 2]


# -- refusals -----------------------------------------------------------------------------------------------------


def test_several_jobs_without_a_person_to_confirm_are_a_usage_error(tmp_path: Path) -> None:
    ended = run(tmp_path, jobs=2, screen=Screen(answer_yes=False))
    assert ended.code == 2 and not ended.out.exists()
    refusal = "--jobs 2: prompts of several parts at a time cannot be answered; use --yes, or one job"
    assert ended.screen.messages == [refusal]


def test_several_jobs_on_a_real_rig_are_a_usage_error(tmp_path: Path) -> None:
    rig, screen = tmp_path / "real.yaml", Screen()
    rig.write_text(hardware_text(), encoding="utf-8")
    options = SessionOptions("quickstart", str(rig), out=tmp_path / "runs", jobs=2)
    assert Session(options, screen).run() == 2 and not options.out.exists()
    assert screen.messages == ["--jobs 2: only a simulated rig can run several parts at a time, and this rig is real"]


# -- early ends ---------------------------------------------------------------------------------------------------


class Acting:
    """Hands at the rig that call a function when they mount a given wheel."""

    def __init__(self, hands: Attendant, wheel: int, act: Callable[[], object]) -> None:
        self.hands, self.wheel, self.act = hands, wheel, act

    def install(self, specimen: int, wheel: int, compound: str, *, new_specimen: bool) -> None:
        self.hands.install(specimen, wheel, compound, new_specimen=new_specimen)
        if wheel == self.wheel:
            self.act()

    def keep(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        self.hands.keep(specimen, wheel, compound, diameter_mm, sliding_m)

    def begin_repeat(self, condition: int, repeat: int, attempt: int, held: Mapping[str, float]) -> None:
        self.hands.begin_repeat(condition, repeat, attempt, held)

    def belt_travelled(self, travel_m: float) -> None:
        self.hands.belt_travelled(travel_m)


@pytest.fixture
def when_mounted(monkeypatch: pytest.MonkeyPatch) -> Callable[[int, Callable[[TickedWorld], object]], None]:
    """Call a function with the simulated rig when a wheel is mounted."""

    def arrange(wheel: int, act: Callable[[TickedWorld], object]) -> None:
        def connect(rig: RigConfig, seed: int, log: object, **_: object) -> tuple[Ports, TickedWorld, Attendant]:
            ports, world, hands = simulated_ports(rig, seed, None)
            return ports, world, Acting(hands, wheel, lambda: act(world))

        monkeypatch.setattr(part_run, "connect_ports", connect)

    return arrange


def statuses(ended: Ended) -> list[str | None]:
    with RunReader(ended.folder) as reader:
        return [condition.status.value if condition.status else None for condition in reader.conditions()]


def open_guard(world: TickedWorld) -> None:
    world.axes["press"].set_guard(False)  # type: ignore[attr-defined]


def test_a_trip_in_the_first_part_ends_the_run(
    tmp_path: Path, when_mounted: Callable[[int, Callable[[TickedWorld], object]], None]
) -> None:
    when_mounted(1, open_guard)
    ended = run(tmp_path)
    assert ended.code == 5 and ended.status() == "tripped" and statuses(ended) == [None, None]
    assert any(text.startswith("tripped: part 1: guard open") for text in ended.screen.messages)
    assert [r["part"] for r in ended.screen.records if r["event"] == "part end"] == [1]


def test_a_trip_in_the_second_part_keeps_the_results_of_the_first(
    tmp_path: Path, one: Ended, when_mounted: Callable[[int, Callable[[TickedWorld], object]], None]
) -> None:
    when_mounted(2, open_guard)
    ended = run(tmp_path)
    assert ended.code == 5 and statuses(ended) == [statuses(one)[0], None]
    with RunReader(ended.folder) as reader, RunReader(one.folder) as other:
        assert reader.repeats(1) == other.repeats(1)


def test_an_interrupt_begins_no_further_part(
    tmp_path: Path, when_mounted: Callable[[int, Callable[[TickedWorld], object]], None]
) -> None:
    when_mounted(1, lambda _: signal.raise_signal(signal.SIGINT))
    ended = run(tmp_path)
    assert ended.code == 130 and ended.status() == "stopped"
    with RunReader(ended.folder) as reader:
        assert [one.piece for one in reader.pieces()] == [1]


def test_a_run_interrupted_in_its_second_part_keeps_the_first_and_resumes(
    tmp_path: Path, one: Ended, when_mounted: Callable[[int, Callable[[TickedWorld], object]], None]
) -> None:
    def crash(_: TickedWorld) -> None:
        raise MemoryError("as if it had been killed")

    when_mounted(2, crash)
    with pytest.raises(MemoryError):
        run(tmp_path)
    (folder,) = (tmp_path / "runs").iterdir()
    assert (folder / PARTS / "1" / "run.db").is_file()
    when_mounted(0, crash)
    screen = Screen()
    Session(SessionOptions(), screen).resume(folder)
    resumed = Ended(0, screen, tmp_path / "runs")
    assert statuses(resumed) == statuses(one) and not (folder / PARTS).exists()
    with RunReader(folder) as reader, RunReader(one.folder) as other:
        assert reader.repeats(1) == other.repeats(1)


@pytest.mark.parametrize("steps", [0, 1, VERSION])
def test_a_part_that_was_cut_off_as_it_began_is_none(tmp_path: Path, one: Ended, steps: int) -> None:
    folder = tmp_path / "run"
    for number in ("1", "2"):
        (folder / PARTS / number).mkdir(parents=True)
    for copy in (folder, folder / PARTS / "1"):
        shutil.copy(one.folder / "run.db", copy)
    with closing(sqlite3.connect(folder / PARTS / "2" / "run.db")) as begun, pytest.MonkeyPatch.context() as patch:
        patch.setattr(record_schema, "VERSION", steps)
        record_schema.migrate(begun)
    recover(folder)
    with RunReader(folder) as reader, RunReader(one.folder) as other:
        assert list(reader.repeats()) == list(other.repeats())


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="no process groups on this system")
def test_an_interrupt_from_the_terminal_stops_all_processes(tmp_path: Path) -> None:
    (tmp_path / "two.yaml").write_text(TWO.replace("repeats: 1", "repeats: 30"), encoding="utf-8")
    command = "from tester.cli.main import main; main()"
    process = subprocess.Popen(
        [sys.executable, "-c", command, "run", "two.yaml", "--yes", "--jobs", "2", "--json"],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)}, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, text=True, start_new_session=True,
    )  # fmt: skip
    assert process.stdout is not None
    begun: set[object] = set()
    while begun < {1, 2}:
        record = json.loads(process.stdout.readline())
        if str(record.get("title", "")).startswith(("1#", "2#")):
            begun.add(record["part"])
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to every process
    *_, end, folder = process.stdout.read().splitlines()
    assert process.wait() == 130 and json.loads(end)["outcome"] == "stopped"
    with RunReader(tmp_path / folder) as reader:
        assert reader.run().status == "stopped" and [one.piece for one in reader.pieces()] == [1, 2]
