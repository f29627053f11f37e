"""Watches a rig for a minute: reads every device as fast as a run does, listens to the CAN bus, times the computer."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from math import inf

from drivers.modbus.register_scan import LineScan, RegisterQuestion
from drivers.ports import BusLost, CanPort, LinePort, TellingCanPort
from tester.doctor.can_survey import Listened
from tester.doctor.line_survey import LineSurvey
from tester.doctor.open_wires import Wires
from tester.inputs.rig import Rig

PATIENCE_S = 0.15
"""Time limit for a reading, s: a slow profile's 60 ms, an adapter's latency, and a busy computer's delay [A]."""

STEP_S = 0.001
"""Period for reading the lines, s."""
KEPT = 2000
"""Greatest number of readings that are kept of a device: 20 s of one that is read 100 times a second."""


@dataclass(slots=True)
class UnitWatch:
    """A device's answers over time."""

    questions: int = 0
    readings: int = 0
    exceptions: int = 0
    silences: int = 0
    noises: int = 0
    delays_s: list[float] = field(default_factory=list[float])
    """Delay of each answer: from the end of the request to the start of the answer, s."""
    took_s: list[float] = field(default_factory=list[float])
    """Duration of each exchange: from the request's first byte to the answer's last, s."""
    oldest_s: float = 0.0
    """Greatest age of a reading at the time when the next arrived, s."""
    values: deque[tuple[float, bytes]] = field(default_factory=lambda: deque[tuple[float, bytes]](maxlen=KEPT))
    """Arrival (s) and registers of the newest readings of the first block."""
    last_s: float = -inf

    @property
    def failed(self) -> int:
        """Number of questions without a reading."""
        return self.questions - self.readings


@dataclass(slots=True)
class RigWatch:
    """What the doctor found while it listened to the buses and lines of a rig."""

    seconds: float = 0.0
    can: Listened = field(default_factory=Listened)
    can_lost: str = ""
    can_errors: dict[str, int] | None = None
    """Error frames by kind; None if the adapter reports none."""
    can_state: str = ""
    """The adapter's state at the end; "" if it reports none."""
    units: dict[str, UnitWatch] = field(default_factory=dict[str, UnitWatch])
    """The watch of each device, by its name in the rig file."""
    lines_lost: dict[str, str] = field(default_factory=dict[str, str])
    late_s: list[float] = field(default_factory=list[float])
    """Lateness of each scan, s; empty in simulated time."""


class _Line:
    """A line whose devices are read in turn."""

    def __init__(self, name: str, rig: Rig, port: LinePort, units: dict[str, UnitWatch]) -> None:
        config = rig.lines[name]
        self.name = name
        self.port = port
        self.scan = LineScan(config.framing, config.baud, config.parity)
        self.units = units
        self._asked: list[tuple[str, RegisterQuestion, float]] = []
        self._due: dict[str, float] = {}
        self._now = ""

    def add(self, key: str, question: RegisterQuestion, period_s: float) -> None:
        """Add a device to be read with this period, s; 0 = as fast as possible."""
        self._asked.append((key, question, period_s))
        self._due[key] = -inf

    def step(self, now: float) -> None:
        """Receive an answer and ask the next question; raises BusLost."""
        self.scan.feed(self.port.read(now), now)
        self.scan.service(self.port, now)
        if self._now and self.scan.answer is not None:
            self._take(self._now)
            self._now = ""
        if not self._now:
            self._next(now)

    def _next(self, now: float) -> None:
        due = [entry for entry in self._asked if self._due[entry[0]] <= now]
        if not due:
            return
        key, question, period_s = min(due, key=lambda entry: self._due[entry[0]])
        self._due[key] = now + period_s
        self._now = key
        self.units[key].questions += 1
        self.scan.ask(question, PATIENCE_S)
        self.scan.service(self.port, now)

    def _take(self, key: str) -> None:
        unit, answer = self.units[key], self.scan.answer
        assert answer is not None
        if answer.ok:
            unit.readings += 1
            unit.delays_s.append(answer.delay_s)
            unit.took_s.append(answer.took_s)
            if unit.last_s > -inf:
                unit.oldest_s = max(unit.oldest_s, answer.at_s - unit.last_s)
            unit.last_s = answer.at_s
            unit.values.append((answer.at_s, answer.data))
        elif answer.exception:
            unit.exceptions += 1
        elif answer.noise:
            unit.noises += 1
        else:
            unit.silences += 1


def watched(rig: Rig, wires: Wires, lines: dict[str, LineSurvey], seconds: float, *, can: bool) -> RigWatch:
    """Watch a rig for ``seconds``. ``lines``: the surveyed lines; ``can``: whether the bus could be opened."""
    result = RigWatch()
    opened = _open(rig, wires, lines, result)
    bus = wire = _bus(rig, wires, result) if can else None
    period_s = 1.0 / rig.scan.sliding_hz
    begun_s = wires.now()
    scan_due_s = begun_s + period_s
    while (now := wires.now()) < begun_s + seconds:
        if now >= scan_due_s - 1e-9:
            if wires.real:
                result.late_s.append(now - scan_due_s)
            missed = int((now - scan_due_s) / period_s)
            scan_due_s += period_s * (1 + missed)
            bus = _listen(bus, now, rig, result)
        for line in list(opened):
            try:
                line.step(now)
            except BusLost as lost:
                result.lines_lost[line.name] = str(lost)
                opened.remove(line)
        wires.wait_until(min(now + STEP_S, max(scan_due_s, now)))
        if wires.now() <= now:
            wires.wait_until(now + STEP_S)
    if isinstance(wire, TellingCanPort):
        result.can_errors, result.can_state = dict(wire.errors), wire.state
    result.seconds = wires.now() - begun_s
    result.can.seconds = result.seconds
    return result


def _open(rig: Rig, wires: Wires, lines: dict[str, LineSurvey], result: RigWatch) -> list[_Line]:
    opened: list[_Line] = []
    for name, survey in lines.items():
        there = {key: unit for key, unit in survey.units.items() if unit.there}
        if survey.lost or not there:
            continue
        try:
            line = _Line(name, rig, wires.line(name, rig.lines[name]), result.units)
        except BusLost as lost:
            result.lines_lost[name] = str(lost)
            continue
        for key, unit in there.items():
            result.units[key] = UnitWatch()
            line.add(key, unit.question(), unit.profile.blocks[0].period_s)
        opened.append(line)
    return opened


def _bus(rig: Rig, wires: Wires, result: RigWatch) -> CanPort | None:
    try:
        bus = wires.can(rig.can.bitrate)
        bus.receive(wires.now())
    except BusLost as lost:
        result.can_lost = str(lost)
        return None
    return bus


def _listen(bus: CanPort | None, now: float, rig: Rig, result: RigWatch) -> CanPort | None:
    if bus is None:
        return None
    try:
        result.can.take(bus.receive(now), rig.can.node)
    except BusLost as lost:
        result.can_lost = str(lost)
        return None
    return bus
