"""A run in the service: the session of `tester run`, with clients in place of a terminal. Also the records of manual
mode.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass, replace
from pathlib import Path
from types import FrameType
from typing import Final, TypeVar, cast

from tester.base import clock
from tester.inputs.recipe.time_estimate import Estimate
from tester.inputs.rig import Rig
from tester.inputs.rig.further_sensors import quantities_on
from tester.machine.manual import NAME
from tester.machine.run import Run
from tester.machine.tickers import TickStatistics
from tester.run.endings import CannotStartError, StopLevel
from tester.run.folder import Begin, Job, Work, earlier_of, make_folder, parts_time
from tester.run.kind_lookup import recipe_part
from tester.run.latch import MANUAL_RUNS
from tester.run.part_run import Unsampled
from tester.run.preconditions import Prepared
from tester.run.provenance import accepted_risks
from tester.run.reporter import ReportScreen
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.service.planning import Task, planned
from tester.service.state_publisher import Desk
from tester.service.state_view import RunView, TickView
from tester.service.values import PlanTrack
from tester.store.disk import expected_bytes
from tester.store.record_file import DATABASE
from tester.store.records import RunInfo
from tester.store.writer import RunWriter

LOOK_S: Final = 0.02
"""Period at which the owner serves its clients while other work is under way, s, as between two ticks."""


def aside(work: Callable[[], Got], look: Callable[[], object]) -> Got:
    """Run ``work`` in a thread and return its result; call ``look`` every ``LOOK_S`` until it is done.

    ``work`` is never interrupted: it may be writing. Raises what it raises.
    """
    with ThreadPoolExecutor(1, thread_name_prefix="aside") as thread:
        done = thread.submit(work)
        while not wait((done,), LOOK_S).done:
            look()
        return done.result()


Got = TypeVar("Got")

RECENT_S = 1.0
"""Period of measuring lateness, s. The reported value covers one to two periods, more than the time between states, so
that no late scan is missed.
"""


class ServiceSession(Session):
    """A session that attaches its runs to the desk. ``begun`` is called once, with the view of the run."""

    def __init__(
        self,
        options: SessionOptions,
        screen: RunScreen,
        on_signal: Callable[[], None],
        begun: Callable[[RunView], None],
        meanwhile: Callable[[], str],
    ) -> None:
        """``on_signal`` is called when the process is asked to end, ``meanwhile`` during planning.

        ``meanwhile`` returns why planning must stop, "" if it may continue.
        """
        super().__init__(options, screen)
        self.desk = screen.desk
        self.view = screen.view
        self._screen = screen
        self._tell_signal = on_signal
        self._tell_begun = begun
        self._meanwhile = meanwhile
        self._expected: Estimate | None = None
        self._punctual = Punctuality()
        self.accepts: Callable[[Prepared], str] = lambda _plan: ""
        """Returns why the planned run must not begin after all, "" if it may."""

    def prepare(self) -> Prepared:
        """Plan the recipe in a process of its own while serving clients; STOP ends it."""
        o = self.options
        plan = planned(Task(o.recipe, o.rig, o.overrides, o.accept_risk), self._meanwhile)
        self._expected = plan.expected
        if why := self.accepts(plan):
            raise CannotStartError(why)
        return plan

    def aside(self, work: Callable[[], Got]) -> Got:
        """Run ``work`` in a thread while serving clients. Raises CannotStartError if STOP arrives before the run
        begins.
        """
        given_up: list[str] = []

        def look() -> None:
            why = self._meanwhile()
            if why and not given_up:
                given_up.append(why)

        got = aside(work, look)
        if given_up and not self.view.name:
            raise CannotStartError(given_up[0])
        return got

    def begun(self, run: Run) -> None:
        """Attach the run of a part to the desk; the first part also begins the whole run."""
        super().begun(run)
        track = self.track
        assert isinstance(track, PlanTrack)
        first = not self.view.name
        if first:
            folder = self.folder
            assert folder is not None
            self.view = replace(
                self.view, name=folder.name, folder=str(folder), recipe=self._screen.name, started_utc=clock.utc_now()
            )
        run.stays_latched = True
        self.desk.attach(run, track, self.view)
        self.desk.stop_rest = self._stop_rest
        self.desk.stop_first()  # carry out a STOP that arrived during preparation
        if first:
            self._tell_begun(self.view)

    def rested(self) -> None:
        """Let STOP be confirmed at once: it need not wait for this part's record or the next part's connection."""
        self.desk.gateway.lane.end_ticking()

    def poll(self, now_s: float, run: Run) -> None:
        """Update the desk, which then serves clients."""
        self.desk.tick = self._punctual.look(self.statistics, clock.monotonic())
        self.desk.specimen(run)
        self.desk.poll(now_s)

    def _record(self, job: Job, work: Work, begin: Begin) -> int:
        """Estimate the plan before anything moves, then record the run as usual."""
        expected = self._expected = self._expected or recipe_part(work.rig).estimate(work.plan, work.rig)
        self.desk.needed = round(expected_bytes(work.plan, expected))
        return super()._record(job, work, begin)

    def tracked(self, work: Work) -> PlanTrack:
        """Return the object that counts a run's steps and describes them for clients."""
        parts = parts_time(work, self._expected)
        return PlanTrack(work.plan.name, parts, earlier_of(work.point))

    def _stop_rest(self, fast: bool) -> None:
        """Begin no further part."""
        self.stop(StopLevel.FAST if fast else StopLevel.INTERRUPTED)

    def _on_signal(self, number: int, _frame: FrameType | None) -> None:
        self._tell_signal()
        if self.run_ is not None:
            self.run_.stays_latched = False  # no client will be present to acknowledge
        super()._on_signal(number, _frame)


def open_record(runs: Path, rig: Rig, operator: str, accept_risk: str = "") -> RunWriter:
    """Open the record of one stay in manual mode: a record of its own, without samples, in ``runs/.manual``.

    It is not a run: it holds commands, modes, trips and tares, and no list of runs shows it. Raises OSError,
    sqlite3.Error, StoreError.
    """
    folder = make_folder(runs / MANUAL_RUNS, NAME)
    writer = Unsampled(folder / DATABASE, quantities_on(rig), clock=clock.monotonic, utc=clock.utc_now)
    started_utc = clock.utc_now()
    part = recipe_part(rig)
    info = RunInfo(folder.name, NAME, "", rig.text, started_utc, rig.simulated, part.kind, part.axes, operator=operator,
                   metadata=accepted_risks(rig, accept_risk))  # fmt: skip
    writer.begin_run(info, [], [])
    return writer


@dataclass(slots=True)
class Punctuality:
    """How late scans are: the worst since the run began, and the worst of the last one to two seconds."""

    _worst_s: float = 0.0
    _now_s: float = 0.0
    _before_s: float = 0.0
    _turn_s: float = 0.0
    """Time at which the present period began (tester.base.clock.monotonic)."""

    def look(self, statistics: TickStatistics, wall_s: float) -> TickView:
        """Return the present view of the ticker's statistics, and reset the worst lateness in them."""
        if wall_s - self._turn_s >= RECENT_S:
            self._before_s = self._now_s if wall_s - self._turn_s < 2.0 * RECENT_S else 0.0
            self._now_s, self._turn_s = 0.0, wall_s
        late_s, statistics.late_max_s = statistics.late_max_s, 0.0
        if late_s > self._now_s:
            self._now_s = late_s
            self._worst_s = max(self._worst_s, late_s)
        return TickView(0.0, self._worst_s, statistics.overruns, max(self._now_s, self._before_s))


class RunScreen(ReportScreen):
    """Forwards a session's output to the desk, which reads the run itself; clients answer prompts by command."""

    can_ask = True

    def __init__(self, desk: Desk, view: RunView, *, answer_yes: bool) -> None:
        """``view``: the view of the run before it begins."""
        self.desk = desk
        self.view = view
        self.answer_yes = answer_yes
        self.name = ""
        self.missing: list[str] = []
        self.messages: list[str] = []

    def begin(self, name: str) -> None:
        """Store the recipe's name."""
        self.name = name

    def end(self) -> None:
        """Publish the last state before the tables are written; no ticks follow."""
        self.desk.show()
        self.desk.gateway.lane.end_ticking()

    def message(self, text: str) -> None:
        """Send every client a message."""
        self.messages.append(text)
        self.desk.tell("message", text)

    def emit(self, record: dict[str, object]) -> None:
        """Keep the missing conditions from the record that a session emits at its end."""
        missing = record.get("missing")
        if record.get("event") == "end" and isinstance(missing, list):
            self.missing = [str(name) for name in cast("list[object]", missing)]
