"""The desk between rig and clients: between two ticks it sends the state and carries out orders."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from tester.base import clock
from tester.base.screen import Value
from tester.base.trouble import in_words
from tester.inputs.rig import Rig
from tester.inputs.rig.further_sensors import quantities_on
from tester.machine.manual import ManualExecutor
from tester.machine.run import Outcome, Run
from tester.machine.run_parts import History
from tester.machine.served import ServedKind
from tester.run.kind_lookup import served_kind
from tester.run.latch import acknowledge, open_trips
from tester.service.address import with_peer
from tester.service.alarms import AlarmList, Cause
from tester.service.disk_watch import DiskWatch
from tester.service.gateway_link import GatewayLink
from tester.service.notifier import Notifier
from tester.service.preflight import Past, known_checks
from tester.service.protocol import SNAPSHOT_S
from tester.service.service_link import Order
from tester.service.state_view import ManualView, ProgressView, RunView, StateView, TickView
from tester.service.values import PlanTrack, trend_row, unknown_values, with_pressure
from tester.service.watch import LastSeen, RunWatch, risk_of
from tester.store.record_schema import StoreError

UNWATCHED_S = 1.0
"""Period of states while no client is connected, s: the trend continues at a rate that costs almost nothing."""
SOONEST_S = 0.05
"""Shortest time between two states, s, however many commands clients send."""


def do_nothing(*_: object) -> None:
    """Do nothing: the default handler."""


@dataclass(slots=True)
class Desk:
    """The present state of rig and run. ``obey`` receives every order; ``lost_control`` is called when the controller
    changes, ``look`` at every poll. ``watch`` reads the run under way.
    """

    gateway: GatewayLink
    rig: Rig
    runs: Path
    obey: Callable[[Order], None] = field(default=do_nothing)
    stop: Callable[[str, bool], None] = field(default=do_nothing)
    """Called on STOP: the client's name, whether it is fast."""
    lost_control: Callable[[], None] = field(default=do_nothing)
    look: Callable[[], None] = field(default=do_nothing)
    stop_rest: Callable[[bool], None] = field(default=do_nothing)
    """Called on STOP (whether fast) to stop the parts of the run that have not begun."""
    watch: RunWatch | None = None
    seen: LastSeen | None = None
    hand: ManualExecutor | None = None
    run: RunView | None = None
    tick: TickView = field(default_factory=lambda: TickView(0.0, 0.0, 0))
    latched: str = ""
    """Why nothing may start before an acknowledgement; "" if starts are not blocked."""
    tripped: str = ""
    """Name of the alarm of the trip that blocks starts."""
    interrupted: tuple[str, ...] = ()
    past: Past | None = None
    """The outcome of the newest stored run, and what it left; read while no run ticks."""
    history: History | None = None
    """What stored runs show about the rig; read at the same time as ``past``."""
    needed: int = 0
    """Bytes that the run will probably take."""
    now_s: float = 0.0
    """Rig time of the run."""
    _due_s: float = float("-inf")
    _shown_s: float = float("-inf")
    _mode: str = ""
    _mode_since_s: float = 0.0
    _revision: int = 0
    """Revision of the list of steps that was last sent to clients."""
    _controller: int = 0
    _disk: DiskWatch = field(init=False)
    _unknown: tuple[Value, ...] = ()
    _alone: str = ""
    _risk: str = ""
    notices: Notifier = field(init=False)
    kind: ServedKind = field(init=False)
    """Kind of the service's own rig."""
    alarms: AlarmList = field(init=False)

    def __post_init__(self) -> None:
        """Begin without alarms."""
        self.alarms = AlarmList(clock.utc_now, self.tell)
        self.kind = served_kind(self.rig)
        self.gateway.machine(self.kind.machine)
        self._unknown = with_pressure(unknown_values(quantities_on(self.rig), self.rig), self.rig.area_metadata)
        self._alone = self.kind.alone(self.rig)
        self.notices = Notifier(self.gateway, self.rig.name, simulated=self.rig.simulated)
        self._disk = DiskWatch(self.runs, self.alarms, self.notices.disk)
        self._risk = risk_of(self.rig)

    # -- runs -------------------------------------------------------------------------------------------------

    def attach(self, run: Run, track: PlanTrack, view: RunView, hand: ManualExecutor | None = None) -> None:
        """Start watching a run."""
        kind = served_kind(run.engine.ctx.rig)
        self.gateway.machine(kind.machine)
        self.watch, self.hand, self.run = RunWatch(run, track, kind), hand, view
        run.engine.ctx.journal.on_event = self.forward
        self.gateway.lane.begin_ticking()
        self.now_s = 0.0
        self.notices.begun(view)
        self._revision = 0
        if hand is not None:
            self.gateway.plan(None)
        else:
            self._show_steps(self.watch)

    def specimen(self, run: Run) -> None:
        """Store which compound is on the rig."""
        watch, view = self.watch, self.run
        number, compound = watch.panel.mounted() if watch is not None else (0, "")
        if view is not None and number and view.compound != compound:
            note = run.engine.executor.plan.specimen(number).note
            self.run = replace(view, compound=compound, note=note)

    def detach(self, view: RunView | None) -> None:
        """Stop watching the run; ``view`` is the last view of it."""
        self.gateway.lane.end_ticking()
        if self.watch is not None:
            self.watch.run.engine.ctx.journal.on_event = None
            for name in self.watch.watched:
                self.alarms.clear(name)
        self.watch = self.hand = None
        self.notices.over()
        self.gateway.machine(self.kind.machine)
        self.stop_rest = do_nothing
        self.run = view
        self._due_s = float("-inf")

    def ended(self, view: RunView, outcome: Outcome) -> None:
        """Report how the run ended, and latch after a trip."""
        text = f"{view.name}: {view.outcome}" + (f": {view.reason}" if view.reason else "")
        self.run = view
        self.tell("run", text, "info" if outcome is Outcome.DONE else "warning")
        if view.folder:  # manual mode has none: a person is there
            self.notices.ended(view, text)
        watch = self.watch
        self.seen = watch.seen() if watch else None
        if watch is not None and not watch.acknowledged and (outcome is Outcome.TRIPPED or watch.latched):
            self._latch(view.reason or view.outcome, watch)
        self.detach(view)

    def _latch(self, reason: str, watch: RunWatch) -> None:
        """Block every start until an acknowledgement."""
        watch.watch_trip(self.alarms, self.now_s)
        if not watch.tripped and not watch.latched:  # the wire was lost before control could trip
            watch.tripped = "rig lost"
            self.alarms.raise_(Cause(watch.tripped, 1, reason, "the drives stop by their own watchdogs"), self.now_s)
        self.latched, self.tripped = reason, watch.tripped

    def latch_again(self) -> None:
        """After a restart, latch a real rig if the store holds an unacknowledged trip."""
        trips = open_trips(self.runs, self.rig)
        if trips:
            first = trips[0].trip
            self.latched, self.tripped = f"{trips[0]}; not acknowledged", first.interlock
            consequence = "nothing begins before it is acknowledged"
            self.alarms.raise_(Cause(first.interlock, 1, f"{first.text}; not acknowledged", consequence), self.now_s)

    def unlatch(self, by: str) -> None:
        """Accept an acknowledgement, so that the next run may begin. It is recorded with the trips it covers."""
        if self.latched:
            self.tell("mode", f"acknowledged by {by}")
            self.alarms.clear(self.tripped)
            try:
                acknowledge(open_trips(self.runs, self.rig), by)
            except (StoreError, OSError) as error:
                self.tell("mode", f"the acknowledgement cannot be recorded: {in_words(error)}", "warning")
        self.latched, self.tripped, self.interrupted = "", "", ()

    def forward(self, t_s: float, kind: str, text: str, severity: str) -> None:
        """Forward an event that the run records to the clients."""
        if kind == "emergency" and self.watch is not None:
            self.watch.buses.count_emergency(text)
        self.tell(kind, text, severity, t_s)
        self.notices.event(kind, text, severity)

    def tell(self, kind: str, text: str, severity: str = "info", t_s: float | None = None) -> None:
        """Send every client an event."""
        self.gateway.event(kind, text, severity, self.now_s if t_s is None else t_s, self.run.name if self.run else "")

    def command(self, text: str, severity: str = "info", kind: str = "command") -> None:
        """Report a client's command and its sender; while a run is under way, also record it."""
        if self.watch is None:
            self.tell(kind, text, severity)
        else:
            ctx = self.watch.run.engine.ctx
            ctx.journal.event(ctx.now, kind, text, severity)  # the journal calls ``forward``

    # -- between two ticks ------------------------------------------------------------------------------------

    def poll(self, now_s: float) -> None:
        """Carry out clients' orders, and publish the state when it is due. ``now_s``: rig time."""
        self.now_s = now_s
        self.stop_first()
        for message in self.gateway.receive():
            if isinstance(message, Order):
                self.obey(message)
            self._due_s = min(self._due_s, self._shown_s + SOONEST_S)  # show the change soon
        self.look()
        self._notice_control()
        wall_s = clock.monotonic()
        if wall_s >= self._due_s:
            period_s = SNAPSHOT_S if self.gateway.watched else UNWATCHED_S
            late_s = wall_s - self._due_s
            self._due_s = wall_s + (period_s - late_s if late_s < period_s else period_s)
            self._shown_s = wall_s
            self.show()

    def stop_first(self) -> None:
        """Carry out STOPs from their own connection before everything else."""
        for wish in self.gateway.lane.taken():
            self.stop(wish.name, wish.fast)
            self.gateway.lane.answer(wish)
            self._due_s = min(self._due_s, self._shown_s + SOONEST_S)

    def wait(self) -> None:
        """Wait, while no run ticks, until a message arrives or a state is due."""
        self.gateway.wait(max(self._due_s - clock.monotonic(), 0.0))

    def _notice_control(self) -> None:
        number = self.gateway.presence.controller_id
        if number == self._controller:
            return
        self._controller = number
        who = with_peer(self.gateway.presence.controller, self.gateway.presence.peer)
        self.command(f"{who} has control" if number else "no client has control", kind="control")
        self.lost_control()

    def show(self) -> None:
        """Publish the state."""
        watch, now = self.watch, self.now_s
        if watch is not None:
            self._watch_frames(watch)
            watch.track.look(now, watch.run)
            self._show_steps(watch)
            watch.watch_trip(self.alarms, now)
        view = self.view()
        if watch is not None:
            watch.watch_values(self.alarms, now, view.values)
        self.gateway.state(view, self._row(view))
        if self.notices.prompt(view.prompt) and view.prompt is not None:
            self.tell("prompt", view.prompt.text, "warning")

    def _show_steps(self, watch: RunWatch) -> None:
        """Send the list of steps if it has changed, before the state that refers to it."""
        if self.hand is None and watch.track.revision != self._revision:
            self._revision = watch.track.revision
            self.gateway.plan(watch.track.view())
            self.notices.next(watch.track, self._lapse)

    def _watch_frames(self, watch: RunWatch) -> None:
        watch.frames.watch(self.gateway.presence.frames)
        if watch.frames.watching and (frames := watch.frames.take()) is not None:
            self.gateway.frames(frames)

    # -- the view ---------------------------------------------------------------------------------------------

    def view(self) -> StateView:
        """Return the complete state."""
        watch, gateway, now = self.watch, self.gateway, self.now_s
        mode, text, since_s = self._situation()
        disk, alarms = self._disk.view(now, self.needed), self.alarms.listed()
        checks = known_checks(self.rig, disk, alarms, self.past, self.latched, clock.utc_now(), self.history)
        state = StateView(
            mode=mode,
            mode_text=text,
            mode_since_s=since_s,
            t_s=now,
            wall_s=gateway.wall_s,
            utc=clock.utc_now(),
            rig=self.rig.name,
            simulated=self.rig.simulated,
            run=self.run,
            progress=ProgressView(),
            values=self._unknown,
            gates=(),
            soak=None,
            alarms=alarms,
            prompt=None,
            manual=self._manual_view(),
            devices=(),
            buses=(),
            disk=disk,
            tick=self._tick_view(),
            clients=gateway.clients,
            interrupted=self.interrupted,
            preflight=checks,
            alone=self._alone,
            risk=self._risk,
        )
        if watch is None:
            return state
        return watch.shown_in(state, self._lapse)

    @property
    def _lapse(self) -> float | None:
        """Rig seconds per second of the run, None if unknown."""
        return self.run.pace if self.run is not None else None

    def _situation(self) -> tuple[str, str, float]:
        """Return mode, reason, and seconds in this mode."""
        if self.watch is not None:
            mode, text, since_s = self.watch.mode
            if self.hand is not None and mode == "RUN":
                mode = "MANUAL"
            self.notices.mode(mode, text)
            self._mode = mode
            return mode, text, since_s
        mode, text = "OFFLINE", "the rig is connected when a run begins"
        if self.latched:
            mode, text = "LATCHED", self.latched
        elif self.interrupted:
            mode, text = "INTERRUPTED", f"{self.interrupted[-1]} was cut off"
        if mode != self._mode:
            self._mode, self._mode_since_s = mode, self.gateway.wall_s
        return mode, text, self.gateway.wall_s - self._mode_since_s

    def _manual_view(self) -> ManualView:
        hand = self.hand
        return ManualView(None, "") if hand is None else ManualView(hand.left_s(self.now_s), hand.hand.tare_text)

    def _tick_view(self) -> TickView:
        watch, still = self.watch, TickView(0.0, 0.0, 0)
        return still if watch is None else replace(self.tick, rate_hz=round(1.0 / watch.run.engine.period_s, 1))

    def _row(self, view: StateView) -> tuple[float | None, ...]:
        by_key = {value.key: value for value in view.values}
        row: list[float | None] = [round(view.wall_s, 3), round(view.t_s, 3)]
        kind = self.watch.kind if self.watch is not None else self.kind
        row += trend_row(kind.quantities, by_key)
        return tuple(None if x is None else round(x, 4) for x in row)
