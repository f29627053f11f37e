"""The service: the process that owns the rig. One thread ticks, and between two ticks it hears and tells clients."""

from __future__ import annotations

import signal
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from types import FrameType

from recipes import UnknownRecipe
from tester import clock
from tester.engine.build import build_run
from tester.engine.prompts import Prompts
from tester.engine.run import Outcome
from tester.engine.tickers import TickStatistics, run_real_time, run_simulated
from tester.lock import RUN_LOCK, ExclusiveUse, user_of
from tester.rig import RigConfig, load_rig
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
    """Folder for recipes that come as text."""


class Service:
    """Carries out one thing at a time: a run, manual mode, or nothing."""

    def __init__(self, options: ServiceOptions, hub: Hub) -> None:
        """Read the rig file; raises InvalidSource. Nothing is connected."""
        self.options = options
        self.rig = load_rig(options.rig, options.overrides)
        self.desk = Desk(hub, self.rig, options.runs, self.obey, self.lost_control)
        self.ending = False
        self.job: Order | None = None
        self._busy = ""
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
        elif isinstance(action, Jog):
            hand, watch = self.desk.hand, self.desk.watch
            armed = hand is not None and watch is not None
            refusal = hand.jog(watch.run.engine.ctx, action.axis, action.direction) if armed else "manual mode is not armed"
            self._reply(order, refusal)
        elif isinstance(action, Tare):
            hand, watch = self.desk.hand, self.desk.watch
            armed = hand is not None and watch is not None
            self._reply(order, hand.tare(watch.run.engine.ctx) if armed else "manual mode is not armed")
        else:
            self._hold(order, action)

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
        elif self.job is not None and not self._busy:
            desk.hub.refuse(self.job, f"{kind} by {order.name}")
            self.job = None
        desk.hub.accept(order)
