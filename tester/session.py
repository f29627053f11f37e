"""One recipe on one rig from the outside: files, folder, rig, run, results, exit code."""

from __future__ import annotations

import re
import signal
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Protocol

from drivers.ports import BusLost
from recipes import find
from tester import clock
from tester.bus_log import BusLog
from tester.engine.build import Ports, build_run
from tester.engine.context import Attendant, Nobody
from tester.engine.context import Progress as RunProgress
from tester.engine.prompts import Prompts
from tester.engine.results import condition_records
from tester.engine.run import Outcome, Run
from tester.engine.tickers import TickStatistics, World, run_real_time, run_simulated
from tester.export import write_all
from tester.lock import RUN_LOCK, ExclusiveUse, RigInUseError
from tester.provenance import (
    recipe_source,
    record_parameters,
    record_statistics,
    rig_source,
    run_info,
    session_info,
)
from tester.recipe.check import load_checked
from tester.recipe.estimate import estimate
from tester.recipe.expand import expand
from tester.recipe.plan import Plan
from tester.resume import prepare
from tester.rig import RigConfig, load_rig
from tester.store.reader import RunReader
from tester.store.records import SpecimenInfo
from tester.store.resume import FINISHED, ResumePoint
from tester.store.space import expected_bytes, too_little_room
from tester.store.writer import RunWriter

EXIT_CODES: dict[Outcome, int] = {
    Outcome.DONE: 0,
    Outcome.FAILED: 1,
    Outcome.UNREACHABLE: 4,
    Outcome.TRIPPED: 5,
    Outcome.STOPPED: 5,
}
EXIT_REFUSED = 3
"""Recipe, rig or calibration are not those of the run that is to go on."""
EXIT_INCOMPLETE = 6
EXIT_INTERRUPTED = 130
WHEEL_EVERY_S = 1.0
"""The wheel's wear is stored this often of wall time: what an interruption loses of it."""


class Screen(Protocol):
    """Who shows a run to people."""

    answer_yes: bool

    @property
    def can_ask(self) -> bool:
        """A person is there to answer prompts."""
        ...

    def begin(self, name: str) -> None:
        """Show that a run has begun."""
        ...

    def show(self, now_s: float, run: RunProgress, share: float) -> None:
        """Show where the run is."""
        ...

    def attend(self, prompts: Prompts) -> None:
        """Ask and answer prompts without blocking."""
        ...

    def end(self) -> None:
        """Take the progress away."""
        ...

    def message(self, text: str) -> None:
        """Say something to people."""
        ...

    def emit(self, record: dict[str, object]) -> None:
        """Write a record for programs."""
        ...

    def result(self, line: str) -> None:
        """Write the run's folder."""
        ...


@dataclass(frozen=True, slots=True)
class SessionOptions:
    """What the command line said."""

    recipe: str = ""
    rig: str = "sim"
    overrides: tuple[str, ...] = ()
    out: Path = Path("runs")
    seed: int = 0
    lapse: float | None = None
    bus_log: Path | None = None
    operator: str = ""


class CannotStartError(Exception):
    """The run cannot begin; the message says why, ``code`` is the exit code."""

    def __init__(self, message: str, code: int = 1) -> None:
        """``code``: 1 unless told."""
        super().__init__(message)
        self.code = code


@dataclass(frozen=True, slots=True)
class Work:
    """What is to be done: a plan, or what is left of one, on a rig, into a folder.

    ``begin`` records the beginning; ``point`` is where an interrupted run goes on.
    """

    folder: Path
    rig: RigConfig
    plan: Plan
    seed: int
    begin: Callable[[RunWriter], None]
    point: ResumePoint | None = None


class Session:
    """Prepares, runs and closes one run."""

    def __init__(self, options: SessionOptions, screen: Screen) -> None:
        """Nothing is read or written before ``run``."""
        self.options = options
        self.screen = screen
        self.interrupts = 0
        self.run_: Run | None = None
        self.folder: Path | None = None
        self.statistics = TickStatistics()

    def run(self) -> int:
        """Run to the end; return the exit code. Raises InvalidSource for an invalid recipe or
        rig file, FileNotFoundError where there is no such recipe."""
        options = self.options
        rig = load_rig(options.rig, options.overrides)
        path = find(options.recipe)
        recipe = load_checked(path, rig)
        plan = expand(recipe.recipe, rig)
        if self._nobody_to_ask():
            return 2
        options.out.mkdir(parents=True, exist_ok=True)
        enough_room(options.out, plan, rig)
        with ExclusiveUse() as use:
            hold_rig(use, rig, plan.name)
            folder = make_folder(options.out, plan.name)
            hold_run(use, folder)
            (folder / "recipe.yaml").write_text(recipe.tree.text, encoding="utf-8", newline="\n")
            (folder / "rig.yaml").write_text(rig.text, encoding="utf-8", newline="\n")
            info = run_info(
                folder.name,
                plan,
                recipe,
                rig,
                seed=options.seed,
                operator=options.operator,
                recipe_source=recipe_source(path),
                rig_source=rig_source(options.rig, options.overrides),
            )

            def begin(writer: RunWriter) -> None:
                specimens = [SpecimenInfo(s.index, s.compound, s.note) for s in plan.specimens]
                writer.begin_run(info, specimens, condition_records(plan))
                writer.begin_session(session_info(1, 0.0, options.operator))

            return self._record(Work(folder, rig, plan, options.seed, begin))

    def resume(self, folder: Path, reason: str = "") -> int:
        """Go on with an interrupted run; return the exit code. ``reason``: why it may although something changed.

        Raises CannotStartError, StoreError, InvalidSource.
        """
        with RunReader(folder) as reader:
            finished = reader.run().status == FINISHED
        if finished:
            self.screen.message(f"{folder.name} is complete: nothing is left to do")
            self.screen.result(str(folder))
            return 0
        with ExclusiveUse() as use:
            hold_run(use, folder)
            resumed = prepare(folder, reason, self.options.operator)
            if isinstance(resumed, str):
                raise CannotStartError(resumed, EXIT_REFUSED)
            if self._nobody_to_ask():
                return 2
            enough_room(folder, resumed.plan, resumed.rig)
            hold_rig(use, resumed.rig, folder.name)
            self.screen.message(resumed.summary)
            return self._record(
                Work(folder, resumed.rig, resumed.plan, resumed.seed, resumed.begin, point=resumed.point)
            )

    def _nobody_to_ask(self) -> bool:
        nobody = not self.screen.answer_yes and not self.screen.can_ask
        if nobody:
            self.screen.message("the recipe asks a person, and nobody is at this terminal: use --yes")
        return nobody

    # -- parts ------------------------------------------------------------------------------------------------

    def _record(self, work: Work) -> int:
        self.folder = work.folder
        writer = RunWriter(
            work.folder / "run.db", clock=clock.monotonic, utc=clock.utc_now, lossless=work.rig.can.interface == "sim"
        )
        try:
            work.begin(writer)
            outcome, reason, seconds = self._execute(work, writer)
            writer.finish(outcome.value, reason, seconds)
        finally:
            writer.close()
        return self._report(work.folder, outcome, reason, writer.failed)

    def _execute(self, work: Work, writer: RunWriter) -> tuple[Outcome, str, float]:
        rig, plan = work.rig, work.plan
        log = BusLog(self.options.bus_log, rig) if self.options.bus_log is not None else None
        try:
            ports, world, attendant = connect_ports(rig, work.seed, log)
            prompts = Prompts(automatic=self.screen.answer_yes)
            run = build_run(rig, plan, ports, attendant, writer, prompts, work.point)
            self.run_ = run
            expected_s = max(estimate(plan, rig).rig_seconds, 1.0)
            self.screen.begin(plan.name)
            seconds = self._tick(run, world, expected_s, prompts, writer)
            record_statistics(run.engine.devices, writer, seconds)
            return run.outcome, run.reason, seconds
        except BusLost as lost:
            return Outcome.UNREACHABLE, str(lost), 0.0
        finally:
            if log is not None:
                log.close()

    def _tick(self, run: Run, world: World | None, expected_s: float, prompts: Prompts, recorder: RunWriter) -> float:
        notes = RunNotes(run, recorder)

        def poll(now_s: float) -> None:
            notes.poll(now_s)
            self.screen.show(now_s, run.engine.ctx.progress, now_s / expected_s)
            self.screen.attend(prompts)
            if recorder.failed:
                run.request_stop(f"the run can no longer be recorded: {recorder.failed}")

        previous = {s: signal.signal(s, self._on_signal) for s in (signal.SIGINT, signal.SIGTERM)}
        try:
            if world is not None:
                # Also at --speed 1: counted ticks, not measured ones, so that no speed changes a result.
                return run_simulated(run, world, lapse=self.options.lapse, poll=poll)
            return run_real_time(run, world, poll=poll, statistics=self.statistics)
        finally:
            for number, handler in previous.items():
                signal.signal(number, handler)
            self.screen.end()

    def _on_signal(self, number: int, _frame: FrameType | None) -> None:
        """Stop: TERM and a first INT in a controlled way, a second INT fast."""
        if self.run_ is None:
            raise KeyboardInterrupt
        if number == signal.SIGINT:
            self.interrupts += 1
            self.run_.request_stop("interrupted by the operator", fast=self.interrupts > 1)
        else:
            self.run_.request_stop("terminated")

    def _report(self, folder: Path, outcome: Outcome, reason: str, failed: str | None) -> int:
        """Write the tables, name what is missing in them, and return the exit code."""
        missing = [row.describe() for row in write_all(folder)]
        for line in missing:
            self.screen.message(line)
        if reason:
            self.screen.message(f"{outcome.value}: {reason}")
        code = EXIT_CODES[outcome]
        if outcome is Outcome.STOPPED and self.interrupts == 1:
            code = EXIT_INTERRUPTED
        elif failed:
            self.screen.message(f"not everything could be recorded: {failed}")
            code = EXIT_CODES[Outcome.FAILED]
        elif outcome is Outcome.DONE and missing:
            code = EXIT_INCOMPLETE
        self.screen.emit({"event": "end", "outcome": outcome.value, "exit": code, "missing": missing})
        self.screen.result(str(folder))
        return code


def connect_ports(rig: RigConfig, seed: int, log: BusLog | None) -> tuple[Ports, World | None, Attendant]:
    """Open the wires to the rig: simulated in this process, or real."""
    if rig.can.interface == "sim":
        from tester.simulated import simulated_ports

        return simulated_ports(rig, seed, log)
    from tester.hardware import hardware_ports

    return hardware_ports(rig, log), None, Nobody()


def make_folder(out: Path, name: str) -> Path:
    """Create the run's folder, ``<date>T<time>-<slug>``; a second run within the second gets a number."""
    slug = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")[:40] or "run"
    base = f"{clock.local_stamp()}-{slug}"
    out.mkdir(parents=True, exist_ok=True)
    for number in range(1, 1000):
        folder = out / (base if number == 1 else f"{base}-{number}")
        try:
            folder.mkdir()
        except FileExistsError:
            continue
        return folder
    raise CannotStartError(f"{out} holds a thousand runs of this second")


class RunNotes:
    """What is stored beside the scan, a few times a second: parameters once they were read back, the wheel's wear."""

    def __init__(self, run: Run, recorder: RunWriter) -> None:
        """Nothing is stored before the rig is connected."""
        self.run = run
        self.recorder = recorder
        self.connected = False
        self.wheel_due_s = 0.0

    def poll(self, now_s: float) -> None:
        """Store what is due; ``now_s`` is rig time."""
        if not self.run.connected:
            return
        if not self.connected:
            self.connected = True
            record_parameters(self.run.engine.devices, self.recorder, now_s)
        wall_s, wheel = clock.monotonic(), self.run.engine.ctx.wheel
        if wheel.wheel and wall_s >= self.wheel_due_s:
            self.wheel_due_s = wall_s + WHEEL_EVERY_S
            self.recorder.wheel_state(wheel.wheel, wheel.diameter_mm, wheel.sliding_m, now_s)


def enough_room(folder: Path, plan: Plan, rig: RigConfig) -> None:
    """Raise CannotStartError unless twice what the run will take is free."""
    missing = too_little_room(folder, expected_bytes(plan, estimate(plan, rig)))
    if missing:
        raise CannotStartError(missing, EXIT_CODES[Outcome.FAILED])


def hold_rig(use: ExclusiveUse, rig: RigConfig, run: str) -> None:
    """Lock a rig's buses; nothing for a rig simulated in this process. Raises CannotStartError."""
    try:
        use.lock(buses_of(rig), run)
    except RigInUseError as error:
        raise CannotStartError(str(error), EXIT_CODES[Outcome.UNREACHABLE]) from error


def hold_run(use: ExclusiveUse, folder: Path) -> None:
    """Lock a run's folder, so that nobody resumes a run that is under way. Raises CannotStartError."""
    try:
        use.lock_file(f"the run {folder.name}", folder / RUN_LOCK, folder.name, lasting=False)
    except RigInUseError as error:
        raise CannotStartError(str(error)) from error


def buses_of(rig: RigConfig) -> list[str]:
    """Return the buses of a rig that only one process may use."""
    if rig.can.interface == "sim":
        return []
    lines = [f"line {line.port}" for line in rig.lines.values()]
    return [f"can {rig.can.interface}:{rig.can.channel}", *lines]
