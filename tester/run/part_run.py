"""Runs one part from its connection to its standstill, with a record in its own file."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from drivers.ports import BusLost
from sim.hands import durometer
from tester.base import clock
from tester.base.clock import Pace
from tester.base.trouble import in_words
from tester.inputs.rig.further_sensors import quantities_on
from tester.machine.hardness import HardnessBelief
from tester.machine.leaps import Leaps
from tester.machine.prompts import Prompts
from tester.machine.rig_ports import Ports
from tester.machine.run import Outcome, Run
from tester.machine.run_parts import Part, RunSetup
from tester.machine.tickers import Ticked, TickedWorld, TickStatistics, collector_at_rest, run_real_time, run_simulated
from tester.machine.time_left import TimeLeft
from tester.run.bus_log import BusLog
from tester.run.endings import PartEnd
from tester.run.folder import Begin, Job, Work
from tester.run.kept import record_kept
from tester.run.kind_lookup import run_parts
from tester.run.provenance import record_parameters, record_statistics
from tester.run.remote_hands import RemoteHands, remote_hands
from tester.run.rig_wires import connect_ports
from tester.run.set_up import GoodRun
from tester.run.simulated import Witnessed, spec_of, truth_of
from tester.store.record_file import DATABASE
from tester.store.writer import RESERVE_BYTES, RunWriter

if TYPE_CHECKING:
    from sim.rig import SimRig

KILLED = 137
"""Exit status of a process killed by a fault script: the status that a shell shows for SIGKILL."""
INTERRUPTED = "interrupted"
"""Status of a run that ended with an error of the program."""
STATE_EVERY_S = 1.0
"""Period for storing the specimen's state, s of wall time: an interruption loses at most this much."""


class PartWatch:
    """Watches a part while it runs; this class only counts."""

    def __init__(self, track: TimeLeft) -> None:
        """``track`` counts the run's steps; it is updated before each poll."""
        self.track = track
        self.statistics = TickStatistics()
        """How punctual the ticks are, in real time."""

    def begun(self, run: Run) -> None:
        """Receive the run: from now on it can be stopped. Called by the code that runs the part."""

    def say(self, text: str) -> None:
        """Show a message about the run under way; the record contains it too."""

    def rested(self) -> None:
        """Called when the run is at rest: no ticks follow, but its record is still open."""

    def poll(self, now_s: float, run: Run) -> None:
        """Read the state of the run; called about ten times a second of wall time."""


class Unsampled(RunWriter):
    """A record without samples: it contains only repeats and conditions."""

    def sample(self, row: tuple[float, ...]) -> None:
        """Drop the sample."""


class RunNotes:
    """Stores what no scan records: the parameters read from devices, and the specimen's state."""

    def __init__(self, run: Run, recorder: RunWriter, good: GoodRun | None, say: Callable[[str], None]) -> None:
        """Store nothing before the rig is connected.

        ``good``: the last good run, with which the parameters are compared; ``say`` shows the differences.
        """
        self.run = run
        self.recorder = recorder
        self.good = good
        self.say = say
        self.kind = run_parts(run.engine.ctx.rig)
        self.connected = False
        self.state_due_s = 0.0

    def poll(self, now_s: float) -> None:
        """Store what is due; ``now_s`` is rig time."""
        if not self.run.connected:
            return
        if not self.connected:
            self.connected, engine = True, self.run.engine
            difference = record_parameters(engine.ctx.rig, engine.devices, self.recorder, now_s, self.good)
            if difference:
                engine.ctx.journal.event(now_s, "arming", difference, "warning")
                self.say(f"warning: {difference}")
            for line in () if engine.ctx.rig.simulated else engine.ctx.counted_on:
                self.say(line)
        wall_s = clock.monotonic()
        if wall_s >= self.state_due_s:
            self.state_due_s = wall_s + STATE_EVERY_S
            self.kind.store_state(self.run, self.recorder, now_s)


def run_part(job: Job, work: Work, part: Part, begin: Begin, watch: PartWatch, prompts: Prompts) -> PartEnd:
    """Run a part; its record is closed on return. Raises OSError, sqlite3.Error, StoreError."""
    folder = work.folder_of(part, job.folder)
    folder.mkdir(parents=True, exist_ok=True)
    open_record = RunWriter if job.samples else Unsampled
    lossless = work.rig.can.interface == "sim"
    path, quantities = folder / DATABASE, quantities_on(work.rig)
    writer = open_record(
        path, quantities, clock=clock.monotonic, utc=clock.utc_now, lossless=lossless, reserve=RESERVE_BYTES
    )
    try:
        with closed_early(writer):
            begin(writer)
            outcome, reason, seconds = _execute(job, work, part, writer, watch, prompts)
            writer.finish(outcome.value, reason, seconds)
    finally:
        writer.close()
    return PartEnd(part.number, outcome, reason, writer.lost)


class closed_early:  # noqa: N801 - reads as a statement
    """Marks the run as interrupted, with the error, if the block raises; the run can be resumed later."""

    def __init__(self, writer: RunWriter) -> None:
        """``writer``: writer of the open record."""
        self.writer = writer

    def __enter__(self) -> None:
        """Do nothing."""

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> None:
        """Record the error, if any, and let it propagate."""
        if kind is not None:
            self.writer.finish(INTERRUPTED, _broken_off(kind, error))


class left_safe:  # noqa: N801 - reads as a statement
    """Sends safe outputs once if the block ends for any reason while the rig is still running."""

    def __init__(self, run: Run) -> None:
        """``run``: the run that the block ticks."""
        self.run = run

    def __enter__(self) -> None:
        """Do nothing."""

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> None:
        """Send safe outputs, record that, and let the error propagate."""
        if kind is not None and not self.run.finished:
            self.run.abandon()
            ctx = self.run.engine.ctx
            ctx.journal.event(ctx.now, "run", f"{_broken_off(kind, error)}: safe outputs sent", "alarm")


def _broken_off(kind: type[BaseException], error: BaseException | None) -> str:
    return f"the program broke off: {kind.__name__}: {in_words(error) if error is not None else ''}"


def _hardness(part: Part, job: Job) -> HardnessBelief:
    """Return what is believed of the hardness of the specimens that the plan asks for."""
    compounds = [specimen.compound for specimen in part.plan.specimens if specimen.hardness]
    if not compounds:
        return HardnessBelief()
    from tester.inputs.recipe.measured_specimens import believed_hardness  # pydantic is slow to load

    return HardnessBelief(believed_hardness(compounds, job.folder / "recipe.yaml"), partial(durometer, job.seed))


def _execute(
    job: Job, work: Work, part: Part, writer: RunWriter, watch: PartWatch, prompts: Prompts
) -> tuple[Outcome, str, float]:
    rig = work.rig
    log = BusLog(_log_folder(job.bus_log, work, part), rig) if job.bus_log is not None else None
    ports: Ports | None = None
    hands: RemoteHands | None = None
    try:
        faults = rig.faults + job.faults
        spoilable = {"faulty": True} if faults else {}
        surface = part.plan.metadata.get("abrasive", "")
        ports, world, attendant = connect_ports(
            rig, job.seed, log, recipe=job.folder / "recipe.yaml", surface=surface, times=job.lapse or 1.0, **spoilable
        )
        truth = truth_of(world, rig.plant) if world is not None else None
        if truth is not None:
            attendant = Witnessed(attendant, truth, part.plan, writer)
        if job.hands:
            attendant = hands = remote_hands(job.hands, rig, writer)
        setup = RunSetup(rig, part.plan, ports, attendant, writer, prompts, work.point, job.history)
        run = run_parts(rig).build(setup)
        run.engine.ctx.hardness = _hardness(part, job)
        run.engine.executor.hands = hands
        run.engine.executor.procedures.number_after(part.last_mounted)  # the plan may be part of a larger plan
        watch.track.begin_part(part.plan)
        ticked, lives = _with_faults(run, world, faults) if world is not None and faults else (run, world)
        may_leap = job.leaps and world is not None and not faults and log is None and job.lapse is None
        leaps = Leaps(run.engine, world) if may_leap and world is not None else None
        _load_numpy()
        with collector_at_rest():  # before the first tick: STOP must not wait for a collection
            watch.begun(run)
            with left_safe(run):
                seconds = _tick(run, ticked, lives, ports.pace, job.lapse, leaps, writer, watch, job.good)
        watch.rested()
        record_statistics(run.engine.devices, writer, seconds)
        if run.outcome is Outcome.DONE:
            record_kept(rig, ports, world, seconds, writer, run.engine.leapt_s)
        return run.outcome, run.reason, seconds
    except BusLost as lost:
        return Outcome.UNREACHABLE, str(lost), 0.0
    finally:
        if hands is not None:
            hands.close()
        if ports is not None:
            ports.close()
        if log is not None:
            log.close()


def _load_numpy() -> None:
    """Load what NumPy would load at the end of the first repeat: a scan would wait for 20 ms."""
    for module in ("numpy.fft", "numpy.ma"):
        import_module(module)


def _log_folder(folder: Path, work: Work, part: Part) -> Path:
    return folder if len(work.parts) == 1 else folder / f"part-{part.number}"


def _tick(
    run: Run,
    ticked: Ticked,
    world: TickedWorld | None,
    pace: Pace | None,
    lapse: float | None,
    leaps: Leaps | None,
    recorder: RunWriter,
    watch: PartWatch,
    good: GoodRun | None,
) -> float:
    notes = RunNotes(run, recorder, good, watch.say)

    def poll(now_s: float) -> None:
        notes.poll(now_s)
        watch.track.look(now_s, run)
        watch.poll(now_s, run)
        if recorder.failed:
            run.request_stop(f"the run can no longer be recorded: {recorder.failed}")

    if world is not None:
        # Even at --speed 1, time is counted by ticks, not measured, so that the speed cannot change a result.
        return run_simulated(ticked, world, lapse=lapse, poll=poll, leaps=leaps)
    return run_real_time(run, world, poll=poll, statistics=watch.statistics, pace=pace)


def _with_faults(run: Run, world: SimRig, texts: Sequence[str]) -> tuple[Ticked, TickedWorld]:
    """Return an object that replaces run and rig for the ticker and injects faults."""
    from sim import machines
    from sim.faults import FaultScript
    from tester.run.fault_injection import FaultyRun

    rig = run.engine.ctx.rig
    language = machines.find(run_parts(rig).plant).language(spec_of(rig))
    faulty = FaultyRun(run, world, FaultScript().add(language.parse_script(texts)), on_kill=_die)
    return faulty, faulty


def _die() -> None:
    """End this process as a kill does: at once, without closing or flushing anything."""
    os._exit(KILLED)
