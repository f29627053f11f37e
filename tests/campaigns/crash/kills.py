"""Kills: a run on the simulated rig, in a process of its own, killed at random moments and resumed until it ends."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import signal
import sqlite3
import sys
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, field
from io import StringIO
from math import isfinite, nan, sqrt
from multiprocessing.connection import Connection
from pathlib import Path
from random import Random
from typing import Any

from tester.analysis.results import Burst, RepeatResult
from tester.base import clock
from tester.cli.console import Console
from tester.machine.tickers import collector_at_rest
from tester.results.verify import verify
from tester.run.merge_parts import recover
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.record_schema import StoreError
from tester.store.resumable import resume_point
from tester.store.run_reader import RunReader
from tester.store.sql import Judged, Ticket
from tester.store.writer import RunWriter
from tests.campaigns.acceptance.figure import Figure, at_most, equal

RECIPE = """\
recipe: crash test
specimens:
  - compound: "1#"
{second}pre_grind: {{wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 10 s}}
rest: {{at_least: 10 s, until: 25 degC, within: 10 degC}}
measure:
  wheel_speed: 0.8 m/s
  repeats: 3
  min_valid: 1
  window: 10 rev
  temperature_band: 4 degC
  soak: {{within: 2 degC, for: 2 s}}
grids:
  - name: load
    slip_velocity: 100 mm/s
    load: [{loads}]
    temperature: 24 degC
"""
REPEATS = 3
SEED = 5
OVERRIDES = ("sim.running_in=0", "sim.noise=0", "sim.friction_heat_fraction=0", "sim.variability.within=0")
"""A wheel that is run in, sensors without noise, no heat, so that every repeat is short; the scatter from repeat to
repeat is unchanged."""
RUN_SD = 0.02
"""The simulator's stated sigma from repeat to repeat (sim.physics.parameters), relative."""
SIGMAS = 4.5
"""Repeatability alone makes a mean differ by more only once in 150,000."""
LATEST_S = 1.0
"""Samples older than this (wall time) must be stored."""

Place = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Scenario:
    """A recipe and its number of conditions. Two specimens begin in records of their own."""

    name: str
    recipe: str
    conditions: int
    rig: str = "sim"
    overrides: tuple[str, ...] = OVERRIDES


WHEEL = (
    Scenario("one specimen", RECIPE.format(second="", loads="50 N, 80 N, 100 N"), 3),
    Scenario("two specimens", RECIPE.format(second='  - compound: "3#"\n', loads="50 N, 80 N"), 4),
)
TRACK = (
    Scenario("disc, dry and wet", """\
recipe: crash test on a disc
kind: specimen_on_track
specimens: [{compound: SBR}]
measure: {repeats: 3, min_valid: 1, distance: 300 mm, temperature_band: 5 K, soak: {within: 3 K, for: 2 s}}
grids:
  - {name: dry and wet, interface: [dry, wet], load: [10 N, 20 N], temperature: 23 degC, track_speed: 0.05 m/s}
""", 4, "pin-on-disc", ("sim.noise=0",)),
    Scenario("slow track", """\
recipe: crash test on a slow track
kind: specimen_on_track
specimens: [{compound: SBR}]
measure: {repeats: 3, min_valid: 1, distance: 0.3 mm, soak: {within: 1 K, for: 5 s}}
grids:
  - {name: two temperatures, load: 20 N, temperature: [25 degC, 28 degC], track_speed: [0.05 mm/s, 0.1 mm/s]}
""", 4, "grosch", ("sim.noise=0",)),
)  # fmt: skip
SCENARIOS = {"wheel_on_belt": WHEEL, "specimen_on_track": TRACK}
"""By the kind of machine."""


# -- the process that is killed -----------------------------------------------------------------------------------


class TellingWriter(RunWriter):
    """The store's writer; reports over a pipe what is committed, and the time of the samples it has received."""

    pipe: Connection

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self._places: dict[int, Place] = {}
        self._path = str(arguments[0])
        self._tell_due = 0.0
        super().__init__(*arguments, **options)

    def begin_repeat(self, condition: int, repeat: int, attempt: int, t_s: float = nan, wheel: int = 0) -> int:
        key = super().begin_repeat(condition, repeat, attempt, t_s, wheel)
        self._places[key] = (condition, repeat)
        return key

    def commit_repeat(
        self, key: int, result: RepeatResult, bursts: Any = (), judged: Judged | None = None
    ) -> Ticket:
        bursts_: list[Burst] = list(bursts)
        ticket = super().commit_repeat(key, result, bursts_, judged)
        if ticket.done and result.status.value != "void":
            self.pipe.send(("repeat", self._places[key], result.mu_resultant, len(bursts_)))
        return ticket

    def sample(self, row: tuple[float, ...]) -> None:
        super().sample(row)
        now = clock.monotonic()
        if now >= self._tell_due:
            self._tell_due = now + 0.1
            self.pipe.send(("sample", self._path, row[0] + self.origin_s, now))


def work(pipe: Connection, scenario: Scenario, recipe: str, out: str, folder: str) -> None:
    """Run the campaign, or resume it, in this process; the exit code is the session's."""
    import tester.run.part_run as module

    os.setpgid(0, 0)
    sys.stdout = sys.stderr = StringIO()
    TellingWriter.pipe = pipe
    module.RunWriter = TellingWriter  # type: ignore[misc]
    options = SessionOptions(
        recipe=recipe, rig=scenario.rig, out=Path(out), overrides=scenario.overrides, seed=SEED
    )
    session = Session(options, Console(as_json=False, answer_yes=True))
    code = session.resume(Path(folder)) if folder else session.run()
    pipe.send(("end", code))
    pipe.close()


# -- the one that kills -------------------------------------------------------------------------------------------


@dataclass(slots=True)
class Found:
    """The results of all campaigns of kills."""

    kills: int = 0
    ended: int = 0
    early: int = 0
    """Kills before anything of the run was on the disk; the run starts again."""
    lost_repeats: int = 0
    unreadable: list[str] = field(default_factory=list[str])
    wrong_values: int = 0
    wrong_points: int = 0
    missing_s: float = 0.0
    different: list[str] = field(default_factory=list[str])
    worst_sigmas: float = 0.0
    wrong_exits: int = 0


@dataclass(slots=True)
class ProcessReports:
    """What a process reported before it was killed."""

    repeats: dict[Place, tuple[float, int]] = field(default_factory=dict[Place, tuple[float, int]])
    samples: list[tuple[str, float, float]] = field(default_factory=list[tuple[str, float, float]])
    """A sample's record, its rig time, and the wall time at which the recorder received it."""
    exit: int | None = None


def one_process(
    scenario: Scenario, recipe: Path, out: Path, folder: Path | None, kill_after_s: float | None
) -> tuple[ProcessReports, float]:
    """Start a process, kill it after a time (None: never); return its reports and when it was killed."""
    # A forked child has everything imported: the kill hits its measuring, not its start.
    method = "fork" if "fork" in multiprocessing.get_all_start_methods() else "spawn"
    context = multiprocessing.get_context(method)
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=work, args=(there, scenario, str(recipe), str(out), str(folder or "")))
    process.start()
    there.close()
    reports = ProcessReports()
    deadline = None if kill_after_s is None else clock.monotonic() + kill_after_s
    killed = _listen(here, reports, deadline)
    if killed:
        assert process.pid is not None
        os.kill(process.pid, signal.SIGKILL)
    at = clock.monotonic()
    _listen(here, reports, None)  # earlier reports
    process.join()
    return reports, at


def _listen(pipe: Connection, reports: ProcessReports, deadline: float | None) -> bool:
    """Receive reports until the deadline (True), or until the pipe is closed (False)."""
    while True:
        wait = None if deadline is None else deadline - clock.monotonic()
        if wait is not None and wait <= 0.0:
            return True
        if not pipe.poll(wait):
            return True
        try:
            report = pipe.recv()
        except (EOFError, OSError):
            return False
        match report:
            case ("repeat", place, mu, bursts):
                reports.repeats[place] = (mu, bursts)
            case ("sample", path, rig_s, wall_s):
                reports.samples.append((path, rig_s, wall_s))
            case ("end", code):
                reports.exit = code


class Campaign:
    """One run of the recipe, killed repeatedly until it ends; remembers what is committed."""

    def __init__(self, scenario: Scenario, recipe: Path, out: Path, found: Found, random: Random) -> None:
        self.scenario, self.recipe, self.out, self.found, self.random = scenario, recipe, out, found, random
        self.known: dict[Place, tuple[float, int]] = {}
        self.kills = 0

    def run(self, delays_s: tuple[float, float], kills: int) -> Path | None:
        """Kill up to ``kills`` times at random moments, then let it end; return the run's folder."""
        folder: Path | None = None
        while True:
            final = self.kills >= kills
            after_s = None if final else self.random.uniform(*delays_s)
            reports, at = one_process(self.scenario, self.recipe, self.out, folder, after_s)
            self.known.update(reports.repeats)
            folder = _begun(self.out)
            if reports.exit is not None:
                self.found.wrong_exits += reports.exit != 0
                return folder
            if final:
                self.found.wrong_exits += 1
                return folder
            self.kills += 1
            self.found.kills += 1
            if folder is None:
                self.found.early += 1
                shutil.rmtree(self.out, ignore_errors=True)
            else:
                self._look(folder, reports, at)

    def _look(self, folder: Path, reports: ProcessReports, killed_at: float) -> None:
        found = self.found
        try:
            self._samples(reports, killed_at)
            recover(folder)
            with RunReader(folder) as reader:
                found.unreadable += reader.integrity_problems()
                stored = {(r.condition, r.repeat): r for r in reader.repeats()}
                found.lost_repeats += len(set(self.known) - set(stored))
                for place, (mu, bursts) in self.known.items():
                    if place in stored:
                        same = stored[place].result.mu_resultant == mu or not isfinite(mu)
                        found.wrong_values += not same or len(reader.bursts(stored[place].key)) != bursts
                found.wrong_points += resume_point(reader).next_repeat not in self._right_points(set(stored))
        except StoreError as error:
            found.unreadable.append(str(error))

    def _samples(self, reports: ProcessReports, killed_at: float) -> None:
        """Determine the age of the oldest missing sample of the record written last."""
        if not reports.samples:
            return
        path = Path(reports.samples[-1][0])
        with RunReader(path) as reader:
            newest = max((block.columns["time_s"][-1] for block in reader.sample_blocks()), default=-1.0)
        due = [wall_s for where, rig_s, wall_s in reports.samples if where == str(path) and rig_s > newest]
        if due:
            self.found.missing_s = max(self.found.missing_s, killed_at - due[0])

    def _right_points(self, stored: set[Place]) -> tuple[Place | None, ...]:
        """Return where a run with these repeats may continue: at the first missing one; None = its condition not
        begun."""
        order = [(c, r) for c in range(1, self.scenario.conditions + 1) for r in range(1, REPEATS + 1)]
        missing = next((place for place in order if place not in stored), None)
        if missing is None:
            return None, (self.scenario.conditions, REPEATS + 1)
        if missing[1] == 1:
            # Not begun, begun, or the previous condition is measured and its end not yet committed.
            return None, missing, (missing[0] - 1, REPEATS + 1)
        return (missing,)


def _begun(out: Path) -> Path | None:
    """Return the folder of the run; None if it was killed before the store knew it."""
    for path in out.glob("*/run.db"):
        with closing(sqlite3.connect(path)) as connection:
            tables = connection.execute("SELECT count(*) FROM sqlite_master WHERE name = 'run'").fetchone()[0]
            if tables and connection.execute("SELECT count(*) FROM run").fetchone()[0]:
                return path.parent
    return None


@dataclass(frozen=True, slots=True)
class Table:
    """A run's export: setpoints with counts in order, and the mean coefficient of each condition."""

    rows: tuple[tuple[object, ...], ...]
    means: tuple[float, ...]


def table_of(folder: Path) -> Table:
    """Return a finished run's conditions."""
    rows: list[tuple[object, ...]] = []
    means: list[float] = []
    with RunReader(folder) as reader:
        for stored in reader.conditions():
            repeats = reader.repeats(stored.info.condition)
            rows.append((stored.info, len(repeats), tuple(r.repeat for r in repeats)))
            values = [r.result.mu_resultant for r in repeats]
            means.append(sum(values) / len(values) if values else nan)
    return Table(tuple(rows), tuple(means))


def _undisturbed(scenario: Scenario, recipe: Path, out: Path) -> tuple[Table, float]:
    """Run a recipe without a kill; return its table and the wall time it took, s."""
    begun = clock.monotonic()
    reports, _ = one_process(scenario, recipe, out, None, None)
    assert reports.exit == 0, f"the undisturbed run ended with {reports.exit}"
    return table_of(next(out.iterdir())), clock.monotonic() - begun


def compare(found: Found, undisturbed: Table, interrupted: Table) -> None:
    """Compare an interrupted run with the undisturbed one."""
    if undisturbed.rows != interrupted.rows:
        found.different.append(f"{interrupted.rows} instead of {undisturbed.rows}")
        return
    sigma = RUN_SD * sqrt(2.0 / REPEATS)
    for one, other in zip(undisturbed.means, interrupted.means, strict=True):
        found.worst_sigmas = max(found.worst_sigmas, abs(one - other) / (one * sigma))


def measure(folder: Path, kills: int, seed: int = 1, kind: str = "wheel_on_belt") -> Iterator[Figure]:
    """Yield the figures of ``kills`` kills, and of one run that is interrupted five times."""
    found, random = Found(), Random(seed)
    undisturbed: dict[str, tuple[Table, float]] = {}
    number, scenarios = 0, SCENARIOS[kind]
    with collector_at_rest():
        while found.kills < kills:
            scenario = scenarios[number % len(scenarios)]
            number += 1
            recipe = folder / f"{scenario.name}.yaml"
            if scenario.name not in undisturbed:
                recipe.write_text(scenario.recipe, encoding="utf-8")
                undisturbed[scenario.name] = _undisturbed(scenario, recipe, folder / scenario.name)
            table, whole_s = undisturbed[scenario.name]
            campaign = Campaign(scenario, recipe, folder / f"run-{number}", found, random)
            # About five interruptions each: a run may end before it is killed.
            ended = campaign.run((0.02 * whole_s, 0.6 * whole_s), min(5, kills - found.kills))
            if ended is not None:
                found.ended += 1
                compare(found, table, table_of(ended))
                found.unreadable += verify(ended).problems
    yield equal("kills", found.kills, kills)
    note = f"{found.ended} runs, {found.early} of the kills before anything was on the disk"
    yield Figure("runs that went on to their end", note, "every one", found.ended == number)
    yield equal("unreadable, or not verified, after kills", len(found.unreadable), 0)
    for why in sorted(set(found.unreadable))[:3]:
        yield Figure("unreadable", why, "none", ok=False)
    yield equal("committed repeats lost by kills", found.lost_repeats, 0)
    yield equal("wrong values after kills", found.wrong_values, 0)
    yield equal("wrong resume points after kills", found.wrong_points, 0)
    yield equal("exit codes other than 0 at the end", found.wrong_exits, 0)
    yield at_most("samples missing after a kill", found.missing_s, LATEST_S, "s of wall time", 2)
    yield equal("runs whose setpoints, counts or order differ", len(found.different), 0)
    yield at_most("coefficients against the undisturbed run", found.worst_sigmas, SIGMAS, "sigma of repeatability", 2)
