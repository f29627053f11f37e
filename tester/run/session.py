"""Runs a recipe on a rig from start to finish: files, folder, rig, parts, results, exit code."""

from __future__ import annotations

import signal
from collections.abc import Callable, Generator, Sequence
from datetime import date
from pathlib import Path
from types import FrameType
from typing import TypeVar

from tester.base.clock import utc_now
from tester.base.lock import ExclusiveUse, user
from tester.base.processes import EXIT_INVALID, EXIT_USAGE, HANG_UP, QUIT, handled
from tester.base.trouble import in_words
from tester.inputs.recipe.loader import LoadedRecipe
from tester.inputs.rig import Rig
from tester.inputs.rig.rig_files import risks_of
from tester.inputs.rig.risks import counts_as_simulated
from tester.machine.prompts import Prompts
from tester.machine.result_keeping import condition_records
from tester.machine.run import Outcome, Run
from tester.machine.run_parts import Part
from tester.machine.time_left import TimeLeft
from tester.results.run_files import doubtful, write_all
from tester.results.run_results import results_of
from tester.results.table_rows import TableRow
from tester.run.endings import EXIT_CODES, CannotStartError, PartEnd, RunEnding, StopLevel, ending_of
from tester.run.folder import (
    Begin,
    Job,
    Work,
    beginning_of,
    earlier_of,
    make_folder,
    parts_time,
    specimens_of,
    write_sources,
)
from tester.run.kind_lookup import run_parts
from tester.run.latch import acknowledge, open_trips
from tester.run.merge_parts import put_together, recover
from tester.run.part_run import PartWatch, run_part
from tester.run.pool import WorkerPool
from tester.run.preconditions import Prepared, enough_room, hold_rig, hold_run, not_measured, prepared, warnings_before
from tester.run.provenance import accepted_risks, recipe_source, rig_source, run_info, session_info
from tester.run.remote_hands import unattended
from tester.run.reporter import LastingScreen, ReportScreen
from tester.run.resumed_run import prepare
from tester.run.run_materials import KeptFile, kept_files, write_materials
from tester.run.session_options import SessionOptions, check_faults, only_plain, refusal
from tester.run.set_up import last_good_run
from tester.run.workers import Sight, side_by_side
from tester.store.record_file import DATABASE
from tester.store.record_schema import StoreError
from tester.store.run_folders import MANIFEST, WENT_THROUGH, cut_off
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter

Got = TypeVar("Got")


class Session(PartWatch):
    """Prepares, runs and closes one run."""

    def __init__(self, options: SessionOptions, screen: ReportScreen) -> None:
        """Read and write nothing before ``run``."""
        super().__init__(TimeLeft([]))  # until the plan exists
        self.options = options
        self.screen = LastingScreen(screen, self._lose_screen)
        self.interrupts = 0
        self.run_: Run | None = None
        """The part that is running, or ran last, in this process."""
        self.folder: Path | None = None
        self.ending: RunEnding | None = None
        self.prompts = Prompts(automatic=screen.answer_yes, person=options.operator or user())
        """Prompts of all parts in this process; their numbers continue from part to part."""
        self._level = StopLevel.NONE
        self._pool: WorkerPool | None = None

    def run(self) -> int:
        """Run to the end; return the exit code.

        Raises InvalidSource for an invalid recipe or rig file, FileNotFoundError for a missing recipe,
        CannotStartError.
        """
        options = self.options
        only_plain(operator=options.operator, recipe=options.recipe, rig=options.rig)
        preparation = self.prepare()
        work, rig, recipe = preparation.work, preparation.work.rig, preparation.recipe
        faults = rig.faults + options.faults
        if faults:
            check_faults(faults, rig)
        if refused := refusal(options, rig, self.screen):
            self.screen.message(refused)
            return EXIT_USAGE
        not_measured(options, rig)
        self._foretell(rig)
        options.out.mkdir(parents=True, exist_ok=True)
        for left in cut_off(options.out):
            self.screen.message(f"{left.name} was cut off: tester resume {left} resumes it")
        enough_room(options.out, work.plan, rig, preparation.expected)
        with ExclusiveUse() as use:
            hold_rig(use, rig, work.plan.name)
            folder = make_folder(options.out, work.plan.name)
            hold_run(use, folder)
            write_sources(folder, recipe.tree.text, rig)
            kept = kept_files(preparation.materials.files)
            write_materials(folder, kept)
            for doubt in (*preparation.materials.doubts, *preparation.recipe.doubts):
                self.screen.message(f"doubt: {doubt}")
            begin = self._beginning(folder, preparation.path, recipe, work, kept)
            return self._record(self._job(folder, options.seed, rig), work, begin)

    def tracked(self, work: Work) -> TimeLeft:
        """Return the counter of a run's steps."""
        return TimeLeft(parts_time(work), earlier_of(work.point))

    def prepare(self) -> Prepared:
        """Read and plan the recipe; raises the same errors as ``run``."""
        options = self.options
        return prepared(options.recipe, options.rig, options.overrides, options.accept_risk)

    def resume(self, folder: Path, reason: str = "") -> int:
        """Resume an interrupted run; return the exit code. ``reason``: why it may resume although something changed.

        Raises CannotStartError, StoreError, InvalidSource.
        """
        only_plain(operator=self.options.operator, reason=reason)
        with RunReader(folder) as reader:
            finished = reader.run().status == WENT_THROUGH
        if finished and (folder / MANIFEST).is_file():
            self.screen.message(f"{folder.name} is complete: nothing is left to do")
            self.screen.result(str(folder))
            return 0
        with ExclusiveUse() as use:
            hold_run(use, folder)
            if finished:  # interrupted between its end and the writing of its tables
                return self._report(folder, RunEnding(Outcome.DONE, "", None))
            self.aside(lambda: recover(folder))
            resumed = self.aside(lambda: prepare(folder, reason, self.options.operator, self.options.accept_risk))
            if isinstance(resumed, str):
                raise CannotStartError(resumed, EXIT_INVALID)
            if refused := refusal(self.options, resumed.rig, self.screen):
                self.screen.message(refused)
                return EXIT_USAGE
            self._foretell(resumed.rig)
            enough_room(folder, resumed.plan, resumed.rig)
            hold_rig(use, resumed.rig, folder.name)
            self.screen.message(resumed.summary)
            # The rest goes into the run's own record, one specimen after the other.
            work = Work(resumed.rig, resumed.plan, (Part(1, resumed.plan),), resumed.point)
            return self._record(self._job(folder, resumed.seed, resumed.rig), work, resumed.begin)

    def aside(self, work: Callable[[], Got]) -> Got:
        """Run slow file work while nothing moves; a service overrides this to keep serving its clients meanwhile."""
        return work()

    def stop(self, level: StopLevel) -> None:
        """Stop the run, also from a signal handler or another thread: the present part ends, and no further part
        begins.
        """
        self._level |= level
        if self._pool is not None:
            self._pool.stop(self._level)
        if self.run_ is not None:
            self._level.tell(self.run_)

    def _lose_screen(self, text: str) -> None:
        """Stop a run that can no longer be shown: it must not continue without a person watching."""
        if self.run_ is not None:
            self.run_.reason = self.run_.reason or text
        self.stop(StopLevel.UNSEEN)

    # -- a watch over the part in this process (tester.run.part_run.PartWatch) -----------------------------------

    def begun(self, run: Run) -> None:
        """Store a part's run, and apply a stop that arrived between two parts."""
        self.run_ = run
        if self._level:
            self.stop(self._level)

    def say(self, text: str) -> None:
        """Show a message on the screen."""
        self.screen.message(text)

    def poll(self, now_s: float, run: Run) -> None:
        """Show the run and handle its prompts."""
        ctx = run.engine.ctx
        self.screen.show(now_s, ctx.progress, self.track.standing())
        self.screen.attend(ctx.prompts)
        for command in self.screen.commands():
            self._command(run, command)

    def _command(self, run: Run, command: str) -> None:
        """Carry out a command from the screen, or report why it had no effect."""
        refused = ""
        if command == "hold":
            refused = run.request_hold()
        elif command == "release":
            refused = run.request_release()
        elif command == "stop":
            run.request_stop("stopped by the operator")
        elif command == "fast stop":
            run.request_stop("stopped by the operator", fast=True)
        self.screen.message(refused or command)

    # -- parts ------------------------------------------------------------------------------------------------

    def _foretell(self, rig: Rig) -> None:
        """Show warnings before a rig starts. Raises CannotStartError."""
        lonely = unattended(self.options.hands, rig, answered=self.screen.answer_yes)
        for text in (*warnings_before(rig, date.fromisoformat(utc_now()[:10])), *([lonely] if lonely else [])):
            self.screen.message(text)

    def _job(self, folder: Path, seed: int, rig: Rig) -> Job:
        o = self.options
        history = self.aside(lambda: run_parts(rig).history(folder.parent, rig))
        # A rig simulated in this process keeps no settings, because it is rebuilt from its file for each run.
        good = self.aside(lambda: last_good_run(rig, folder.parent)) if rig.can.interface != "sim" else None
        return Job(folder, seed, o.lapse, o.bus_log, o.samples, o.faults, history, good, o.leaps, o.hands)

    def _beginning(
        self, folder: Path, path: Path, recipe: LoadedRecipe, work: Work, kept: Sequence[KeptFile]
    ) -> Begin:
        """Return the function that begins the run's record with the whole plan and its provenance."""
        o = self.options
        info = run_info(
            folder.name,
            work.plan,
            recipe,
            work.rig,
            seed=o.seed,
            operator=o.operator,
            recipe_source=recipe_source(path),
            rig_source=rig_source(o.rig, o.overrides),
            risks=accepted_risks(work.rig, o.accept_risk, not_measured(o, work.rig)),
            materials=[file.stored for file in kept],
        )

        def begin(writer: RunWriter) -> None:
            writer.begin_run(info, specimens_of(work.plan), condition_records(work.plan))
            writer.begin_session(session_info(1, 0.0, o.operator))
            for doubt in recipe.doubts:
                writer.event(0.0, "doubt", doubt.message, "warning")
            if info.risk:
                writer.event(0.0, "risk", info.risk, "warning")

        return begin

    def _record(self, job: Job, work: Work, begin: Begin) -> int:
        """Carry out the work and record it in the folder; write the tables and return the exit code."""
        self.folder = job.folder
        self.track = self.tracked(work)
        self.prompts.real = not counts_as_simulated(work.rig)
        for risk in risks_of(work.rig):
            self.screen.message(f"accepted risk ({self.options.accept_risk}): {risk}")
        self._acknowledge(job.folder, work.rig)
        with handled(self._on_signal):
            self.screen.begin(work.plan.name)
            try:
                if len(work.parts) == 1:
                    end = run_part(job, work, work.parts[0], begin, self, self.prompts)
                    self.ending = ending_of([end], 1)
                else:
                    ends = self._ends(job, work)
                    self.ending = put_together(job, work, begin, ends, lambda: self._level, self._tell)
            finally:
                self.screen.end()
            return self._report(job.folder, self.ending)

    def _acknowledge(self, folder: Path, rig: Rig) -> None:
        """Record this start as the acknowledgement of earlier trips on the rig. Raises StoreError, OSError."""
        trips = open_trips(self.options.out, rig, folder)
        for trip in trips:
            self.screen.message(f"acknowledged by this start: {trip}")
        acknowledge(trips, f"{self.options.operator or user()}, by the start of {folder.name}", folder)

    def _ends(self, job: Job, work: Work) -> Generator[PartEnd]:
        """Yield the ends of the parts, which run one after another in this process, or side by side in others."""
        if self.options.jobs > 1:
            yield from side_by_side(job, work, self.options.jobs, self._show, self._take)
            return
        for part in work.parts:
            end = run_part(job, work, part, beginning_of(part, job, work), self, self.prompts)
            yield end
            if end.outcome is not Outcome.DONE:
                return

    def _tell(self, end: PartEnd) -> None:
        self.screen.emit({"event": "part end", "part": end.part, "outcome": end.outcome.value, "reason": end.reason})

    def _show(self, sight: Sight) -> None:
        self.screen.show(sight.now_s, sight.progress, sight.at)

    def _take(self, pool: WorkerPool) -> None:
        self._pool = pool
        if self._level:
            pool.stop(self._level)

    # -- signals ----------------------------------------------------------------------------------------------

    def _on_signal(self, number: int, _frame: FrameType | None) -> None:
        """Stop in a controlled way on TERM, HUP and the first INT, fast on a second INT and on QUIT."""
        if number == QUIT:
            self.stop(StopLevel.FAST)
            return
        if number != signal.SIGINT:
            self.stop(StopLevel.HUNG_UP if number == HANG_UP else StopLevel.TERMINATED)
            return
        self.interrupts += 1
        self.stop(StopLevel.FAST if self.interrupts > 1 else StopLevel.INTERRUPTED)

    # -- results ----------------------------------------------------------------------------------------------

    def _report(self, folder: Path, ending: RunEnding) -> int:
        """Write the tables, print advice about missing values, and return the exit code.

        Conditions that the run did not reach are not listed, only counted in the screen's result.
        """
        say, missing, failed = self.screen.message, list[str](), ""
        try:
            lost, advice = self.aside(lambda: _tables(folder))
        except (OSError, StoreError) as error:
            then = f"; `tester resume {folder}` tries again" if (folder / DATABASE).is_file() else ""
            failed = f"the tables cannot be written: {in_words(error)}{then}"
        else:
            missing = [row.describe() for row in lost]
            for line in advice:
                say(line)
        if ending.reason or failed:
            say(f"{ending.outcome.value}: {ending.reason}" if ending.reason else ending.outcome.value)
        if ending.failed:
            say(f"not everything could be recorded: {ending.failed}")
        if failed:
            say(failed)
        code = ending.exit_code(interrupted_once=self.interrupts == 1, missing=bool(missing))
        code = EXIT_CODES[Outcome.FAILED] if failed else code
        self.screen.emit({"event": "end", "outcome": ending.outcome.value, "exit": code, "missing": missing})
        self.screen.result(str(folder))
        return code


def _tables(folder: Path) -> tuple[list[TableRow], list[str]]:
    """Write a run's tables; return the rows without a value, and lines of advice and about wear."""
    lost = list(write_all(folder))
    advice = [row.advise() for row in [*(row for row in lost if row.tried), *doubtful(folder)]]
    with RunReader(folder) as reader:
        return lost, [*advice, *results_of(reader).wear_lines()]
