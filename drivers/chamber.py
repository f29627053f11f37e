"""A climate chamber: a temperature controller that heats and cools the air around the specimen.

Software gives the setpoint and watches; the loop, its limits and what happens without a master are in the controller.
"""

from __future__ import annotations

from math import inf, isfinite, nan
from typing import Final

from drivers.modbus import Device, ModbusLink, Request
from drivers.profiles.model import DeviceProfile, ProfileError

RENEW_S: Final = 2.0
"""The setpoint is written again after this, s [A]."""
LEASE_S: Final = 30.0
"""Without a setpoint for this long the chamber stands by, s [A]: its air then changes by 1.5 K."""


class ClimateChamber(Device):
    """Commands and reads a chamber. Standby until ``enable(True)``.

    ``air_c`` (NaN while the sensor is broken) and ``setpoint_c`` (the working setpoint, read back) in degC,
    ``output_percent`` (below 0 cooling), ``alarm`` (the word) with ``sensor_break``, ``out_of_range`` and
    ``lease_expired``; ``stamp_s`` is when the reading arrived (-inf = never).
    """

    def __init__(self, profile: DeviceProfile, unit_id: int, link: ModbusLink, lease_s: float = LEASE_S) -> None:
        """Put the chamber on ``link``; ``lease_s`` goes to its watchdog.

        Raises ProfileError for a profile without pv, setpoint, output and status in its first read, or without a way
        to write setpoint, lease and run.
        """
        profile.expect("chamber")
        super().__init__(profile, unit_id, link)
        missing = [name for name in ("setpoint", "lease") if name not in profile.writes]
        missing += [name for name in ("run",) if name not in profile.switches]
        block = profile.blocks[0]
        names = [signal.name for signal in block.signals]
        missing += [name for name in ("pv", "setpoint", "output", "status") if name not in names]
        if missing:
            raise ProfileError(f"profile {profile.name} does not say how to read or write {', '.join(missing)}")
        self._unpack = block.unpack
        self._places = tuple(names.index(name) for name in ("pv", "setpoint", "output", "status"))
        self._pv = profile.signal("pv")
        self._scales = (profile.signal("setpoint").scale, profile.signal("output").scale)
        self._break_bits, self._lease_bits = profile.bit("sensor_break"), profile.bit("lease_expired")
        self._range_bits = profile.bit("over_range") | profile.bit("under_range")
        self._invalid_bits = profile.invalid_bits
        self._register = profile.writes["setpoint"]
        self._switch = profile.switches["run"]
        self._wanted: int | None = None
        self._asked = False
        self._run_wanted = False
        self.alarm = 0
        self.valid = False
        self.stamp_s = -inf
        self.air_c = self.setpoint_c = self.output_percent = nan
        self.sensor_break = self.out_of_range = self.lease_expired = False

        function, switch, lease = profile.write_function, self._switch, profile.writes["lease"]
        self._setpoint_write = link.write(self.station, function, self._register.address, (0,), RENEW_S)
        self._run_write = link.write(self.station, function, switch.address, (switch.off,), RENEW_S)
        self.add_write("standby", switch.address, (switch.off,), read_back=False)
        for write in profile.setup:
            self.add_write(write.name, write.address, (write.value,), write.read_back)
        self.add_write("lease", lease.address, lease.words(lease_s, profile.word_order), read_back=True)
        self.begin()

    def set_setpoint(self, celsius: float) -> None:
        """Ask for a temperature of the air, degC, kept inside the profile's bounds; call it in every scan.

        It is written when it changes and every RENEW_S; what is not asked for any more is not renewed either, and the
        chamber's lease runs out. Raises ValueError unless it is a finite number.
        """
        if not isfinite(celsius):
            raise ValueError(f"the chamber's setpoint must be a finite number, not {celsius}")
        register = self._register
        bounded = min(max(celsius, register.least), register.greatest)
        counts = round(bounded / register.scale)
        if counts != self._wanted:
            self._wanted = counts
            self.link.rewrite(self._setpoint_write, register.words(bounded, self.profile.word_order))
        self._asked = True
        if not self._setpoint_write.enabled and self.ready:
            self.link.enable(self._setpoint_write)

    def enable(self, on: bool) -> None:
        """Let the chamber run (True) or stand by; standby goes before everything else on the line."""
        if on != self._run_wanted:
            self._run_wanted = on
            self.link.rewrite(self._run_write, (self._switch.on if on else self._switch.off,), urgent=not on)

    def received(self, request: Request, data: bytes, t: float) -> None:
        """Take a good reply; a setpoint that nobody asked for since the last one is not renewed."""
        if request is self._setpoint_write:
            if not self._asked:
                self.link.disable(self._setpoint_write)
            self._asked = False
        elif request is not self._run_write:
            Device.received(self, request, data, t)

    def take(self, block: int, data: bytes, t: float) -> None:
        """Update the readings."""
        if block:
            return
        found = self._unpack(data)
        pv, setpoint, output, status = (found[place] for place in self._places)
        self.alarm = status
        self.sensor_break = status & self._break_bits != 0
        self.out_of_range = status & self._range_bits != 0
        self.lease_expired = status & self._lease_bits != 0
        self.setpoint_c, self.output_percent = setpoint * self._scales[0], output * self._scales[1]
        air_c = pv * self._pv.scale
        usable = self._pv.least <= air_c <= self._pv.greatest and not self.sensor_break
        self.air_c = air_c if usable else nan
        self.valid = usable and not status & self._invalid_bits
        self.stamp_s = t

    def suspend(self) -> None:
        """Distrust the last reading and stop commanding; the set-up begins with standby."""
        self.valid = False
        self.link.disable(self._setpoint_write)
        self.link.disable(self._run_write)

    def resume(self) -> None:
        """Command again what is wanted now."""
        if self._wanted is not None:
            self.link.enable(self._setpoint_write)
        self.link.enable(self._run_write)
