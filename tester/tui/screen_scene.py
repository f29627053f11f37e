"""The scene: all data that the screens show at present, live from the service or replayed from a run."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from tester.base import clock
from tester.base.screen import UNKNOWN, MachineView, Value
from tester.queue.view import QueueView
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
    QueueMessage,
    ResultsMessage,
    ServerMessage,
)
from tester.service.protocol import Snapshot as SnapshotMessage
from tester.service.results_view import GivenResults
from tester.service.state_view import Alarm, PlanView, RunView, StateView

if TYPE_CHECKING:
    from tester.tui.stored import Stored

STALE_S = 2.0
"""Age above which a state is stale and none of its values is trustworthy, s."""
FRAMES_KEPT = 1000
UNDER_WAY = "running"
"""Outcome of a run under way (docs/protocol.md)."""


def mode_words(state: StateView) -> str:
    """Return the mode for people: a twin that no run uses is ready, where a machine is not connected."""
    return "READY (simulated)" if state.simulated and state.mode == "OFFLINE" else state.mode


@dataclass(slots=True)
class ScreenScene:
    """The data of the screens. ``state`` is None until a state has arrived.

    ``now`` returns seconds, by default of tester.base.clock.monotonic.
    """

    now: Callable[[], float] = clock.monotonic
    state: StateView | None = None
    plan: PlanView | None = None
    queue: QueueView | None = None
    events: deque[Event] = field(default_factory=lambda: deque[Event](maxlen=EVENTS_KEPT))
    trend: deque[tuple[float | None, ...]] = field(
        default_factory=lambda: deque[tuple[float | None, ...]](maxlen=TREND_ROWS)
    )
    machine: MachineView = UNKNOWN
    """Tables of the kind of rig on display."""
    epoch: int = 0
    """A number that changes when ``trend`` is replaced, not when it grows."""
    frames: deque[Frame] = field(default_factory=lambda: deque[Frame](maxlen=FRAMES_KEPT))
    frames_dropped: int = 0
    frames_seen: int = 0
    lost: str = ""
    """Why there is no link; "" while there is one."""
    gone: Gone = ""
    """What happened to the service behind a lost link, as far as known."""
    received_s: float = 0.0
    service: str = ""
    """The instance of the service from which the events come."""
    controls: bool = False
    view_only: bool = False
    replayed: bool = False
    results: GivenResults | None = None
    """What the run on display has given so far; None until that is known."""
    table: Stored | None = None
    """The table of a run that has ended, as `tester show` prints it; None until it has been read."""

    @property
    def age_s(self) -> float:
        """Seconds since the newest state arrived."""
        return 0.0 if self.replayed else max(self.now() - self.received_s, 0.0)

    @property
    def linked(self) -> bool:
        """Return whether the display is up to date."""
        return self.state is not None and not self.lost and self.age_s <= STALE_S

    @property
    def given(self) -> GivenResults | None:
        """Return the results of the run on display; None where they are of another run, or not known."""
        run = self.state.run if self.state is not None else None
        found = self.results
        return found if found is not None and run is not None and found.run == run.name else None

    @property
    def ended_run(self) -> RunView | None:
        """Return the last run; None while a run is under way, or if it has no folder (manual mode)."""
        run = self.state.run if self.state is not None else None
        return run if run is not None and run.outcome != UNDER_WAY and run.folder else None

    def take(self, message: ServerMessage | Lost, client: Client | None) -> None:
        """Process a message from the link."""
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
        elif isinstance(message, ResultsMessage):
            self.results = message.results
        elif isinstance(message, QueueMessage):
            self.queue = message.queue
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
        self.queue, self.results = hello.queue, hello.results
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
        """Return the value with this key; None if there is none."""
        return self.state.value(key) if self.state is not None else None

    def alarms(self) -> list[Alarm]:
        """Return the alarms, most urgent first: unacknowledged ones, then by priority, first-up, number."""
        if self.state is None:
            return []
        return sorted(
            self.state.alarms, key=lambda a: (a.state == "acknowledged", a.priority, not a.first_up, a.number)
        )

    def top_alarm(self) -> Alarm | None:
        """Return the most urgent unacknowledged alarm; None if there is none."""
        return next((alarm for alarm in self.alarms() if alarm.state != "acknowledged"), None)
