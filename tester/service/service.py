"""The service: the process that owns the rig. One thread ticks, and serves clients between two ticks."""

from __future__ import annotations

import signal
import sqlite3
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import TypeVar

from drivers.ports import BusLost
from recipes import UnknownRecipe
from tester.base import clock
from tester.base.clock import Pace
from tester.base.lock import ExclusiveUse
from tester.base.processes import HANG_UP, QUIT, SUSPENDING, caught
from tester.base.source import InvalidSource
from tester.base.trouble import in_words
from tester.machine.manual import NAME, ManualExecutor
from tester.machine.run import Outcome, Run
from tester.machine.tickers import TickedWorld, TickStatistics, collector_at_rest, run_real_time, run_simulated
from tester.queue.items import QueueItem
from tester.queue.recover import end_of
from tester.run.endings import CannotStartError
from tester.run.folder import part_time
from tester.run.kind_lookup import load_rig, run_parts
from tester.run.part_run import closed_early, left_safe
from tester.run.preconditions import hold_rig, not_measured
from tester.run.rig_wires import connect_ports
from tester.run.session_options import SessionOptions
from tester.service.command_handler import Orders
from tester.service.commands import (
    Arm,
    ResumeRun,
    RunRecipe,
)
from tester.service.gateway_link import GatewayLink
from tester.service.interrupted import interrupted_runs, is_interrupted
from tester.service.item_notice import item_end
from tester.service.preflight import left_on_rig, past_of
from tester.service.queue_desk import QueueDesk, QueueRig
from tester.service.queue_evidence import objection
from tester.service.queue_run import note_of, options_of, work_of
from tester.service.running import LOOK_S, RunScreen, ServiceSession, aside, open_record
from tester.service.service_link import Order
from tester.service.state_publisher import Desk, do_nothing
from tester.service.state_view import RunView
from tester.service.values import PlanTrack
from tester.store.record_schema import StoreError
from tester.store.run_folders import RunStatus, find_run, run_status
from tester.store.writer import RunWriter

Got = TypeVar("Got")

RECIPES = ".recipes"
"""Folder, in that of the runs, for recipes sent as text; a file's name is the hash of its content."""
LOOK_EVERY_S = 10.0
"""Period at which the idle service checks the interrupted runs, s."""
SILENT_S = 1.0
"""Time without a sign of life from its screen after which manual mode ends, s."""
MANUAL_LAPSE = 1.0
"""Speed of a simulated rig in manual mode: real time."""
REFUSED = (CannotStartError, InvalidSource, UnknownRecipe, StoreError, OSError, sqlite3.Error)
"""Errors that prevent the start of a run."""


@dataclass(frozen=True, slots=True)
class ServiceOptions:
    """Options of `tester serve`."""

    rig: str = "sim"
    overrides: tuple[str, ...] = ()
    runs: Path = Path("runs")
    accept_risk: str = ""
    """Reason for accepting safety keys of this rig that are looser than they should be."""
    allowed: tuple[str, ...] = ()
    """Names of extensions that may be loaded, in addition to those in ``TESTER_ALLOW``."""


class Service:
    """Carries out one thing at a time: a run, manual mode, or nothing."""

    def __init__(self, options: ServiceOptions, gateway: GatewayLink) -> None:
        """Read the rig file; raises InvalidSource. Connect nothing."""
        self.options = options
        self.rig = load_rig(options.rig, options.overrides, options.accept_risk)
        self.desk = Desk(gateway, self.rig, options.runs)
        self.orders = Orders(self.desk)
        rig = QueueRig(options.rig, options.overrides, options.accept_risk, options.runs)
        self.queue = self.orders.queue = QueueDesk(self.desk, rig, self.orders.end_item, self._busy)
        self.desk.notices.item_of = lambda view: item_end(self.queue.queue, view, latched=bool(self.desk.latched))
        self._look_due_s = 0.0

    # -- the loop ---------------------------------------------------------------------------------------------

    def serve(self) -> None:
        """Serve until the process receives TERM or INT, then bring the rig to a standstill."""
        desk = self.desk
        asking = (signal.SIGINT, signal.SIGTERM, QUIT)
        with caught(lambda _number, _frame: self.end(), asking, (HANG_UP, *SUSPENDING)):
            desk.latch_again()  # before the first order
            self.queue.open()
            desk.look = self.orders.look
            desk.interrupted = self._aside(lambda: tuple(interrupted_runs(self.options.runs)))
            self._look_back()
            for name in desk.interrupted:
                desk.tell("run", f"{name} was cut off: `tester resume {name}` resumes it", "warning")
            while not self.orders.ending:
                desk.poll(0.0)
                if self.orders.job is not None:
                    self._carry_out(self.orders.job)
                    self.orders.job = None
                    self._look_back()
                    self._look_again()
                elif (item := self.queue.due()) is not None:
                    self._run_item(item)
                else:
                    desk.wait()
                    if clock.monotonic() >= self._look_due_s:
                        self._look_again()
        self.queue.close()
        desk.tell("service", "the service ends")
        desk.show()

    def _look_back(self) -> None:
        """Read from stored runs what they left on the rig and what they show about it."""
        runs, rig, kind = self.options.runs, self.rig, self.desk.kind
        self.desk.past = self._aside(lambda: past_of(runs, kind))
        self.desk.history = self._aside(lambda: run_parts(rig).history(runs, rig))

    def _look_again(self) -> None:
        """Remove from the list runs that have since been resumed, by this service or by a command."""
        self._look_due_s = clock.monotonic() + LOOK_EVERY_S
        runs = self.options.runs
        names = self.desk.interrupted
        self.desk.interrupted = self._aside(lambda: tuple(name for name in names if is_interrupted(runs / name)))

    def _aside(self, work: Callable[[], Got]) -> Got:
        """Read the store in a thread while no work is under way, and keep serving clients."""
        return aside(work, lambda: self.desk.poll(0.0))

    def end(self) -> None:
        """End as soon as nothing is under way."""
        self.orders.ending = True

    # -- what begins ------------------------------------------------------------------------------------------

    def _carry_out(self, order: Order) -> None:
        """Carry out an order that begins work, until that work ends."""
        action = order.action
        self.desk.run = None
        if isinstance(action, Arm):
            self.orders.armed_by = order.client
            self._manual(order)
        elif isinstance(action, RunRecipe):
            self._run(order, action)
        elif isinstance(action, ResumeRun):
            self._resume(order, action)

    def _run(self, order: Order, action: RunRecipe) -> None:
        spooled = self._spooled(action)
        options = SessionOptions(
            recipe=spooled or action.recipe,
            rig=action.rig or self.options.rig,
            overrides=(*(() if action.rig else self.options.overrides), *action.overrides),
            accept_risk="" if action.rig else self.options.accept_risk,
            out=self.options.runs,
            seed=action.seed,
            lapse=action.speed,
            operator=action.operator,
        )
        self._session(order, options, action.yes, action.notes, lambda session: session.run())

    def _run_item(self, item: QueueItem) -> None:
        """Run an item of the queue to its end, on record before it begins and after."""
        desk, queue = self.desk, self.queue
        by = f"the queue, item {item.id} of {item.by}"
        order = self.orders.job = Order(0, by, 0, RunRecipe(item.name, yes=item.yes))
        refused: list[str] = []
        queue.taken(item, refused.append)
        self._settled()
        if refused[0]:
            self.orders.job = None
            return
        if why := objection(desk):
            self.orders.job = None
            queue.returned(item, why)
            self._settled()
            return
        desk.run = None
        options = options_of(item, queue.rig, queue.recipe(item))
        work = work_of(queue.queue.entry(item.id))
        view, problem = self._session(
            order, options, item.yes, note_of(item), work, lambda run: queue.began(item, run)
        )
        self.orders.job = None
        if view is None:
            queue.returned(item, problem)
        else:
            self._look_back()
            unknown = desk.past is None or not desk.past.left.known
            end = end_of(RunStatus(view.outcome))
            queue.ended(item, end, view.reason, view.name, stands=bool(desk.latched) or unknown)
        self._settled()
        self._look_again()

    def _settled(self) -> None:
        """Serve clients until the queue's changes are on the disk."""
        while self.queue.unsettled:
            self.desk.poll(0.0)
            clock.sleep_until(clock.monotonic() + LOOK_S)

    def _busy(self) -> str:
        """Return why no item of the queue may begin; "" if it may."""
        return self.orders.occupied()

    def _resume(self, order: Order, action: ResumeRun) -> None:
        try:
            folder = find_run(action.run, self.options.runs)
        except StoreError as error:
            self.desk.gateway.refuse(order, str(error))
            return
        options = SessionOptions(
            accept_risk=self.options.accept_risk, out=self.options.runs, lapse=action.speed, operator=order.name
        )
        self._session(order, options, action.yes, "", lambda session: session.resume(folder, action.reason))

    def _spooled(self, action: RunRecipe) -> str:
        """Write a recipe sent as text to a file, where the session reads it and a resumed run finds it unchanged."""
        if not action.text:
            return ""
        digest = sha256(action.text.encode()).hexdigest()[:16]
        file = self.options.runs / RECIPES / f"{digest}.yaml"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(action.text, encoding="utf-8", newline="\n")
        return str(file)

    def _session(
        self, order: Order, options: SessionOptions, yes: bool, notes: str, work: Callable[[ServiceSession], int],
        began: Callable[[str], None] = do_nothing,
    ) -> tuple[RunView | None, str]:  # fmt: skip
        """Run a session to its end, including its tables. Return the run's last view, None if it did not begin, and the
        problem. ``began`` receives the run's name when it begins.
        """
        desk = self.desk
        view = RunView("", "", "", "", "", options.operator, options.seed, self.rig.simulated, options.lapse, "",
                       Outcome.RUNNING.value, "", None, ())  # fmt: skip

        def begun(view: RunView) -> None:
            began(view.name)
            desk.gateway.accept(order, {"run": view.name, "folder": view.folder})
            desk.command(f"{order.action.command} by {order.by}")
            if notes and desk.watch is not None:
                desk.watch.run.engine.ctx.journal.event(0.0, "note", notes)

        screen = RunScreen(desk, view, answer_yes=yes)

        def meanwhile() -> str:
            desk.poll(0.0 if desk.watch is None else desk.now_s)
            if self.orders.ending:
                return "the service ends"
            return "" if self.orders.job is order else "stopped while it was planned"

        session = ServiceSession(options, screen, self.end, begun, meanwhile)
        problem, code = "", None
        try:
            code = work(session)
        except REFUSED as error:
            problem = in_words(error)
        if not session.view.name:
            problem = problem or "; ".join(screen.messages) or "the run has ended before it began"
            if self.orders.job is order:  # otherwise STOP has already refused it
                desk.gateway.refuse(order, problem)
            desk.detach(None)
            return None, problem
        outcome = session.ending.outcome if session.ending is not None else Outcome.FAILED
        reason = problem or (session.ending.reason if session.ending is not None else "")
        known, missing = desk.run or session.view, tuple(screen.missing)
        status = run_status(outcome.value, held=False, missing=bool(missing))
        last = replace(known, outcome=status.value, reason=reason, exit=code, missing=missing)
        desk.ended(last, outcome)
        return last, problem

    def _manual(self, order: Order) -> None:
        """Connect the rig, and let the client that armed manual mode move it."""
        desk, rig, kind = self.desk, self.rig, self.desk.kind
        view = RunView(NAME, "", "", "", "", order.name, None, rig.simulated, 1.0, clock.utc_now(),
                       Outcome.RUNNING.value, "", None, ())  # fmt: skip
        with ExclusiveUse() as use:
            try:
                o = self.options
                not_measured(SessionOptions("", o.rig, o.overrides, o.accept_risk, out=o.runs), rig)
                hold_rig(use, rig, NAME)
                record = open_record(self.options.runs, rig, order.name, self.options.accept_risk)
                left = self._aside(lambda: left_on_rig(self.options.runs, rig, kind))
                history = self._aside(lambda: run_parts(rig).history(self.options.runs, rig))
            except REFUSED as error:
                desk.gateway.refuse(order, in_words(error))
                return
            with closing(record), closed_early(record):
                if self.orders.job is not order:
                    record.finish(Outcome.STOPPED.value, "stopped before anything was connected", 0.0)
                    return
                try:
                    ports, world, attendant = connect_ports(rig, 0, None)
                except BusLost as error:
                    record.finish(Outcome.UNREACHABLE.value, str(error), 0.0)
                    desk.gateway.refuse(order, str(error))
                    return
                session = kind.by_hand(rig, ports, attendant, record, left, history)
                run, hand = session.run, session.executor
                track = PlanTrack(hand.plan.name, [part_time(rig, hand.plan)])
                track.begin_part(hand.plan)
                with collector_at_rest():  # before the first tick: no long pause from here on
                    desk.attach(run, track, view, hand)
                    self.orders.lost_control()  # another client may have taken control since the order
                    record.event(0.0, kind.machine.specimen, session.mounted)
                    desk.gateway.accept(order)
                    desk.command(f"arm by {order.by}")
                    with closing(ports), left_safe(run):
                        seconds = self._by_hand(run, hand, world, ports.pace, record)
                        desk.gateway.lane.end_ticking()  # STOP need not wait for the record
                record.finish(run.outcome.value, run.reason, seconds)
        desk.ended(replace(view, outcome=run.outcome.value, reason=run.reason), run.outcome)

    def _by_hand(
        self, run: Run, hand: ManualExecutor, world: TickedWorld | None, pace: Pace | None, record: RunWriter
    ) -> float:
        """Tick manual mode to its end; return its duration, s."""
        gateway = self.desk.gateway
        gateway.attended()  # the client that armed counts as present

        def poll(now_s: float) -> None:
            hand.expire(now_s)
            if self.orders.ending:
                run.request_stop("the service ends", cool=False)
            if record.failed:
                run.request_stop(f"manual mode can no longer be recorded: {record.failed}")
            self.desk.poll(now_s)
            # Check after the poll, which reads signs of life that arrived while this process was busy.
            if gateway.silent_s > SILENT_S and not hand.finished:
                self.desk.tell("mode", f"manual mode ends: no sign of its screen for {SILENT_S:g} s", "warning")
                hand.disarm()

        if world is not None:
            return run_simulated(run, world, lapse=MANUAL_LAPSE, poll=poll)
        return run_real_time(run, None, poll=poll, statistics=TickStatistics(), pace=pace)
