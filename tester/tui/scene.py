"""The scene: everything the screens show at present, live from the service or replayed from a run."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from tester.base import clock
from tester.base.screen import UNKNOWN, MachineView, Value
from tester.service.client import Client, Gone, Lost
from tester.service.protocol import (
    EVENTS_KEPT,
    TREND_ROWS,
    Event,
    Frame,
    Frames,
    Hello,
    MachineMessage,
    PlanMessage,
    ServerMessage,
)
from tester.service.protocol import Snapshot as SnapshotMessage
from tester.service.state import Alarm, PlanView, RunView, StateView

STALE_S = 2.0
"""A state older than this is no state: no value is to be believed."""
FRAMES_KEPT = 1000
UNDER_WAY = "running"
"""Outcome of a run that has none yet (docs/protocol.md)."""


@dataclass(slots=True)
class ScreenScene:
    """``state`` None: nothing was ever heard. ``now``: seconds of tester.base.clock.monotonic, another one in tests."""

    now: Callable[[], float] = clock.monotonic
    state: StateView | None = None
    plan: PlanView | None = None
    events: deque[Event] = field(default_factory=lambda: deque[Event](maxlen=EVENTS_KEPT))
    trend: deque[tuple[float | None, ...]] = field(
        default_factory=lambda: deque[tuple[float | None, ...]](maxlen=TREND_ROWS)
    )
    machine: MachineView = UNKNOWN
    """Tables of the kind that is shown."""
    epoch: int = 0
    """Changes where ``trend`` is another one, not a longer one."""
    frames: deque[Frame] = field(default_factory=lambda: deque[Frame](maxlen=FRAMES_KEPT))
    frames_dropped: int = 0
    frames_seen: int = 0
    lost: str = ""
    """Why there is no link, "" while there is one."""
    gone: Gone = ""
    """What became of the service behind a lost link, as far as that is known."""
    received_s: float = 0.0
    service: str = ""
    """Which life of the service the events are of."""
    controls: bool = False
    view_only: bool = False
    replayed: bool = False

    @property
    def age_s(self) -> float:
        """Seconds since the newest state came."""
        return 0.0 if self.replayed else max(self.now() - self.received_s, 0.0)

    @property
    def linked(self) -> bool:
        """Return whether what is shown is how it is."""
        return self.state is not None and not self.lost and self.age_s <= STALE_S

    @property
    def run_under_way(self) -> bool:
        """Return whether a run was under way when the service was heard last."""
        return self.state is not None and self.state.run is not None and self.state.run.outcome == UNDER_WAY

    @property
    def ended_run(self) -> RunView | None:
        """Return the last run, None while one is under way, or where it has left no folder (manual mode)."""
        run = self.state.run if self.state is not None else None
        return run if run is not None and run.outcome != UNDER_WAY and run.folder else None

    def take(self, message: ServerMessage | Lost, client: Client | None) -> None:
        """Take in a message of the link."""
        if isinstance(message, Lost):
            self.lost, self.gone = message.reason or "the connection is lost", message.gone
            return
        self.lost = self.gone = ""
        if isinstance(message, Hello):
            self._greet(message)
        elif isinstance(message, SnapshotMessage):
            self.state, self.received_s = message.state, self.now()
            self.trend.append(message.row)
        elif isinstance(message, Event):
            self.events.append(message)
        elif isinstance(message, PlanMessage):
            self.plan = message.plan
        elif isinstance(message, MachineMessage):
            self.machine = message.machine
            self.trend.clear()
            self.epoch += 1
        elif isinstance(message, Frames):
            self.frames.extend(message.frames)
            self.frames_dropped += message.dropped
            self.frames_seen += len(message.frames)
        if client is not None:
            self.controls = client.controls

    def _greet(self, hello: Hello) -> None:
        self.state, self.plan, self.received_s = hello.state, hello.plan, self.now()
        if not hello.complete or hello.service != self.service:
            self.events.clear()
        self.service = hello.service
        known = self.events[-1].seq if self.events else 0
        self.events.extend(event for event in hello.events if event.seq > known)
        self.trend.clear()
        self.trend.extend(hello.trend)
        self.machine = hello.machine
        self.epoch += 1

    def value(self, key: str) -> Value | None:
        """Return a value by its key."""
        return self.state.value(key) if self.state is not None else None

    def alarms(self) -> list[Alarm]:
        """Return the alarms, those that need a person first: unacknowledged, then by priority, the first one up."""
        if self.state is None:
            return []
        return sorted(
            self.state.alarms, key=lambda one: (one.state == "acknowledged", one.priority, not one.first_up, one.number)
        )

    def top_alarm(self) -> Alarm | None:
        """Return the alarm that wants acknowledging most, None where none does."""
        return next((one for one in self.alarms() if one.state != "acknowledged"), None)
