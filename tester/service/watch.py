"""A run as its screens show it: the state view's parts from the run itself, and the alarms that follow from them."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from math import isfinite
from typing import Any

from drivers.ports import CanPort, LinePort, Unwatch
from tester.base import clock
from tester.base.screen import Check, Value
from tester.inputs.rig import Rig
from tester.inputs.rig.further_sensors import quantities_on
from tester.inputs.rig.rig_files import risks_of
from tester.machine.connect import Stage
from tester.machine.engine import Engine
from tester.machine.panel import RunPanel
from tester.machine.run import Run
from tester.machine.served import ServedKind
from tester.machine.state import ControlState, Mode
from tester.service.alarms import AlarmList, Cause
from tester.service.buses import BusWatch
from tester.service.protocol import Frame, Frames
from tester.service.state_view import ProgressView, PromptView, StateView
from tester.service.values import PlanTrack, ValueView, screen_of

MOST = 200
"""Greatest number of frames in a message; five axes at 100 Hz make about 1,500 a second, more than a person can
read.
"""


class FrameLog:
    """The frames since the last message; if there are too many, the oldest are dropped."""

    def __init__(self, engine: Engine, lines: Mapping[str, LinePort]) -> None:
        """Watch nothing before ``watch``. ``lines`` by their names in the rig file."""
        self._engine = engine
        self._can: CanPort = engine.devices.can
        self._lines = dict(lines)
        self._frames: deque[tuple[float, str, bool, int, bytes]] = deque(maxlen=MOST)
        self._seen = 0
        self._watched: list[Unwatch] = []

    @property
    def watching(self) -> bool:
        """Whether frames are recorded."""
        return bool(self._watched)

    def watch(self, on: bool) -> None:
        """Start or stop recording; call between two ticks only."""
        if on and not self._watched:
            lines = [line.watch(partial(self._on_line, name)) for name, line in self._lines.items()]
            self._watched = [self._can.watch(self._on_can), *lines]
        elif not on:
            for unwatch in self._watched:
                unwatch()
            self._watched = []

    def take(self) -> Frames | None:
        """Return the frames since the last call; None if there are none."""
        if not self._seen:
            return None
        frames = tuple(Frame(t, bus, sent, ident, data.hex(" ")) for t, bus, sent, ident, data in self._frames)
        message = Frames(frames, self._seen - len(frames))
        self._frames.clear()
        self._seen = 0
        return message

    def _on_can(self, t: float, can_id: int, data: bytes, sent: bool) -> None:
        self._seen += 1
        self._frames.append((t + self._engine.leapt_s, "can", sent, can_id, data))

    def _on_line(self, line: str, t: float, data: bytes, sent: bool) -> None:
        """Record a piece of a line's traffic; its first byte is the station's address."""
        self._seen += 1
        self._frames.append((t + self._engine.leapt_s, line, sent, data[0] if data else 0, data))


@dataclass(frozen=True, slots=True)
class LastSeen:
    """The last scan of a run: when (tester.base.clock.monotonic), the mode, the safety inputs."""

    at_s: float
    mode: str
    checks: tuple[Check, ...]


NO_MODE = "CONNECTING"
MODES = {Mode.EMERGENCY: "E-STOP"}
"""Modes shown under a name other than control's."""
RESTING = (Mode.IDLE, Mode.LATCHED)
"""Modes in which drives are switched off at the end of a run."""


def risk_of(rig: Rig) -> str:
    """Return the safety keys of a rig that are looser than they should be, in words; "" if there are none."""
    return "; ".join(map(str, risks_of(rig)))


class RunWatch:
    """Reads one run, between two ticks."""

    def __init__(self, run: Run, track: PlanTrack, kind: ServedKind) -> None:
        """Prepare everything that does not change.

        ``track``: of the whole plan (this run may be a part of it); ``kind``: the rig's.
        """
        self.run = run
        self.kind = kind
        engine = run.engine
        self.rig = engine.ctx.rig
        self.risk = risk_of(self.rig)
        self.panel = kind.panel(engine)
        self.values = ValueView(engine, self.panel)
        self.buses = BusWatch(engine.devices, self.rig)
        ports = [port for port, _ in engine.devices.lines]
        self.frames = FrameLog(engine, dict(zip(self.rig.lines, ports, strict=True)))
        self.alone = kind.alone(self.rig)
        self.track = track
        self.watched: set[str] = set()
        """Names of the alarms for this run's devices; they are cleared when it ends."""
        self.tripped = ""
        """Name of the alarm of the trip that latches the rig."""
        self.acknowledged = False
        """Whether a trip has occurred and is acknowledged."""
        self._asked_utc: dict[int, str] = {}
        shown = map(screen_of, quantities_on(self.rig).shown)
        self._fresh = frozenset(screen.key for screen in shown if screen.watched)
        """Keys of the values whose age is watched."""

    # -- views ------------------------------------------------------------------------------------------------

    @property
    def mode(self) -> tuple[str, str, float]:
        """Mode, reason, and seconds in this mode."""
        run = self.run
        if run.connector.stage is not Stage.READY:
            return NO_MODE, run.connector.stage.value, 0.0
        state: ControlState[Any] = run.engine.control.state
        name = MODES.get(state.mode, state.mode.value.upper())
        why = state.trip.text if state.trip is not None else state.stop_requested
        return name, why, max(run.engine.ctx.now - state.mode_since_s, 0.0)

    def seen(self) -> LastSeen:
        """Return what the last scan showed; call it when the run has just ended."""
        return LastSeen(clock.monotonic(), self.mode[0], RunPanel.checks(self.panel))

    @property
    def latched(self) -> bool:
        """Whether a trip or a fast stop waits for its acknowledgement."""
        return self.run.engine.control.state.mode is Mode.LATCHED

    def shown_in(self, state: StateView, lapse: float | None) -> StateView:
        """Return the state completed with this run; ``lapse`` as in ``progress``. The rig's own checks replace the
        others.
        """
        now, checks = state.t_s, self.preflight()
        names = {check.name for check in checks}
        return replace(
            state,
            rig=self.rig.name,
            simulated=self.rig.simulated,
            progress=self.progress(now, lapse),
            values=self.values.values(),
            gates=self.panel.gates(),
            soak=self.panel.soak(now),
            prompt=self.prompt(),
            devices=self.buses.device_views(now - self.run.engine.leapt_s),
            buses=self.buses.bus_views(),
            preflight=(*(check for check in state.preflight if check.name not in names), *checks),
            alone=self.alone,
            risk=self.risk,
        )

    def progress(self, now: float, lapse: float | None) -> ProgressView:
        """Return where the run is; ``lapse``: rig seconds per second, None if unknown."""
        p, at = self.run.engine.ctx.progress, self.track.standing()
        finish = clock.utc_in(at.left_s / lapse) if lapse and at.left_s is not None else ""
        return ProgressView(at.step, at.steps, p.title, p.phase, at.over, at.conditions, p.repeat, p.repeats,
                            p.revolutions, p.revolutions_wanted, p.burst, at.share, now, at.left_s, at.step_left_s,
                            finish)  # fmt: skip

    def prompt(self) -> PromptView | None:
        """Return the waiting question."""
        waiting = self.run.engine.ctx.prompts.waiting
        if waiting is None:
            return None
        asked = self._asked_utc.setdefault(waiting.number, clock.utc_now())
        return PromptView(waiting.number, waiting.text, waiting.at_s, asked, waiting.question.unit)

    def preflight(self) -> tuple[Check, ...]:
        """Return the connected rig's own checks before a start."""
        return (
            *self.panel.checks(),
            Check("last run", None, "under way"),
            Check("ambient", None, f"{self.rig.ambient_c:g} °C"),
        )

    # -- alarms -----------------------------------------------------------------------------------------------

    def watch_values(self, alarms: AlarmList, now: float, values: tuple[Value, ...]) -> None:
        """Raise and clear alarms for data that has stopped arriving and for lost devices."""
        if self.run.connector.stage is not Stage.READY or self.run.engine.control.state.mode in RESTING:
            return
        for value in values:
            if value.key not in self._fresh:
                continue
            name = f"no fresh data: {value.label}"
            self.watched.add(name)
            late = value.quality == "stale" and value.age_s is not None and value.age_s > 2.0
            alarms.set(late, Cause(name, 2, f"{value.age_s or 0.0:.0f} s old", "in contact the run stops"), now)
        for device in self.buses.device_views(now - self.run.engine.leapt_s):
            lost = not device.online
            alarms.set(
                lost, Cause(f"{device.name} offline", 2, device.detail or "does not answer", "the run stops"), now
            )

    def watch_trip(self, alarms: AlarmList, now: float) -> None:
        """Raise the alarm of the trip that stopped the rig, while the trip is latched."""
        trip = self.run.engine.control.state.trip
        if trip is not None:
            consequence = "the rig comes to a standstill; nothing moves before it is acknowledged"
            compared = trip.compared
            value = compared.value if isfinite(compared.value) else None
            limit = compared.limit if isfinite(compared.limit) else None
            cause = Cause(trip.name, 1, trip.text, consequence, value=value, limit=limit, unit=compared.unit)
            alarms.raise_(cause, now)
            self.tripped = trip.name
        elif self.tripped:
            alarms.clear(self.tripped)
            self.tripped, self.acknowledged = "", True
