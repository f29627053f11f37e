"""Base of all Modbus devices: a device is identified and set up, then read again and again."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import inf

from drivers.modbus.codec import READ_COILS, READ_HOLDING, WRITE_COIL, WRITE_COILS, WRITE_MANY
from drivers.modbus.link import ModbusLink
from drivers.modbus.request import Request
from drivers.modbus.schedule import PROBE_S
from drivers.profiles.model import DeviceProfile, SetupWrite
from drivers.profiles.numbers import Number

ASK_AGAIN_S = 0.1
"""Time between two reads of a register that is to change by itself, s [A]."""


@dataclass(frozen=True, slots=True)
class SetupStep:
    """One exchange of the set-up."""

    what: str
    request: Request
    expected: bytes | None = None
    """Expected content of the registers read, as on the wire; None = any answer will do."""
    within_s: float = 0.0
    """Time from the first answer within which the registers must hold it, s."""
    mask: int = 0
    """Bits of the content that count; 0 = all."""
    lasts: bool = False
    """Whether the registers hold it for as long as the device is used."""

    def holds(self, data: bytes) -> bool:
        """Return whether the registers read hold what is expected."""
        expected = self.expected
        if expected is None or data[: len(expected)] == expected:
            return True
        both = (int.from_bytes(data[: len(expected)], "big"), int.from_bytes(expected, "big"))
        return self.mask != 0 and both[0] & self.mask == both[1] & self.mask


class Device(ABC):
    """A slave with a profile. It is set up when it first answers, and again after every loss.

    ``ready``: the device is set up and being read. ``refused``: the reason why it cannot be used, None if it can.
    ``valid``: the last reading can be believed; ``stamp_s``: its arrival (-inf = never). ``complaint``: what the device
    reports as missing, "" = nothing.
    """

    def __init__(self, profile: DeviceProfile, unit_id: int, link: ModbusLink) -> None:
        """Put the device on ``link``; subclasses add their requests and then call ``begin``."""
        self.profile = profile
        self.link = link
        self.station = link.station(unit_id, profile.timing, self)
        self.station.known_register = (profile.blocks[0].function, profile.blocks[0].address)
        self.ready = False
        self.valid = False
        self.complaint = ""
        self.stamp_s: float = -inf
        self._polls = [
            link.read(self.station, block.function, block.address, block.count, block.period_s)
            for block in profile.blocks
        ]
        for number, poll in enumerate(self._polls):
            poll.block = number
        self._steps: list[SetupStep] = []
        self._lasting: list[SetupStep] = []
        """Steps of registers that hold what was set up for as long as the device is used."""
        self._step = 0
        self._waits_until_s = inf
        """Time at which the present step gives up; infinity until its first answer."""

    @property
    def refused(self) -> str | None:
        """Reason why the device cannot be used as configured (identity, exception, read-back), or None."""
        return self.station.refused

    @property
    def is_lost(self) -> bool:
        """Return whether the device stopped answering."""
        return self.station.is_lost

    def begin(self) -> None:
        """Start: identity first, then the steps that the subclass added, or the first read if there are none."""
        identity = self.profile.identity
        if identity is not None:
            request = self.link.read(self.station, identity.function, identity.address, 1)
            self._steps.insert(0, SetupStep("device type", request, identity.value.to_bytes(2, "big"), lasts=True))
        self._lasting = [step for step in self._steps if step.lasts]
        if not self._steps:
            self._steps.append(SetupStep("first reading", self._polls[0]))
        self.link.enable(self._steps[0].request)

    def write_function(self, registers: int, coil: bool = False) -> int:
        """Return the function that writes so many registers, or a coil, in one request."""
        if coil:
            return WRITE_COIL if WRITE_COIL in self.profile.functions else WRITE_COILS
        return self.profile.write_function if registers == 1 else WRITE_MANY

    def add_write(self, what: str, address: int, words: tuple[int, ...], read_back: bool, coil: bool = False) -> None:
        """Add a write of registers, or of a coil, to the set-up, and a comparison of them afterwards."""
        number: Number = "bit" if coil else "u16" if len(words) == 1 else "u32"
        read = READ_COILS if coil else READ_HOLDING
        self.add_setup(SetupWrite(what, address, words, read_back, type=number, read=read))

    def add_setup(self, setup: SetupWrite) -> None:
        """Add a step of the profile's set-up: a write with its comparison, a wait for a value, or both."""
        if setup.writes:
            function = self.write_function(len(setup.words), setup.type == "bit")
            write = self.link.write(self.station, function, setup.address, setup.words)
            self._steps.append(SetupStep(setup.name, write))
        if setup.read_back:
            read = self.link.read(self.station, setup.read, setup.address, setup.count)
            lasts = setup.lasts or (setup.writes and not setup.within_s)
            self._steps.append(SetupStep(setup.name, read, setup.expected, setup.within_s, setup.mask, lasts))

    def received(self, request: Request, data: bytes, t: float) -> None:
        """Process a good reply that arrived at ``t`` s: continue the set-up, or update the readings."""
        if not self.ready:
            if request is self._steps[self._step].request:
                self._proceed(self._steps[self._step], data, t)
        elif request.block < 0:
            self._look_again(request, data, t)
        if request.block >= 0:
            self.take(request.block, data, t)

    def missed(self) -> None:
        """Read once more what was set up: a device that begins anew may miss a single request, and forgets."""
        if self.ready:
            for step in self._lasting:
                if not step.request.enabled:
                    self.link.enable(step.request)

    def _look_again(self, request: Request, data: bytes, t: float) -> None:
        """Set a device up again that holds something else than was set up."""
        for step in self._lasting:
            if request is step.request:
                self.link.disable(request)
                if not step.holds(data):
                    self.lost(t)
                return

    def lost(self, t: float) -> None:
        """Stop reading and wait for the device to answer the first step of the set-up again."""
        if not self.ready:
            self.link.disable(self._steps[self._step].request)
        for step in self._lasting:
            self.link.disable(step.request)
        self.ready = False
        for poll in self._polls:
            self.link.disable(poll)
        self._step = 0
        self._waits_until_s = inf
        self.suspend()
        if self.refused is None:
            self.link.enable(self._steps[0].request, t + PROBE_S)

    def _proceed(self, step: SetupStep, data: bytes, t: float) -> None:
        """End a step of the set-up and begin the next one."""
        if step.expected is not None:
            found, expected = data[: len(step.expected)], step.expected
            if not step.holds(data):
                self._waits_until_s = min(self._waits_until_s, t + step.within_s)
                if t < self._waits_until_s:
                    self.link.disable(step.request)
                    self.link.enable(step.request, t + ASK_AGAIN_S)
                    return
                one = len(expected) <= 2  # for people: a number, or the bytes of several registers
                shown = [str(int.from_bytes(held, "big")) if one else held.hex(" ") for held in (found, expected)]
                self.station.refused = f"{step.what}: register holds {shown[0]}, expected {shown[1]}"
                return
        self._step += 1
        self._waits_until_s = inf
        if step.request is not self._polls[0]:
            self.link.disable(step.request)
        if self._step < len(self._steps):
            self.link.enable(self._steps[self._step].request)
            return
        self.ready = True
        for poll in self._polls:
            self.link.enable(poll)
        self.resume()

    # hooks for subclasses --------------------------------------------------------------------------------------

    @abstractmethod
    def take(self, block: int, data: bytes, t: float) -> None:
        """Update the readings from the registers of a block of the profile, which arrived at ``t`` s."""

    @abstractmethod
    def suspend(self) -> None:
        """Act on the loss of the device: mark its readings as invalid."""

    @abstractmethod
    def resume(self) -> None:
        """Act on the end of the set-up; the reads are enabled already."""
