"""The service: the process that owns the rig. One thread ticks, and between two ticks it hears and tells clients."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from types import FrameType
from typing import Protocol, runtime_checkable

from drivers.ports import BusLost
from recipes import UnknownRecipe
from tester import clock
from tester.control.state import Mode
from tester.engine.build import build_run
from tester.engine.prompts import Prompts
from tester.engine.run import Outcome
from tester.engine.tickers import TickStatistics, run_real_time, run_simulated
from tester.lock import RUN_LOCK, ExclusiveUse, user_of
from tester.rig import load_rig
from tester.service.commands import (
    Acknowledge,
    Answer,
    Arm,
    Hold,
    Jog,
    Release,
    ResumeRun,
    RunRecipe,
    Stop,
    Tare,
)
from tester.service.desk import Desk
from tester.service.hub import Hub
from tester.service.link import Order
from tester.service.manual import empty_plan, no_record, take_over
from tester.service.running import RunScreen, ServiceSession
from tester.service.state import RunView
from tester.session import CannotStartError, SessionOptions, connect_ports, hold_rig
from tester.source import InvalidSource
from tester.store.catalogue import find_run
from tester.store.reader import DATABASE, RunReader
from tester.store.schema import StoreError

NEWEST_RUNS = 200
"""So many runs are looked at for one that was cut off, the newest first."""
REFUSED = (CannotStartError, InvalidSource, UnknownRecipe, StoreError, OSError)
"""What keeps a run from beginning."""


@dataclass(frozen=True, slots=True)
class ServiceOptions:
    """What `tester serve` was told."""

    rig: str = "sim"
    overrides: tuple[str, ...] = ()
    runs: Path = Path("runs")
    spool: Path = Path()
    """The service's own folder: recipes that come as text are put there."""


class Service:
    """Carries out one thing at a time: a run, manual mode, or nothing."""

    def __init__(self, options: ServiceOptions, hub: Hub) -> None:
        """Read the rig file; raises InvalidSource. Nothing is connected."""
        self.options = options
        self.rig = load_rig(options.rig, options.overrides)
        self.desk = Desk(hub, self.rig, options.runs, self.obey, self.lost_control)
        self.ending = False
        self.job: Order | None = None
        self._armed_by = 0

    # -- the loop ---------------------------------------------------------------------------------------------

    def serve(self) -> None:
        """Serve until the process is told to end (TERM, INT), and leave at standstill."""
        desk = self.desk
        with self._signals():
            desk.interrupted = tuple(interrupted_runs(self.options.runs))
            for name in desk.interrupted:
                desk.tell("run", f"{name} was cut off: `tester resume {name}` goes on with it", "warning")
            while not self.ending:
                desk.poll(0.0)
                if self.job is not None:
                    self._carry_out(self.job)
                    self.job = None
                else:
                    desk.wait()
        desk.tell("service", "the service ends")
        desk.show()

    def _signals(self) -> Signals:
        return Signals(self.end)

    def end(self) -> None:
        """End as soon as nothing is under way any more."""
        self.ending = True

    # -- orders -----------------------------------------------------------------------------------------------

    def obey(self, order: Order) -> None:
        """Carry out an order, or say why not."""
        action = order.action
        if isinstance(action, Stop):
            self._stop(order, action)
        elif isinstance(action, RunRecipe | ResumeRun):
            self._begin(order)
        elif isinstance(action, Arm):
            self._arm(order, action)
        elif isinstance(action, Acknowledge):
            self._acknowledge(order, action)
        elif isinstance(action, Answer):
            self._reply(order, self._answer(order, action))
        elif isinstance(action, Jog | Tare):
            self._reply(order, self._by_hand(action))
        else:
            self._reply(order, self._hold(order, action))

    def _reply(self, order: Order, refusal: str) -> None:
        hub = self.desk.hub
        if refusal:
            hub.refuse(order, refusal)
        else:
            hub.accept(order)

    def _stop(self, order: Order, action: Stop) -> None:
        """STOP: whoever says it, whatever is under way."""
        desk = self.desk
        kind = "fast stop" if action.fast else "stop"
        desk.tell("command", f"{kind} by {order.name}", "warning")
        if desk.watch is not None:
            desk.watch.run.request_stop(f"{kind} by {order.name}", fast=action.fast)
        elif self.job is not None:
            desk.hub.refuse(self.job, f"{kind} by {order.name}")
            self.job = None
        desk.hub.accept(order)

    def _hold(self, order: Order, action: Hold | Release) -> str:
        """Hold or release a run; return "" or why not."""
        watch = self.desk.watch
        if watch is None:
            return "nothing runs"
        name = "hold" if isinstance(action, Hold) else "release"
        self.desk.tell("command", f"{name} by {order.name}")
        run = watch.run
        if not isinstance(run, Holdable):
            return "this rig cannot be held"
        if isinstance(action, Hold):
            return run.request_hold(f"held by {order.name}")
        return run.request_release(f"released by {order.name}")

    def _acknowledge(self, order: Order, action: Acknowledge) -> None:
        """Acknowledge alarms, a latched rig, and what was found at the start. Nothing moves by it."""
        desk = self.desk
        count = desk.alarms.acknowledge(action.number, order.name)
        refusal = "" if count or desk.latched or desk.interrupted else "nothing to acknowledge"
        run = desk.watch.run if desk.watch is not None else None
        if run is not None and run.engine.control.state.mode is Mode.LATCHED and isinstance(run, Holdable):
            refusal = run.request_ack()
        if not refusal and action.number == 0 and run is None:
            if desk.latched:
                desk.tell("mode", f"acknowledged by {order.name}: the rig is idle")
            desk.latched, desk.interrupted = "", ()
        self._reply(order, refusal)

    def _answer(self, order: Order, action: Answer) -> str:
        """Answer the prompt that waits; return "" or why not."""
        watch = self.desk.watch
        waiting = watch.run.engine.ctx.prompts.waiting if watch is not None else None
        if waiting is None or waiting.number != action.number:
            return f"prompt {action.number} does not wait for an answer"
        self.desk.tell("prompt", f"{order.name} answers: {action.answer}")
        if action.answer.strip().lower() not in ("n", "no"):
            waiting.answer = action.answer.strip() or "yes"
        return ""

    def _by_hand(self, action: Jog | Tare) -> str:
        """Take a step in manual mode; return "" or why not."""
        desk = self.desk
        if desk.hand is None or desk.watch is None or desk.watch.mode[0] != "RUN":
            return "manual mode is not armed"
        ctx = desk.watch.run.engine.ctx
        if isinstance(action, Tare):
            return desk.hand.tare(ctx)
        return desk.hand.jog(ctx, action.axis, action.direction)

    def lost_control(self) -> None:
        """Disarm manual mode: whoever armed it does not control any more."""
        hand = self.desk.hand
        if hand is not None and self.desk.hub.presence.controller_id != self._armed_by:
            hand.disarm()

    # -- what begins ------------------------------------------------------------------------------------------

    def _begin(self, order: Order) -> None:
        """Take an order that begins something, if nothing is under way."""
        refusal = self._occupied()
        if refusal:
            self.desk.hub.refuse(order, refusal)
        else:
            self.job = order

    def _occupied(self) -> str:
        desk = self.desk
        if self.ending:
            return "the service is ending"
        if desk.hand is not None:
            return "manual mode is armed"
        if desk.watch is not None or self.job is not None:
            return f"a run is under way: {desk.run.name if desk.run is not None else 'it begins'}"
        if desk.latched:
            return f"the rig is latched ({desk.latched}): acknowledge first"
        return ""

    def _arm(self, order: Order, action: Arm) -> None:
        if action.on:
            self._begin(order)
            return
        hand = self.desk.hand
        if hand is not None:
            hand.disarm()
        self._reply(order, "" if hand is not None else "manual mode is not armed")

    def _carry_out(self, order: Order) -> None:
        """Carry out what an order begins, to its end."""
        action = order.action
        self.desk.run = None
        if isinstance(action, Arm):
            self._armed_by = order.client
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
            out=self.options.runs,
            seed=action.seed,
            lapse=action.speed,
            operator=action.operator,
        )
        self._session(order, options, action.yes, action.notes, lambda session: session.run())

    def _resume(self, order: Order, action: ResumeRun) -> None:
        try:
            folder = find_run(action.run, self.options.runs)
        except StoreError as error:
            self.desk.hub.refuse(order, str(error))
            return
        options = SessionOptions(out=self.options.runs, lapse=action.speed, operator=order.name)
        self._session(order, options, action.yes, "", lambda session: session.resume(folder, action.reason))

    def _spooled(self, action: RunRecipe) -> str:
        """Write a recipe that came as text where the session can read it."""
        if not action.text:
            return ""
        file = self.options.spool / "recipe.yaml"
        file.write_text(action.text, encoding="utf-8")
        return str(file)

    def _session(
        self, order: Order, options: SessionOptions, yes: bool, notes: str, work: Callable[[ServiceSession], int]
    ) -> None:
        """Carry out a session from its beginning to its tables."""
        desk = self.desk
        view = RunView("", "", "", "", notes, options.operator, options.seed, self.rig.simulated, options.lapse, "",
                       Outcome.RUNNING.value, "", None, ())  # fmt: skip
        begun = False

        def begin(view: RunView) -> None:
            nonlocal begun
            begun = True
            desk.hub.accept(order, {"run": view.name, "folder": view.folder})

        screen = RunScreen(desk, view, answer_yes=yes, begun=begin)
        session = ServiceSession(options, screen, self.end)
        problem = ""
        try:
            code = work(session)
        except REFUSED as error:
            problem, code = str(error), None
        if not begun:
            desk.hub.refuse(order, problem or "; ".join(screen.messages) or "the run has ended before it began")
            desk.detach(None)
            return
        run = session.run_
        outcome = run.outcome if run is not None else Outcome.FAILED
        ended = replace(screen.view, outcome=outcome.value, reason=problem or (run.reason if run is not None else ""),
                        exit=code, missing=tuple(screen.missing))  # fmt: skip
        desk.ended(ended, outcome)

    def _manual(self, order: Order) -> None:
        """Connect the rig and let the client that asked move it."""
        desk, rig = self.desk, self.rig
        view = RunView("manual mode", "", "", "", "", order.name, None, rig.simulated, 1.0, clock.utc_now(),
                       Outcome.RUNNING.value, "", None, ())  # fmt: skip
        with ExclusiveUse() as use:
            try:
                hold_rig(use, rig, "manual mode")
                ports, world, attendant = connect_ports(rig, 0, None)
            except (CannotStartError, BusLost) as error:
                desk.hub.refuse(order, str(error))
                return
            run = build_run(rig, empty_plan(), ports, attendant, no_record(), Prompts())
            desk.attach(run, view, take_over(run))
            desk.hub.accept(order)
            statistics = TickStatistics()
            if world is not None:
                run_simulated(run, world, lapse=1.0, poll=self._poll_manual)
            else:
                run_real_time(run, None, poll=self._poll_manual, statistics=statistics)
        desk.ended(replace(view, outcome=run.outcome.value, reason=run.reason), run.outcome)

    def _poll_manual(self, now_s: float) -> None:
        if self.ending and self.desk.watch is not None:
            self.desk.watch.run.request_stop("the service ends")
        self.desk.poll(now_s)


@runtime_checkable
class Holdable(Protocol):
    """A run that can be held and acknowledged."""

    def request_hold(self, why: str) -> str:
        """Hold; return "" or why not."""
        ...

    def request_release(self, why: str) -> str:
        """Go on; return "" or why not."""
        ...

    def request_ack(self) -> str:
        """Acknowledge a trip; return "" or why not."""
        ...


class Signals:
    """TERM and INT end the service, HUP is ignored, while the block lasts."""

    def __init__(self, end: Callable[[], None]) -> None:
        """``end``: what to call."""
        self._end = end
        self._before: dict[int, signal.Handlers | Callable[[int, FrameType | None], object] | int | None] = {}

    def __enter__(self) -> None:
        """Take over."""
        for number in (signal.SIGINT, signal.SIGTERM):
            self._before[number] = signal.signal(number, self._on_signal)
        if hasattr(signal, "SIGHUP"):
            self._before[signal.SIGHUP] = signal.signal(signal.SIGHUP, signal.SIG_IGN)

    def __exit__(self, *_: object) -> None:
        """Give back."""
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        self._end()


def interrupted_runs(runs: Path) -> Iterator[str]:
    """Yield the runs in a folder that were cut off: open, and nobody at work on them."""
    folders = sorted(runs.iterdir(), reverse=True)[:NEWEST_RUNS] if runs.is_dir() else []
    for folder in reversed(folders):
        if not (folder / DATABASE).is_file() or user_of(folder / RUN_LOCK) is not None:
            continue
        with suppress(StoreError), RunReader(folder) as reader:
            if reader.run().status == Outcome.RUNNING.value:
                yield folder.name
