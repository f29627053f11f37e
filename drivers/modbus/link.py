"""The Modbus link: one line, one transaction at a time; the caller passes all times in.

In every tick pass the bytes received to ``feed``, then call ``service`` to send what is due. In this order a
reply that came in time never counts as a time-out because the tick was late.
Doubts about framing, and adapters that echo: ``drivers.modbus.answers``.
"""

from __future__ import annotations

from math import inf
from typing import Final

from drivers.crc16 import crc16
from drivers.modbus import codec
from drivers.modbus.answers import AnswerKind, ReplySoFar, SerialEar, numbered, tcp_answer
from drivers.modbus.line import LineType
from drivers.modbus.request import Owner, Request, Station
from drivers.modbus.schedule import BUSY_S, EARLY_S, MISSES_TO_LOSE, POLL_S, PROBE_S, Schedule
from drivers.ports import BusLost, LineFraming, LinePort, Parity, RenewablePort
from drivers.profiles.model import Timing

_TINY_S: Final = 1e-9
_GOOD: Final = AnswerKind.GOOD


class ModbusLink(LineType):
    """Master of one Modbus line. ``deadline`` (s) is the latest time for the next ``service``.

    Before ``wants_s`` a ``service`` does nothing: the caller may skip it.
    """

    def __init__(
        self, framing: LineFraming = "rtu", baud: int = 115200, parity: Parity = "N", stop_bits: int = 1
    ) -> None:
        """Create an idle master; ``baud`` in bit/s, ``parity`` and ``stop_bits`` matter on a serial line only."""
        super().__init__(framing, baud, parity, stop_bits)
        self._schedule = Schedule()
        self.stations: list[Station] = []
        self._active: Request | None = None
        self._buffer = b""
        self._transaction = 0
        self._give_up_s = inf
        self._backlog_s = inf
        self._quiet_s = -inf
        self._suspect: Request | None = None
        self.deadline = self.wants_s = -inf
        self.garbage = 0
        """Pieces that arrived although no station had been asked."""
        self.doubts = ""
        """Reason of the last reconnection (TCP)."""
        self.scan_s = inf
        """Time between scans, s. If the exchange of an every-scan read takes longer, the next one begins at once."""
        self._doubt, self._sent = "", b""
        self.ear = SerialEar(False if self.socket else None)

    # requests of the drivers -----------------------------------------------------------------------------------

    def station(self, unit_id: int, timing: Timing, owner: Owner) -> Station:
        """Add a slave. Raises ValueError for an address outside 1..247 or one already taken."""
        if not 1 <= unit_id <= 247:
            raise ValueError(f"a Modbus address is 1..247, not {unit_id}")
        if any(other.unit_id == unit_id for other in self.stations):
            raise ValueError(f"two devices have Modbus address {unit_id} on one line")
        self.stations.append(Station(unit_id, timing, owner))
        return self.stations[-1]

    def enable(self, request: Request, due_s: float = -inf) -> None:
        """Send a request at ``due_s`` (s; at once by default), then in its period."""
        self._schedule.enable(request, due_s)
        self._backlog_s = self.wants_s = -inf

    def disable(self, request: Request) -> None:
        """Stop sending a request."""
        self._schedule.disable(request)
        self.wants_s = -inf

    def rewrite(self, request: Request, values: tuple[int, ...], urgent: bool = False) -> None:
        """Set the ``values`` of a write from now on: new values replace those still waiting.

        If enabled, the write goes out as soon as its turn comes; an ``urgent`` write goes before everything else.
        """
        if values != request.values:
            self.load(request, values)
            self._schedule.renew(request, urgent)
            self._backlog_s = self.wants_s = -inf

    def periods_s(self) -> list[float]:
        """Return the periods of the reads that have one, s."""
        return self._schedule.periods_s()

    def retime(self, request: Request, period_s: float) -> None:
        """Change the period (s) of a read; 0 = with every scan."""
        self._schedule.retime(request, period_s)
        self._backlog_s = self.wants_s = -inf

    # work of a tick --------------------------------------------------------------------------------------------

    def feed(self, chunks: list[tuple[float, bytes]], now: float) -> None:
        """Process what arrived up to ``now``: (arrival of the last byte in s, bytes), oldest first."""
        for t, chunk in chunks:
            request = self._active
            if request is None:
                self._unasked(t)
                continue
            data = self._buffer + chunk if self._buffer else chunk
            if self.socket:
                self._act(request, tcp_answer(request, self._sent, data), t)
                continue
            hears_itself = self.ear.hears_itself
            # The usual cases here, several times faster than in the library, which decodes everything else.
            if hears_itself is not False:
                self._act(request, self.ear.answer(request, self._sent, data), t)
                if hears_itself is None and self.ear.hears_itself is False:
                    self.wants_s = -inf
                    self._schedule.look_again()
            elif len(data) == request.reply_length and data[:3] == request.head and not crc16(data):
                self._succeed(request, data[3:-2], t)
            elif request.echo and data == request.echo:
                self._succeed(request, b"", t)
            else:
                self._act(request, self.ear.answer(request, self._sent, data), t)

    def service(self, port: LinePort, now: float, *, scan: bool = True) -> None:
        """Send what is due at ``now``, judge time-outs and set ``deadline``; raises BusLost.

        ``scan``: this is a regular scan; reads of period 0 are sent only then.
        """
        active = self._active
        if active is not None:
            if now < self._give_up_s - _TINY_S:
                self._wait(now)
                return
            self._time_out(active, now)
        if self._doubt:
            self._begin_anew(port, now)
        schedule = self._schedule
        request = schedule.steady
        # Nearly every scan: its one read is due and nothing else, as ``Schedule.choose`` would find.
        if (request is None or not scan or now < self._quiet_s - _TINY_S
                or not request.due_s <= now + EARLY_S < schedule.soonest_s):
            request = self._choose(now, scan)
            if request is None:
                return
        frame = request.frame
        if self.socket:
            self._transaction = self._transaction % 0xFFFF + 1
            frame = numbered(request, self._transaction)
        self._sent = frame
        self.ear.stripped = False
        port.write(frame, now)
        request.sent_s = now
        if request.writes:
            schedule.written(request)
        request.station.counters.requests += 1
        self._active = request
        self._give_up_s = give_up_s = now + request.timeout_s
        self._backlog_s = backlog_s = -inf if schedule.slowest_s > self.scan_s else schedule.latest_s
        if backlog_s < give_up_s:
            self._wait(now)
        else:
            self.deadline = give_up_s
            self.wants_s = give_up_s - _TINY_S

    def _choose(self, now: float, scan: bool) -> Request | None:
        """Return the request to send at ``now``; if there is none, set ``deadline`` and return None."""
        schedule = self._schedule
        hurried, reads_only = schedule.slowest_s > self.scan_s, self.ear.hears_itself is None
        if now < self._quiet_s - _TINY_S and (reads_only or now >= schedule.wants_s):
            self.deadline = self._quiet_s if hurried else max(self._quiet_s, schedule.latest())
            self.wants_s = self._quiet_s - _TINY_S
            return None
        request = schedule.choose(now, scan or hurried, reads_only) if now >= schedule.wants_s else None
        if request is None and reads_only and scan:
            request = self._contact(now)
        if request is None:
            self.deadline = schedule.latest_s
            self.wants_s = -inf if reads_only else schedule.wants_s
        return request

    def _contact(self, now: float) -> Request | None:
        """Return a read, due before a write, whose reply shows whether the adapter echoes; None if none is needed."""
        request = self._schedule.write_due(now)
        if request is None:
            return None
        station = request.station
        if station.contact is None:
            function, address = station.known_register
            station.contact = self.read(station, function, address, 1)
        return station.contact if station.contact.sent_s <= now - PROBE_S else None

    def _begin_anew(self, port: LinePort, now: float) -> None:
        """Drop a connection whose framing is in doubt; raises BusLost for a line that cannot be opened anew."""
        self.doubts, self._doubt = self._doubt, ""
        if not isinstance(port, RenewablePort):
            raise BusLost(f"{self.doubts}, and the line cannot be begun anew")
        port.renew(now)

    def measure(self) -> None:
        """Measure the stations' reply times anew, from their next replies on."""
        for station in self.stations:
            station.reply.forget()
            self.measured(station)

    @property
    def only_watches(self) -> bool:
        """Whether ``deadline`` is for a missing reply alone: nothing else waits for the line."""
        return self._active is not None and self.deadline == self._give_up_s

    def _wait(self, now: float) -> None:
        """Set the deadline for an awaited reply: the time-out, or, if requests wait, the reply's expected arrival."""
        deadline = self._give_up_s
        active = self._active
        if active is not None and self._backlog_s < deadline:
            expected = active.sent_s + active.expected_s
            if now >= expected:
                expected += POLL_S * (1 + (now - expected) // POLL_S)
            deadline = min(deadline, max(self._backlog_s, expected))
        self.deadline = deadline
        self.wants_s = deadline - _TINY_S

    # end of a transaction --------------------------------------------------------------------------------------

    def _end(self, quiet_s: float) -> None:
        """End the transaction; nothing is sent before ``quiet_s``."""
        self._active = None
        self._buffer = b""
        self.wants_s = -inf
        if quiet_s > self._quiet_s:
            self._quiet_s = quiet_s

    def _succeed(self, request: Request, data: bytes, t: float) -> None:
        self._active = None
        self._buffer = b""
        self._suspect = None
        quiet_s = t + self.gap_s
        if quiet_s > self._quiet_s:
            self._quiet_s = quiet_s
        station = request.station
        station.counters.replies += 1
        station.misses = request.misses = 0
        station.is_lost = False
        schedule = self._schedule
        if not station.reply.measured:
            station.reply.note(max(0.0, t - request.sent_s - request.wire_s))
            if station.reply.measured:
                self.measured(station)
                schedule.look_again()
        if request is schedule.steady:  # due again with the next scan
            request.due_s, request.wish_s = request.sent_s, inf
        else:
            schedule.succeeded(request, t)
        self.wants_s = schedule.wants_s
        latest_s = schedule.latest_s
        self.deadline = latest_s if latest_s > quiet_s else quiet_s
        # A late tick must not make a reading look newer than the time-out allows.
        station.owner.received(request, data, t if t < self._give_up_s else self._give_up_s)

    def _time_out(self, request: Request, now: float) -> None:
        """Give a request up, and keep the line silent: its reply may still come.

        That reply would count for the next request of the same shape (pymodbus-dev/pymodbus#2636). A slave slower than
        the longest measured time and than its profile's limit can still cause that, because an RTU frame does not name
        its request. Over TCP the connection is dropped.
        """
        station = request.station
        station.counters.timeouts += 1
        if self._buffer:
            station.counters.garbage += 1
        if self.socket:
            self._doubt = f"no reply on {request.describe()}"
            self._fail(request, now, now)
        else:
            self._suspect = request
            self._fail(request, now, now + request.quiet_s)
        if not station.is_lost:
            station.owner.missed()

    def _fail(self, request: Request, t: float, quiet_s: float) -> None:
        """End an attempt without a good reply."""
        self._end(quiet_s)
        station = request.station
        station.misses += 1
        if request.writes:
            request.misses += 1
        self._schedule.failed(request, t)
        if (station.misses >= MISSES_TO_LOSE or request.misses >= MISSES_TO_LOSE) and not station.is_lost:
            request.misses = 0
            self._lose(station, t)

    def _lose(self, station: Station, t: float) -> None:
        station.is_lost = True
        self._schedule.lost(station, t)
        station.owner.lost(t)

    def _act(self, request: Request, answer: ReplySoFar, t: float) -> None:
        """Act on the answer so far."""
        kind = answer.kind
        if kind is _GOOD:
            self._succeed(request, answer.data, t)
        elif kind is AnswerKind.WAITED_FOR:
            self._buffer = answer.data
        elif kind is AnswerKind.EXCEPTION:
            self._except(request, answer.code, t)
        elif kind is AnswerKind.BROKEN:
            self._fail(request, t, t + self.gap_s + request.reply_wire_s)
        else:
            self._doubt = answer.why  # the connection is dropped
            self._fail(request, t, t)

    def _except(self, request: Request, code: int, t: float) -> None:
        """Act on an exception: a wrong configuration latches, a busy device is asked again, an absent one is lost."""
        station = request.station
        exceptions = station.counters.exceptions
        exceptions[code] = exceptions.get(code, 0) + 1
        if code in codec.CONFIGURATION or (code == codec.WRITE_PROTECTED and request.writes):
            self._end(t + self.gap_s)
            self._schedule.disable(request)
            self._schedule.look_again()
            if station.refused is None:
                station.refused = f"exception {code} ({codec.EXCEPTION_TEXTS[code]}) on {request.describe()}"
        elif code in codec.DEVICE_GONE:
            self._end(t + self.gap_s)
            station.misses = MISSES_TO_LOSE
            self._schedule.failed(request, t)
            if not station.is_lost:
                self._lose(station, t)
        else:
            self._fail(request, t + BUSY_S, t + self.gap_s)

    def _unasked(self, t: float) -> None:
        """Count unexpected bytes, after a time-out as a late reply; wait again until the line is silent."""
        if self.socket:
            if not self._doubt:
                self._doubt = "bytes without a request"
                self.garbage += 1
                self.wants_s = -inf
            return
        suspect = self._suspect
        if suspect is None:
            self.garbage += 1
            self._quiet_s = max(self._quiet_s, t + self.gap_s)
            return
        station = suspect.station
        station.counters.late += 1
        self._quiet_s = max(self._quiet_s, t + suspect.quiet_s)
        if t - suspect.sent_s <= station.longest_s:
            # The line is slower than measured, but within the limit: wait longer for the next reply.
            station.reply.note(t - suspect.sent_s - suspect.wire_s)
            self.measured(station)
            self._schedule.look_again()
