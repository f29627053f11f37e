"""Surveys a Modbus line: queries every device of the rig file, then every other unit number."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from drivers.modbus.register_scan import LineAnswer, LineScan, RegisterQuestion
from drivers.ports import BusLost, LinePort, Parity
from drivers.profiles.model import DeviceProfile
from tester.doctor.open_wires import Wires
from tester.inputs.rig import DeviceConfig, LineConfig, Rig
from tester.inputs.rig.profiles import profile_of

PATIENCE_S = 0.25
"""Time limit for a device of the rig file, s: longer than every profile's reply time, even with a late adapter."""
SCAN_S = 0.06
"""Time limit for any other unit number, s [A]: the slowest profile's turnaround takes 20 ms, an adapter 16 ms."""
UNITS = range(1, 248)
"""Addresses of devices (Modbus over serial line V1.02, 2.2)."""
STEP_S = 0.002
RUN = "run"
"""Name of the switch that lets a controller control."""
BAUDS = (115_200, 57_600, 38_400, 19_200, 9_600)
PARITIES: tuple[Parity, ...] = ("N", "E", "O")
TRIES = 3
"""Greatest number of times that a device is queried until it answers."""


@dataclass(slots=True)
class UnitSurvey:
    """The answers of a device of the rig file."""

    config: DeviceConfig
    profile: DeviceProfile
    blocks: list[LineAnswer] = field(default_factory=list[LineAnswer])
    """An answer for each block of registers of the profile."""
    configuration: dict[str, LineAnswer] = field(default_factory=dict[str, LineAnswer])
    """Answers for the registers of identity, set-up and parameters, by name."""

    running: LineAnswer | None = None
    """Answer for the register that switches a controller on; None for a device without one."""

    @property
    def switched_on(self) -> bool:
        """Whether the device is a controller that controls at present."""
        answer = self.running
        return answer is not None and answer.ok and answer.data == self.profile.switches[RUN].on.to_bytes(2, "big")

    @property
    def there(self) -> bool:
        """Whether the device answered at all."""
        return any(answer.there for answer in (*self.blocks, *self.configuration.values()))

    @property
    def noise(self) -> bytes:
        """Received bytes that do not belong to an answer."""
        return b"".join(answer.noise for answer in (*self.blocks, *self.configuration.values()))

    def question(self, block: int = 0, number: int | None = None) -> RegisterQuestion:
        """Return the question for a block of registers; ``number``: the number of another unit to query instead."""
        asked = self.profile.blocks[block]
        unit_id = self.config.unit_id if number is None else number
        return RegisterQuestion(unit_id, asked.function, asked.address, asked.count)

    @property
    def reads(self) -> int:
        """The function that reads a register of the device's configuration."""
        return 3 if 3 in self.profile.functions else 4

    def settings(self) -> Iterator[tuple[str, RegisterQuestion]]:
        """Yield name and question of every configuration register: identity, set-up, parameters.

        Setpoint and lease are left out, because they are commands.
        """
        profile, unit_id, reads = self.profile, self.config.unit_id, self.reads
        if profile.identity is not None:
            yield "device type", RegisterQuestion(unit_id, profile.identity.function, profile.identity.address, 1)
        for write in profile.setup:
            if not write.mask:  # a wait for some bits of a status, which is read besides
                function = reads if write.read == 3 else write.read
                yield write.name, RegisterQuestion(unit_id, function, write.address, write.count)
        for name, signal in profile.writes.items():
            if name not in ("setpoint", "lease"):
                yield name, RegisterQuestion(unit_id, 1 if signal.type == "bit" else reads, signal.address, signal.size)


@dataclass(slots=True)
class LineSurvey:
    """The results of a survey of a line."""

    lost: str = ""
    units: dict[str, UnitSurvey] = field(default_factory=dict[str, UnitSurvey])
    """The survey of each device, by its name in the rig file."""
    others: dict[int, LineAnswer] = field(default_factory=dict[int, LineAnswer])
    """Answers of units that are not in the rig file, by unit number."""
    looks_like: dict[int, str] = field(default_factory=dict[int, str])
    """For each of these that has the registers of a device of the rig file, that device."""
    hears_itself: bool = False
    """Whether the adapter returns every request that it sends."""
    answers_at: LineConfig | None = None
    """The settings at which a device answers, if they are not the rig file's."""


def survey_line(rig: Rig, name: str, wires: Wires, *, everybody: bool = True) -> LineSurvey:
    """Query the devices of a line; with ``everybody``, also every other unit number."""
    survey = LineSurvey()
    config = rig.lines[name]
    for key, device in rig.devices.items():
        if device.line == name:
            survey.units[key] = UnitSurvey(device, profile_of(device.profile))
    try:
        port = wires.line(name, config)
        scan = LineScan(config.framing, config.baud, config.parity)
        for unit in survey.units.values():
            _ask_unit(scan, port, wires, unit)
        if everybody:
            known = {unit.config.unit_id for unit in survey.units.values()}
            for other in UNITS:
                answer = None if other in known else asked(scan, port, wires, RegisterQuestion(other, 3, 0, 1), SCAN_S)
                if answer is not None and answer.there:
                    survey.others[other] = answer
            _compare(scan, port, wires, survey)
        survey.hears_itself = scan.hears_itself
    except BusLost as lost:
        survey.lost = str(lost)
        return survey
    if survey.units and not survey.others and not any(unit.there for unit in survey.units.values()):
        survey.answers_at = _other_settings(config, name, wires, survey)
    return survey


def asked(scan: LineScan, port: LinePort, wires: Wires, question: RegisterQuestion, timeout_s: float) -> LineAnswer:
    """Ask a question and return the answer; raises BusLost."""
    scan.ask(question, timeout_s)
    while True:
        now = wires.now()
        scan.feed(port.read(now), now)
        scan.service(port, now)
        if scan.answer is not None:
            return scan.answer
        wires.wait_until(now + STEP_S)


def _ask_unit(scan: LineScan, port: LinePort, wires: Wires, unit: UnitSurvey) -> None:
    """Read all registers in a device's profile; if the first is not answered, skip the rest."""
    for block in range(len(unit.profile.blocks)):
        answer = _patiently(scan, port, wires, unit.question(block))
        unit.blocks.append(answer)
        if not answer.there and len(unit.blocks) == 1:
            return
    for name, question in unit.settings():
        unit.configuration[name] = _patiently(scan, port, wires, question)
    if RUN in unit.profile.switches and not unit.profile.switches[RUN].coil:
        question = RegisterQuestion(unit.config.unit_id, unit.reads, unit.profile.switches[RUN].address, 1)
        unit.running = _patiently(scan, port, wires, question)


def _patiently(scan: LineScan, port: LinePort, wires: Wires, question: RegisterQuestion) -> LineAnswer:
    answer = LineAnswer(question)
    for _ in range(TRIES):
        answer = asked(scan, port, wires, question, PATIENCE_S)
        if answer.there:
            break
    return answer


def _marks(unit: UnitSurvey, number: int) -> Iterator[tuple[RegisterQuestion, int | None]]:
    """Yield questions that identify a type of device at another unit number, each with the expected value."""
    identity = unit.profile.identity
    if identity is not None:
        yield RegisterQuestion(number, identity.function, identity.address, 1), identity.value
    yield unit.question(number=number), None


def _compare(scan: LineScan, port: LinePort, wires: Wires, survey: LineSurvey) -> None:
    """Determine whether an unknown unit is a device that does not answer at its own number."""
    for number in survey.others:
        for key, unit in survey.units.items():
            if unit.there:
                continue
            fits = True
            for question, value in _marks(unit, number):
                answer = asked(scan, port, wires, question, PATIENCE_S)
                fits = fits and answer.ok and (value is None or int.from_bytes(answer.data[:2], "big") == value)
            if fits:
                survey.looks_like[number] = key


def _other_settings(config: LineConfig, name: str, wires: Wires, survey: LineSurvey) -> LineConfig | None:
    """Return the settings at which a device of the line answers; None if there are none."""
    if config.framing == "socket":
        return None
    for baud in BAUDS:
        for parity in PARITIES:
            tried = replace(config, baud=baud, parity=parity)
            if tried == config:
                continue
            try:
                port = wires.line(name, tried)
            except BusLost:
                continue  # an adapter need not support every setting
            scan = LineScan(tried.framing, baud, parity)
            if any(asked(scan, port, wires, unit.question(), PATIENCE_S).there for unit in survey.units.values()):
                return tried
    return None
