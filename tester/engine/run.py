"""One run from connection to standstill: what a ticker drives."""

from __future__ import annotations

from enum import Enum

from drivers.ports import BusLost
from tester.control.state import Mode
from tester.engine.connect import Connector, Stage
from tester.engine.engine import Engine

POWER_OFF_S = 2.0
"""A drive that has not switched its power off by then is released all the same, s [A]."""
RELEASE_S = 5.0
"""The drives have let go of our heartbeat by then, s [A]."""


class Outcome(Enum):
    """How a run ended."""

    RUNNING = "running"
    DONE = "done"
    UNREACHABLE = "rig unreachable"
    FAILED = "failed"
    TRIPPED = "tripped"
    STOPPED = "stopped"


class Run:
    """Connection, recipe, stop, standstill."""

    def __init__(self, connector: Connector, engine: Engine) -> None:
        """Nothing is sent before the first ``tick``."""
        self.connector = connector
        self.engine = engine
        self.outcome = Outcome.RUNNING
        self.finished = False
        self.reason = ""
        self._ended_s: float | None = None
        self._started = False
        self._releasing = False

    @property
    def connected(self) -> bool:
        """Every device has answered and was read back; the recipe is under way, or over."""
        return self._started

    @property
    def waiting(self) -> bool:
        """A prompt waits for its answer."""
        return self.engine.ctx.prompts.waiting is not None and not self.engine.control.state.stop_requested

    def request_stop(self, why: str, *, fast: bool = False) -> None:
        """Stop the run: a controlled stop, or a fast one."""
        self.reason = self.reason or why
        if not self._started:
            self.outcome, self.finished = Outcome.STOPPED, True
            return
        self.engine.control.request_stop(self.engine.ctx.now, why, fast=fast)

    def tick(self, now: float) -> float:
        """Do what is due at ``now``; return when to be called again at the latest (s)."""
        try:
            if not self._started:
                return self._connect(now)
            due = self.engine.tick(now)
            self._supervise(now)
        except BusLost as lost:
            self._lose(now, lost)
            return now
        return due

    def _connect(self, now: float) -> float:
        due = self.connector.tick(now)
        if self.connector.stage is Stage.FAILED:
            self.outcome, self.reason, self.finished = Outcome.UNREACHABLE, self.connector.failure, True
        elif self.connector.stage is Stage.READY:
            engine = self.engine
            engine.next_scan_s = due
            engine.devices.fill(engine.ctx.readings, now, engine.ctx.wheel.diameter_mm)
            self.reason = engine.control.start(now)
            self._started = True
        return due

    def _lose(self, now: float, lost: BusLost) -> None:
        """End: without a wire nothing can be commanded, and the drives stop by their own watchdogs."""
        self.outcome = Outcome.TRIPPED if self._started else Outcome.UNREACHABLE
        self.reason = f"bus lost: {lost}"
        self.finished = True
        if self._started:
            self.engine.ctx.journal.trip(now, "bus lost", str(lost))

    def _supervise(self, now: float) -> None:
        engine = self.engine
        state = engine.control.state
        if state.mode is Mode.RUN:
            if engine.executor.finished:
                engine.control.request_stop(now, engine.executor.failed or "recipe finished")
            return
        if state.mode not in (Mode.IDLE, Mode.LATCHED):
            return
        devices = engine.devices
        if self._ended_s is None:
            self._ended_s = now
        elif not self._releasing:
            if devices.all_off() or now - self._ended_s > POWER_OFF_S:
                self._releasing = True
                for drive in devices.drives:
                    devices.master.start(drive, drive.release())
        elif not any(devices.master.busy(drive) for drive in devices.drives) or now - self._ended_s > RELEASE_S:
            self._finish()

    def _finish(self) -> None:
        engine = self.engine
        trip = engine.control.state.trip
        if trip is not None:
            self.outcome, self.reason = Outcome.TRIPPED, f"{trip.name}: {trip.text}"
        elif engine.executor.failed:
            self.outcome, self.reason = Outcome.FAILED, engine.executor.failed
        elif engine.executor.finished:
            self.outcome, self.reason = Outcome.DONE, ""
        else:
            self.outcome = Outcome.STOPPED
        self.finished = True
