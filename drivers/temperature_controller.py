"""A temperature controller with its own control loop: the heating jacket's, or a climate chamber's.

Software sends the setpoint and watches; the loop, its limit and the reaction to a missing master are in the controller.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, isfinite, nan
from typing import Any, Final, Literal

from drivers.modbus import Device, ModbusLink, Request
from drivers.profiles.model import DeviceProfile, ProfileError

JACKET_RENEW_S: Final = 0.45
"""Period of rewriting the jacket's command registers, s: twice a second also with scans at 20 Hz [A]."""
JACKET_LEASE_S: Final = 2.0
"""Time without a setpoint after which the jacket stops heating by itself, s [A]."""
CHAMBER_RENEW_S: Final = 2.0
"""Period of rewriting the chamber's command registers, s [A]."""
CHAMBER_LEASE_S: Final = 30.0
"""Time without a setpoint after which the chamber goes to standby, s [A]: its air changes by 1.5 K in that time."""
ControllerKind = Literal["jacket", "chamber"]
PARTS: Final = ("pv", "output", "setpoint", "status")
"""The numbers that are read, wherever their registers are; the status may be missing."""
_STATUS: Final = 3
UNHEARD: Final = "our setpoint does not reach it, its lease has run out"
STATUS_AGE_S: Final = 2.0
"""Greatest lag of output, setpoint and status behind the temperature; above it the reading is invalid, s [A]."""


@dataclass(frozen=True, slots=True)
class _Commanding:
    """Command timing of a kind of controller."""

    renew_s: float
    lease_s: float
    needs_lease: bool
    reads_at_once: bool
    """A read follows run and standby: a wheel that stops must not count as still heated."""


_COMMANDED: Final[Mapping[ControllerKind, _Commanding]] = {
    "jacket": _Commanding(JACKET_RENEW_S, JACKET_LEASE_S, needs_lease=False, reads_at_once=True),
    "chamber": _Commanding(CHAMBER_RENEW_S, CHAMBER_LEASE_S, needs_lease=True, reads_at_once=False),
}


class TemperatureController(Device):
    """Commands and reads a controller. It is in standby until ``enable(True)``.

    ``measured_c`` (NaN while the sensor is broken) and ``setpoint_c`` (the working setpoint, read back) are in degC,
    ``output_percent`` is below 0 for cooling. ``sensor_break`` and ``out_of_range`` are status bits; ``lease_expired``:
    the controller reports that our setpoint does not arrive. ``stamp_s`` is the arrival of the temperature (-inf =
    never); ``counts`` is its bare register.
    """

    __slots__ = (
        "_asked", "_asked_c", "_expired_bits", "_invalid_bits", "_no_heat", "_output_scale", "_part_s", "_places",
        "_pv_greatest", "_pv_least", "_pv_scale", "_range_bits", "_reads_at_once", "_register", "_run_wanted",
        "_run_write", "_sensor_bits", "_setpoint_write", "_switch", "_unconfirmed", "_unpack", "_wanted",
        "_working_scale", "counts", "ends_s", "has_lease", "lease_expired", "measured_c", "out_of_range",
        "output_percent", "sensor_break", "setpoint_c", "status",
    )  # fmt: skip

    def __init__(self, kind: ControllerKind, profile: DeviceProfile, unit_id: int, link: ModbusLink) -> None:
        """Put a controller of ``kind`` (jacket, chamber) on ``link``; its lease is written if the profile has one.

        ``has_lease``: the profile has a lease. ``ends_s``: s without a setpoint until the controller stops heating by
        itself, by its lease or its own setpoint; None: the hardware must switch the heat off when the PC is silent.
        Raises ProfileError for a profile without pv, output, setpoint, or a way to write setpoint and run.
        """
        commanding = _COMMANDED[kind]
        _check(profile, kind, commanding.needs_lease)
        super().__init__(profile, unit_id, link)
        self._switch = profile.switches.get("run")
        self._places: list[list[tuple[int, int]]] = [
            [(PARTS.index(signal.name), place) for place, signal in enumerate(block.signals) if signal.name in PARTS]
            for block in profile.blocks
        ]
        self._part_s: list[float] = [-inf] * len(PARTS)
        self._unpack = [block.unpack for block in profile.blocks]
        if not profile.has("status"):
            self._part_s.pop()
        self._sensor_bits = profile.bit("sensor_break")
        self._range_bits = profile.bit("over_range") | profile.bit("under_range")
        self._expired_bits = profile.bit("remote_fail") | profile.bit("lease_expired")
        pv = profile.signal("pv")
        self._pv_scale, self._pv_least, self._pv_greatest = pv.scale, pv.least, pv.greatest
        self._invalid_bits = profile.invalid_bits
        self._output_scale = profile.signal("output").scale
        self._working_scale = profile.signal("setpoint").scale
        self._register = profile.writes["setpoint"]
        self._wanted: tuple[int, ...] = ()
        """Registers of the commanded setpoint; none yet."""
        self._asked = False
        self._asked_c = nan
        self._run_wanted = False
        self._reads_at_once = commanding.reads_at_once
        self._unconfirmed = False
        self.has_lease = "lease" in profile.writes
        self.ends_s: float | None = commanding.lease_s if self.has_lease else profile.falls_back_s
        self.counts: float = 0.0
        self.status = 0
        self.measured_c = self.output_percent = self.setpoint_c = nan
        self.sensor_break = self.out_of_range = self.lease_expired = False
        self._add_commands(commanding.renew_s)
        self._set_up(commanding.lease_s)

    def _add_commands(self, renew_s: float) -> None:
        """Add the writes of the setpoint and, with a switch, of run and standby, repeated every ``renew_s``."""
        profile, link, switch = self.profile, self.link, self._switch
        size, register, standby_c = self._register.size, self._register.address, profile.standby_c
        self._no_heat = size * (0,) if standby_c is None else self._register.words(standby_c, profile.order)
        """Registers of the setpoint that takes the place of a switch."""
        self._setpoint_write = link.write(self.station, self.write_function(size), register, self._no_heat, renew_s)
        self._run_write: Request | None = None
        if switch is not None:
            function = self.write_function(1, switch.coil)
            self._run_write = link.write(self.station, function, switch.address, (switch.off,), renew_s)

    def _set_up(self, lease_s: float) -> None:
        """Add standby, the profile's own writes and the lease (s, if there is one) to the set-up."""
        profile, switch = self.profile, self._switch
        for write in profile.setup:
            if write.first:
                self.add_setup(write)
        if switch is not None:
            self.add_write("standby", switch.address, (switch.off,), False, switch.coil)
        else:
            self.add_write("setpoint without heat", self._register.address, self._no_heat, read_back=True)
        for write in profile.setup:
            if not write.first:
                self.add_setup(write)
        if self.has_lease:
            lease = profile.writes["lease"]
            self.add_write("off-line time", lease.address, lease.words(lease_s, profile.order), read_back=True)
        self.begin()
        self._lasting = [step for step in self._lasting if step.request.address != self._register.address]

    def set_setpoint(self, celsius: float) -> None:
        """Ask for a temperature, in degC, kept inside the profile's bounds; call it in every scan.

        The setpoint is written after a change and at the period of renewal. If the calls stop, the renewal stops as
        well, and the controller's lease runs out. Raises ValueError unless the number is finite.
        """
        if celsius != self._asked_c:
            self._change_setpoint(celsius)
        self._asked = True
        if not self._setpoint_write.enabled and self.ready:
            self.link.enable(self._setpoint_write)

    def _change_setpoint(self, celsius: float) -> None:
        if not isfinite(celsius):
            raise ValueError(f"the {self.profile.kind}'s setpoint must be a finite number, not {celsius}")
        self._asked_c = celsius
        register = self._register
        bounded = min(max(celsius, register.least), register.greatest)
        words = register.words(bounded, self.profile.order)
        if words != self._wanted:
            self._wanted = words
            if self._run_wanted or self._switch is not None:
                self.link.rewrite(self._setpoint_write, words)

    def enable(self, on: bool) -> None:
        """Run the controller (True) or let it stand by; standby is sent before everything else on the line."""
        if on == self._run_wanted:
            return
        self._run_wanted = on
        self._unconfirmed = self._reads_at_once
        switch, run_write = self._switch, self._run_write
        if switch is not None and run_write is not None:
            self.link.rewrite(run_write, (switch.on if on else switch.off,), urgent=not on)
            return
        self.link.rewrite(self._setpoint_write, (self._wanted or self._no_heat) if on else self._no_heat, not on)
        if self.ready:
            self.link.enable(self._setpoint_write)

    def received(self, request: Request, data: bytes, t: float) -> None:
        """Process a good reply; a setpoint that was not asked for since the last renewal is not renewed."""
        if request is self._setpoint_write:
            if not self._asked and not request.fresh:
                self.link.disable(self._setpoint_write)
            self._asked = False
            if self._switch is None:
                self._look_at_once(request)
        elif request is not self._run_write:
            Device.received(self, request, data, t)
        else:
            self._look_at_once(request)

    def _look_at_once(self, request: Request) -> None:
        """Read the controller after a run or a standby has been confirmed."""
        if self._unconfirmed and not request.fresh:
            self._unconfirmed = False
            self.link.enable(self._polls[0])

    def take(self, block: int, data: bytes, t: float) -> None:
        """Update the readings."""
        found: tuple[Any, ...] = self._unpack[block](data)  # whole numbers, and floats of f32
        for part, place in self._places[block]:
            self._part_s[part] = t
            if part == _STATUS:
                self._take_status(int(found[place]))
                continue
            count = float(found[place])
            if part == 0:
                self.counts = count
                self.stamp_s = t
            elif part == 1:
                self.output_percent = count * self._output_scale
            else:
                self.setpoint_c = count * self._working_scale
        stamp_s = self.stamp_s
        measured_c = self.counts * self._pv_scale
        usable = self._pv_least <= measured_c <= self._pv_greatest and not self.sensor_break and stamp_s > -inf
        self.measured_c = measured_c if usable else nan
        self.valid = usable and not self.status & self._invalid_bits and min(self._part_s) >= stamp_s - STATUS_AGE_S

    def _take_status(self, status: int) -> None:
        """Update what the status bits mean."""
        self.status = status
        self.sensor_break = status & self._sensor_bits != 0
        self.out_of_range = status & self._range_bits != 0
        self.lease_expired = status & self._expired_bits != 0
        self.complaint = UNHEARD if self.lease_expired else ""

    def suspend(self) -> None:
        """Mark the last reading as invalid and stop commanding; the set-up begins with standby."""
        self.valid = False
        for part in range(len(self._part_s)):
            self._part_s[part] = -inf
        self.link.disable(self._setpoint_write)
        if self._run_write is not None:
            self.link.disable(self._run_write)

    def resume(self) -> None:
        """Resume the present commands."""
        if self._wanted and (self._run_wanted or self._switch is not None):
            self.link.enable(self._setpoint_write)
        if self._run_write is not None:
            self.link.enable(self._run_write)


def _check(profile: DeviceProfile, kind: ControllerKind, needs_lease: bool) -> None:
    """Raise ProfileError for a profile that a controller of ``kind`` cannot be read or commanded by."""
    profile.expect(kind)
    if "setpoint" not in profile.writes or ("run" in profile.switches) == (profile.standby_c is not None):
        raise ProfileError(f"profile {profile.name} does not say how to write the setpoint, or to run")
    if needs_lease and "lease" not in profile.writes:
        raise ProfileError(f"profile {profile.name} does not say how to write the lease, which a {kind} needs")
    for name in PARTS[:_STATUS]:
        profile.signal(name)
