"""One recipe on one rig from the outside: files, folder, rig, run, results, exit code."""

from __future__ import annotations

import os
import re
import signal
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Protocol

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
from tester.engine.tickers import TickStatistics, run_real_time, run_simulated
from tester.export import write_all
from tester.recipe.check import load_checked
from tester.recipe.estimate import estimate
from tester.recipe.expand import expand
from tester.recipe.loader import LoadedRecipe
from tester.recipe.plan import Plan
from tester.rig import RigConfig, load_rig
from tester.store.records import RunInfo, SpecimenInfo
from tester.store.writer import RunWriter

if TYPE_CHECKING:
    from sim.faults import FaultScript
    from sim.rig import SimRig

EXIT_CODES: dict[Outcome, int] = {
    Outcome.DONE: 0,
    Outcome.FAILED: 1,
    Outcome.UNREACHABLE: 4,
    Outcome.TRIPPED: 5,
    Outcome.STOPPED: 5,
}
EXIT_INCOMPLETE = 6
EXIT_INTERRUPTED = 130
KILLED = 137
"""Exit status of a process that a fault script kills: what a shell shows for SIGKILL."""
SHOWN_VERSIONS = ("friction-tester", "numpy", "pymodbus", "python-can", "pydantic")
"""Distributions whose versions are stored with a run."""


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

    recipe: str
    rig: str = "sim"
    overrides: tuple[str, ...] = ()
    out: Path = Path("runs")
    seed: int = 0
    lapse: float | None = None
    bus_log: Path | None = None
    operator: str = ""
    faults: tuple[str, ...] = ()
    """Lines of a fault script (sim.faults.language), beside those of the rig file."""


class CannotStartError(Exception):
    """The run cannot begin; the message says why."""


class Session:
    """Prepares, runs and closes one run."""

    def __init__(self, options: SessionOptions, screen: Screen) -> None:
        """Nothing is read or written before ``run``."""
        self.options = options
        self.screen = screen
        self.interrupts = 0
        self.run_: Run | None = None

    def run(self) -> int:
        """Run to the end; return the exit code. Raises InvalidSource for an invalid recipe or
        rig file, FileNotFoundError where there is no such recipe."""
        options = self.options
        rig = load_rig(options.rig, options.overrides)
        self._script(rig)  # a line that cannot be read ends the run before it begins
        recipe = load_checked(find(options.recipe), rig)
        plan = expand(recipe.recipe, rig)
        if not self.screen.answer_yes and not self.screen.can_ask:
            self.screen.message("the recipe asks a person, and nobody is at this terminal: use --yes")
            return 2
        folder = make_folder(options.out, plan.name)
        return self._record(rig, recipe, plan, folder)

    # -- parts ------------------------------------------------------------------------------------------------

    def _record(self, rig: RigConfig, recipe: LoadedRecipe, plan: Plan, folder: Path) -> int:
        (folder / "recipe.yaml").write_text(recipe.tree.text, encoding="utf-8", newline="\n")
        (folder / "rig.yaml").write_text(rig.text, encoding="utf-8", newline="\n")
        writer = RunWriter(
            folder / "run.db", clock=clock.monotonic, utc=clock.utc_now, lossless=rig.can.interface == "sim"
        )
        try:
            writer.begin_run(
                run_info(folder.name, plan, recipe, rig, self.options),
                [SpecimenInfo(s.index, s.compound, s.note) for s in plan.specimens],
                condition_records(plan),
            )
            outcome, reason, seconds = self._execute(rig, plan, writer)
            writer.finish(outcome.value, reason, seconds)
        finally:
            writer.close()
        return self._report(folder, outcome, reason, writer.failed)

    def _execute(self, rig: RigConfig, plan: Plan, writer: RunWriter) -> tuple[Outcome, str, float]:
        log = BusLog(self.options.bus_log, rig) if self.options.bus_log is not None else None
        try:
            script = self._script(rig)
            ports, world, attendant = connect_ports(rig, self.options.seed, log, faulty=script is not None)
            prompts = Prompts(automatic=self.screen.answer_yes)
            run = build_run(rig, plan, ports, attendant, writer, prompts)
            self.run_ = run
            expected_s = max(estimate(plan, rig).rig_seconds, 1.0)
            self.screen.begin(plan.name)
            seconds = self._tick(run, world, script, expected_s, prompts, writer)
            record_parameters(run, writer, seconds)
            return run.outcome, run.reason, seconds
        except BusLost as lost:
            return Outcome.UNREACHABLE, str(lost), 0.0
        finally:
            if log is not None:
                log.close()

    def _script(self, rig: RigConfig) -> FaultScript | None:
        """Return the fault script of rig file and command line, if there is one."""
        texts = (*rig.sim.faults, *self.options.faults)
        if not texts:
            return None
        if rig.can.interface != "sim":
            raise CannotStartError("faults happen on the simulated rig only")
        from sim.faults import FaultScript, FaultTextError, parse_script

        try:
            return FaultScript().add(parse_script(texts))
        except FaultTextError as error:
            raise CannotStartError(str(error)) from error

    def _tick(
        self,
        run: Run,
        world: SimRig | None,
        script: FaultScript | None,
        expected_s: float,
        prompts: Prompts,
        recorder: RunWriter,
    ) -> float:
        def poll(now_s: float) -> None:
            self.screen.show(now_s, run.engine.ctx.progress, now_s / expected_s)
            self.screen.attend(prompts)
            if recorder.failed:
                run.request_stop(f"the run can no longer be recorded: {recorder.failed}")

        previous = {s: signal.signal(s, self._on_signal) for s in (signal.SIGINT, signal.SIGTERM)}
        try:
            if world is not None and script is not None:
                from tester.faulty import FaultyRun

                faulty = FaultyRun(run, world, script, on_kill=die)
                return run_simulated(faulty, faulty, lapse=self.options.lapse, poll=poll)
            if world is not None:
                # Also at --speed 1: counted ticks, not measured ones, so that no speed changes a result.
                return run_simulated(run, world, lapse=self.options.lapse, poll=poll)
            return run_real_time(run, world, poll=poll, statistics=TickStatistics())
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


def die() -> None:
    """End this process as a kill does: at once, nothing closed, nothing flushed."""
    os._exit(KILLED)


def connect_ports(
    rig: RigConfig, seed: int, log: BusLog | None, *, faulty: bool = False
) -> tuple[Ports, SimRig | None, Attendant]:
    """Open the wires to the rig: simulated in this process (its bus spoilable where ``faulty``), or real."""
    if rig.can.interface == "sim":
        from tester.simulated import simulated_ports

        if faulty:
            from sim.faults.can import FaultyCanWire

            return simulated_ports(rig, seed, log, FaultyCanWire)
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


def run_info(name: str, plan: Plan, recipe: LoadedRecipe, rig: RigConfig, options: SessionOptions) -> RunInfo:
    """Return what the store keeps of a run's beginning."""
    return RunInfo(
        name=name,
        recipe_name=plan.name,
        recipe_text=recipe.tree.text,
        rig_text=rig.text,
        started_utc=clock.utc_now(),
        simulated=rig.simulated,
        seed=options.seed if rig.simulated else None,
        software_version=_version("friction-tester"),
        operator=options.operator,
        metadata=dict(plan.metadata),
        versions={package: _version(package) for package in SHOWN_VERSIONS},
    )


def record_parameters(run: Run, writer: RunWriter, now_s: float) -> None:
    """Store every parameter read back from the drives, and the counters of the lines."""
    for drive in run.engine.devices.drives:
        for (index, sub), value in drive.parameters.items():
            writer.device_parameter(now_s, drive.config.name, f"0x{index:04X}:{sub:02X}", str(value))


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"
