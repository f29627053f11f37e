"""The heating jacket: a temperature controller with its own PID on the hub's sensor.

Software gives the setpoint and watches; the loop, its limit and what happens without a master are in the controller.
"""

from __future__ import annotations

from math import inf, isfinite, nan
from typing import Final

from drivers.modbus import Device, ModbusLink, Request
from drivers.profiles.model import DeviceProfile, ProfileError

RENEW_S: Final = 0.45
"""The command registers are written again after this: twice a second also with scans at 20 Hz [A]."""
LEASE_S: Final = 2.0
"""Without a setpoint for this long the controller stops heating by itself [A]."""
UNHEARD: Final = "our setpoint does not reach it, its lease has run out"
STATUS_AGE_S: Final = 2.0
"""A status older than this against the temperature makes the reading invalid [A]."""


class HeatingJacket(Device):
    """Commands and reads the jacket's controller. Standby until ``enable(True)``.

    ``hub_c`` (NaN while the sensor is broken) and ``setpoint_c`` (the working setpoint, read back) in degC,
    ``output_percent``, ``sensor_break``, ``remote_failed`` (the controller says that our setpoint does not come);
    ``stamp_s`` is when the temperature arrived (-inf = never); ``counts`` is its bare register.
    """

    def __init__(self, profile: DeviceProfile, unit_id: int, link: ModbusLink, lease_s: float = LEASE_S) -> None:
        """Put the controller on ``link``; ``lease_s`` goes to its off-line time, where the profile has one.

        ``has_lease`` tells whether it does. ``ends_s`` is when it heats no more by itself without a setpoint, s: by its
        lease, or by a setpoint of its own; None: the hardware must switch the heat off when the PC is silent.
        Raises ProfileError for a profile without pv, output, setpoint, status, or a way to write setpoint and run.
        """
        profile.expect("jacket")
        super().__init__(profile, unit_id, link)
        if "setpoint" not in profile.writes or "run" not in profile.switches:
            raise ProfileError(f"profile {profile.name} does not say how to write the setpoint, or to run")
        main = [signal.name for signal in profile.blocks[0].signals]
        self._pv, self._output, self._working = (_place(profile, main, name) for name in ("pv", "output", "setpoint"))
        self._unpack = [block.unpack for block in profile.blocks]
        self._status_block, self._status_place = _find_status(profile)
        self._sensor_bits = profile.bit("sensor_break")
        self._remote_bits = profile.bit("remote_fail")
        pv = profile.signal("pv")
        self._pv_scale, self._pv_least, self._pv_greatest = pv.scale, pv.least, pv.greatest
        self._invalid_bits = profile.invalid_bits
        self._output_scale = profile.signal("output").scale
        self._working_scale = profile.signal("setpoint").scale
        self._register = profile.writes["setpoint"]
        self._wanted: int | None = None
        self._asked = False
        self._asked_c = nan
        self._run_wanted = False
        self._unconfirmed = False
        switch = self._switch = profile.switches["run"]
        self.has_lease = "lease" in profile.writes
        self.ends_s: float | None = lease_s if self.has_lease else profile.falls_back_s
        self.counts = 0
        self.status = 0
        self._status_s = -inf
        self.hub_c = self.output_percent = self.setpoint_c = nan
        self.sensor_break = self.remote_failed = False

        function = profile.write_function
        self._setpoint_write = link.write(self.station, function, self._register.address, (0,), RENEW_S)
        self._run_write = link.write(self.station, function, switch.address, (switch.off,), RENEW_S)
        self.add_write("standby", switch.address, (switch.off,), read_back=False)
        for write in profile.setup:
            self.add_write(write.name, write.address, (write.value,), write.read_back)
        if self.has_lease:
            lease = profile.writes["lease"]
            self.add_write("off-line time", lease.address, lease.words(lease_s, profile.word_order), read_back=True)
        self.begin()

    def set_setpoint(self, celsius: float) -> None:
        """Ask for a hub temperature, in degC, kept inside the profile's bounds; call it in every scan.

        It is written when it changes and twice a second; what is not asked for any more is not renewed either, and the
        controller's lease runs out. Raises ValueError unless it is a finite number.
        """
        if celsius != self._asked_c:
            self._change_setpoint(celsius)
        self._asked = True
        if not self._setpoint_write.enabled and self.ready:
            self.link.enable(self._setpoint_write)

    def _change_setpoint(self, celsius: float) -> None:
        if not isfinite(celsius):
            raise ValueError(f"the jacket's setpoint must be a finite number, not {celsius}")
        self._asked_c = celsius
        register = self._register
        bounded = min(max(celsius, register.least), register.greatest)
        counts = round(bounded / register.scale)
        if counts != self._wanted:
            self._wanted = counts
            self.link.rewrite(self._setpoint_write, register.words(bounded, self.profile.word_order))

    def enable(self, on: bool) -> None:
        """Let the controller run (True) or stand by; standby goes before everything else on the line."""
        if on != self._run_wanted:
            self._run_wanted = on
            self._unconfirmed = True
            self.link.rewrite(self._run_write, (self._switch.on if on else self._switch.off,), urgent=not on)

    def received(self, request: Request, data: bytes, t: float) -> None:
        """Take a good reply; a setpoint that nobody asked for since the last one is not renewed."""
        if request is self._setpoint_write:
            if not self._asked:
                self.link.disable(self._setpoint_write)
            self._asked = False
        elif request is not self._run_write:
            Device.received(self, request, data, t)
        elif self._unconfirmed and not request.fresh:
            # The output is read at once: a wheel that stops must not be taken for one that is still heated.
            self._unconfirmed = False
            self.link.enable(self._polls[0])

    def take(self, block: int, data: bytes, t: float) -> None:
        """Update the readings."""
        found = self._unpack[block](data)
        if block == self._status_block:
            self.status = status = found[self._status_place]
            self._status_s = t
            self.sensor_break = status & self._sensor_bits != 0
            self.remote_failed = status & self._remote_bits != 0
            self.complaint = UNHEARD if self.remote_failed else ""
        if block == 0:
            self.counts = found[self._pv]
            self.output_percent = found[self._output] * self._output_scale
            self.setpoint_c = found[self._working] * self._working_scale
            self.stamp_s = t
        stamp_s = self.stamp_s
        hub_c = self.counts * self._pv_scale
        usable = self._pv_least <= hub_c <= self._pv_greatest and not self.sensor_break and stamp_s > -inf
        self.hub_c = hub_c if usable else nan
        self.valid = usable and not self.status & self._invalid_bits and self._status_s >= stamp_s - STATUS_AGE_S

    def suspend(self) -> None:
        """Distrust the last reading and stop commanding; the set-up begins with standby."""
        self.valid = False
        self._status_s = -inf
        self.link.disable(self._setpoint_write)
        self.link.disable(self._run_write)

    def resume(self) -> None:
        """Command again what is wanted now."""
        if self._wanted is not None:
            self.link.enable(self._setpoint_write)
        self.link.enable(self._run_write)


def _place(profile: DeviceProfile, names: list[str], name: str) -> int:
    if name not in names:
        raise ProfileError(f"profile {profile.name}: the first read must hold {name}")
    return names.index(name)


def _find_status(profile: DeviceProfile) -> tuple[int, int]:
    """Return the block that holds the status and its place there."""
    for number, block in enumerate(profile.blocks):
        for place, signal in enumerate(block.signals):
            if signal.name == "status":
                return number, place
    raise ProfileError(f"profile {profile.name} does not read a status")
