"""The owner's side of the link to clients: the gateway process, numbered events, states. It never waits.

A gateway that dies or hangs is replaced, and the new one receives events, trend and plan again; the run is not
affected.
"""

from __future__ import annotations

import secrets
import select
import subprocess
from collections import deque
from dataclasses import dataclass, field
from pathlib import Path

from pydantic import JsonValue
from pydantic_core import to_json

from tester import __version__
from tester.base import clock
from tester.base.screen import MachineView
from tester.notices.notice import MOST_KEPT, NOTE, NextNeeded, Notice, NoticeOver
from tester.queue.view import QueueView
from tester.service.address import Address, TcpAddress, UnixAddress, stop_path, unlink_socket
from tester.service.child_process import spawn
from tester.service.gateway_process import SETTINGS, GatewaySettings
from tester.service.protocol import EVENTS_KEPT, TREND_ROWS, Accepted, Event, Frames, Refused, encode
from tester.service.service_link import LinkLost, Order, OwnerEnd, Presence
from tester.service.state_view import ClientsView, PlanView, StateView
from tester.service.stop_lane import StopLane

AGAIN_S = 1.0
"""Shortest time between two starts of a gateway, s."""
END_S = 5.0
"""Time that a gateway has to end before it is killed, s."""


@dataclass(frozen=True, slots=True)
class LinkConfig:
    """Where clients connect, and the settings for the gateway. ``card``: file with the address, for TCP."""

    address: Address
    card: Path
    runs: Path
    rig: str
    notify: str = ""
    accept_risk: str = ""


@dataclass(slots=True)
class GatewayLink:
    """Sends messages to clients and receives their orders."""

    config: LinkConfig
    service: str = field(default_factory=lambda: secrets.token_hex(8))
    began_s: float = field(default_factory=clock.monotonic)
    presence: Presence = field(default_factory=lambda: Presence("", 0, 0, False))
    sign_s: float = float("-inf")
    """Time of the controller's newest sign of life (tester.base.clock.monotonic)."""
    sequence: int = 0
    lane: StopLane = field(default_factory=StopLane)
    """The separate connection for STOP, which bypasses the gateway."""
    _end: OwnerEnd | None = None
    _process: subprocess.Popen[bytes] | None = None
    _events: deque[bytes] = field(default_factory=lambda: deque[bytes](maxlen=EVENTS_KEPT))
    _rows: deque[bytes] = field(default_factory=lambda: deque[bytes](maxlen=TREND_ROWS))
    _notes: deque[bytes] = field(default_factory=lambda: deque[bytes](maxlen=MOST_KEPT))
    _next: bytes = b""
    _plan: bytes = b"pnull"
    _queue: bytes = b""
    _machine: bytes = b""
    _again_s: float = float("-inf")

    @property
    def wall_s(self) -> float:
        """Seconds since the service began."""
        return clock.monotonic() - self.began_s

    @property
    def silent_s(self) -> float:
        """Seconds since the controller's last sign of life."""
        return clock.monotonic() - self.sign_s

    def attended(self) -> None:
        """Record a sign of life from the controller."""
        self.sign_s = clock.monotonic()

    @property
    def clients(self) -> ClientsView:
        """The connected clients."""
        return ClientsView(self.presence.controller, self.presence.controller_id, self.presence.viewers)

    @property
    def watched(self) -> bool:
        """Whether any client is connected."""
        return self.presence.viewers > 0 or self.presence.controller_id != 0

    # -- sending -----------------------------------------------------------------------------------------------

    def event(self, kind: str, text: str, severity: str = "info", t_s: float = 0.0, run: str = "") -> None:
        """Send an event."""
        self.sequence += 1
        line = b"e%d " % self.sequence
        line += encode(Event(self.sequence, t_s, clock.utc_now(), kind, severity, text, run))
        self._events.append(line)
        self._send(line)

    def state(self, view: StateView, row: tuple[float | None, ...]) -> None:
        """Send the state; it replaces an earlier state that is still waiting."""
        encoded = to_json(row, inf_nan_mode="null")
        self._rows.append(encoded)
        if self._end is not None:
            try:
                self._end.send_state(b"s" + to_json(view, inf_nan_mode="null") + b"\t" + encoded)
            except LinkLost as lost:
                self._lose(lost)

    def machine(self, machine: MachineView) -> None:
        """Send the tables of the kind of rig, before its first state. If the kind has changed, drop the trend: the
        columns differ.
        """
        line = b"m" + to_json(machine)
        if line != self._machine:
            self._machine = line
            self._rows.clear()
            self._send(line)

    def plan(self, plan: PlanView | None) -> None:
        """Send the plan."""
        self._plan = b"p" + to_json(plan, inf_nan_mode="null")
        self._send(self._plan)

    def queue(self, queue: QueueView) -> None:
        """Send the queue."""
        self._queue = b"q" + to_json(queue)
        self._send(self._queue)

    def frames(self, frames: Frames) -> None:
        """Send frames to the clients that watch them."""
        self._send(b"f" + encode(frames))

    def accept(self, order: Order, result: JsonValue = None) -> None:
        """Answer that an order is accepted."""
        self._send(b"a%d " % order.client + encode(Accepted(order.id, result)))

    def refuse(self, order: Order, reason: str) -> None:
        """Answer that an order is refused, with the reason."""
        self._send(b"a%d " % order.client + encode(Refused(order.id, reason)))

    def notify(self, note: Notice | NoticeOver | NextNeeded) -> None:
        """Give a note to the process that sends notices; a new gateway gets it again."""
        line = b"n" + NOTE.dump_json(note)
        if isinstance(note, NextNeeded):
            if line == self._next:
                return
            self._next = line
        else:
            self._notes.append(line)
        self._send(line)

    # -- receiving ----------------------------------------------------------------------------------------------

    def receive(self) -> list[Order | Presence]:
        """Return clients' messages, a limited number at a time; restart a gateway that is gone."""
        self.lane.look()
        if self._end is None:
            self._revive()
        if self._end is None:
            return []
        try:
            self._end.flush()
            messages = self._end.receive()
        except LinkLost as lost:
            self._lose(lost)
            return []
        for message in messages:
            if isinstance(message, Presence):
                if message.signs != self.presence.signs:
                    self.attended()
                self.presence = message
        return messages

    def wait(self, seconds: float) -> None:
        """Wait until a message arrives, at most ``seconds``."""
        if self._end is None:
            clock.sleep_until(clock.monotonic() + seconds)
        elif not self._end.has_lines:
            select.select([self._end.socket, self.lane.bell], [], [], max(seconds, 0.0))

    # -- the gateway ------------------------------------------------------------------------------------------

    def open(self) -> None:
        """Open the connection for STOP, then start the gateway. Raises OSError, and AddressError for a taken path."""
        self._free_paths()  # here, because the processes that listen are started again when they end
        self.lane.open(self.config.address)
        self._open_gateway()

    def _free_paths(self) -> None:
        """Remove the sockets that an earlier service left."""
        if isinstance(self.config.address, UnixAddress):
            for path in (self.config.address.path, stop_path(self.config.address.path)):
                unlink_socket(path)

    def _open_gateway(self) -> None:
        self._process, ours = spawn("tester.service.gateway_process", ())
        self.adopt(OwnerEnd(ours))

    def adopt(self, end: OwnerEnd) -> None:
        """Use ``end`` from now on, and send everything that its gateway needs."""
        address = self.config.address
        self._end = end
        tcp = isinstance(address, TcpAddress)
        path = self.config.card if isinstance(address, TcpAddress) else address.path
        settings = GatewaySettings(
            self.service, __version__, str(path), str(self.config.runs), self.config.rig, self.config.notify,
            address.token if tcp else "", address.port if tcp else 0, self.lane.port, self.config.accept_risk,
        )  # fmt: skip
        self._send(SETTINGS.dump_json(settings))
        if self._machine:
            self._send(self._machine)
        for row in self._rows:
            self._send(b"t" + row)
        for line in (*self._events, *self._notes, *((self._next,) if self._next else ())):
            self._send(line)
        self._send(self._plan)
        if self._queue:
            self._send(self._queue)

    def close(self) -> None:
        """End the gateway, which sends a goodbye to every client. STOP works until the gateway has ended."""
        self._send(b"b")
        if self._end is not None:
            self._end.drain(END_S)
        if self._process is not None:
            try:
                self._process.wait(END_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        if self._end is not None:
            self._end.close()
            self._end = None
        self.lane.close()
        self._free_paths()
        self.config.card.unlink(missing_ok=True)

    def _send(self, line: bytes) -> None:
        if self._end is None:
            return
        try:
            self._end.send(line)
        except LinkLost as lost:
            self._lose(lost)

    def _lose(self, lost: LinkLost) -> None:
        """Abandon a gateway; the next ``receive`` starts another."""
        if self._end is not None:
            self._end.close()
        self._end = None
        if self._process is not None:
            self._process.kill()
        self.presence = Presence("", 0, 0, False)
        self._again_s = clock.monotonic() + AGAIN_S
        self.event("service", f"the gateway is gone ({lost}) and restarts", "warning")

    def _revive(self) -> None:
        if clock.monotonic() < self._again_s:
            return
        if self._process is not None and self._process.poll() is None:
            return
        self._again_s = clock.monotonic() + AGAIN_S
        self._open_gateway()
