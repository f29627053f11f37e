"""One part from its connection to its standstill, recorded in a file of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from drivers.ports import BusLost
from tester import clock
from tester.bus_log import BusLog
from tester.campaign.endings import PartEnd
from tester.campaign.folder import Job, Work, begin_record
from tester.campaign.split import Part
from tester.engine.build import Ports, build_run
from tester.engine.context import Attendant, Nobody
from tester.engine.prompts import Prompts
from tester.engine.run import Outcome, Run
from tester.engine.tickers import TickStatistics, World, run_real_time, run_simulated
from tester.recipe.estimate import estimate
from tester.rig import RigConfig
from tester.store.reader import DATABASE
from tester.store.writer import RunWriter


class Watch(Protocol):
    """Who looks after a part while it runs."""

    def begun(self, run: Run) -> None:
        """Take notice of the run: from now on it can be stopped."""
        ...

    def poll(self, now_s: float, run: Run, share: float) -> None:
        """Look at the run, about ten times a second of wall time; ``share`` of the expected rig time, from 0."""
        ...


class Unsampled(RunWriter):
    """A record without samples: repeats and conditions are all that is wanted of it."""

    def sample(self, row: tuple[float, ...]) -> None:
        """Forget the sample."""


def run_part(job: Job, work: Work, part: Part, watch: Watch, prompts: Prompts) -> PartEnd:
    """Carry out a part; its record is closed when this returns. Raises OSError, sqlite3.Error, StoreError."""
    folder = work.folder_of(part, job.folder)
    folder.mkdir(parents=True, exist_ok=True)
    name = job.folder.name if len(work.parts) == 1 else f"{job.folder.name}, part {part.number}"
    open_record = RunWriter if job.samples else Unsampled
    lossless = work.rig.can.interface == "sim"
    writer = open_record(folder / DATABASE, clock=clock.monotonic, utc=clock.utc_now, lossless=lossless)
    try:
        begin_record(writer, work, part.plan, job, name)
        outcome, reason, seconds = _execute(job, work, part, writer, watch, prompts)
        writer.finish(outcome.value, reason, seconds)
    finally:
        writer.close()
    return PartEnd(part.number, outcome, reason, writer.failed)


def _execute(
    job: Job, work: Work, part: Part, writer: RunWriter, watch: Watch, prompts: Prompts
) -> tuple[Outcome, str, float]:
    rig = work.rig
    log = BusLog(_log_folder(job.bus_log, work, part), rig) if job.bus_log is not None else None
    try:
        ports, world, attendant = connect_ports(rig, job.seed, log)
        run = build_run(rig, part.plan, ports, attendant, writer, prompts)
        _place(run, work, part)
        watch.begun(run)
        expected_s = max(estimate(part.plan, rig).rig_seconds, 1.0)
        seconds = _tick(run, world, job.lapse, expected_s, writer, watch)
        record_parameters(run, writer, seconds)
        return run.outcome, run.reason, seconds
    except BusLost as lost:
        return Outcome.UNREACHABLE, str(lost), 0.0
    finally:
        if log is not None:
            log.close()


def _log_folder(folder: Path, work: Work, part: Part) -> Path:
    return folder if len(work.parts) == 1 else folder / f"part-{part.number}"


def _place(run: Run, work: Work, part: Part) -> None:
    """Tell a run which part of the whole it is: numbers of unforeseen wheels, what people are shown."""
    executor, progress = run.engine.executor, run.engine.ctx.progress
    executor.wheels = part.last_wheel
    executor.conditions = sum(1 for _ in work.plan.conditions())
    progress.part, progress.parts = part.number, len(work.parts)


def _tick(
    run: Run, world: World | None, lapse: float | None, expected_s: float, recorder: RunWriter, watch: Watch
) -> float:
    def poll(now_s: float) -> None:
        watch.poll(now_s, run, now_s / expected_s)
        if recorder.failed:
            run.request_stop(f"the run can no longer be recorded: {recorder.failed}")

    if world is not None:
        # Also at --speed 1: counted ticks, not measured ones, so that no speed changes a result.
        return run_simulated(run, world, lapse=lapse, poll=poll)
    return run_real_time(run, world, poll=poll, statistics=TickStatistics())


def connect_ports(rig: RigConfig, seed: int, log: BusLog | None) -> tuple[Ports, World | None, Attendant]:
    """Open the wires to the rig: simulated in this process, or real."""
    if rig.can.interface == "sim":
        from tester.simulated import simulated_ports

        return simulated_ports(rig, seed, log)
    from tester.hardware import hardware_ports

    return hardware_ports(rig, log), None, Nobody()


def record_parameters(run: Run, writer: RunWriter, now_s: float) -> None:
    """Store every parameter read back from the drives."""
    for drive in run.engine.devices.drives:
        for (index, sub), value in drive.parameters.items():
            writer.device_parameter(now_s, drive.config.name, f"0x{index:04X}:{sub:02X}", str(value))
