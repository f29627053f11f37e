"""The simulated controller of a climate chamber: heats and cools, stands by without a master.

Its register map is that of ``drivers/profiles/climate_chamber.toml``, or of another profile of the kind ``chamber``
with registers of 16 bits: reading, working setpoint, output and alarm word to read, setpoint, lease and run to write.
"""

from __future__ import annotations

from math import floor, inf, isfinite
from typing import Final, Protocol

from drivers.profiles.model import LIMITS, DeviceProfile, ProfileError
from sim.nodes.dither import PATTERN
from sim.nodes.modbus_slave import ILLEGAL_ADDRESS, ILLEGAL_VALUE, ModbusSlave

CYCLE_S: Final = 0.5
"""Time between two runs of the controller's loop [A]."""
BAND_K: Final = 3.0
"""Difference to the setpoint at which it heats or cools with all it has [A]."""
INTEGRAL_S: Final = 300.0
"""Its integral time [A]."""
HOTTEST_C: Final = 105.0
COLDEST_C: Final = -55.0
"""The controller's own limiter: beyond these it stands by [A]."""
_SHOWN: Final = ("pv", "setpoint", "output", "status")
_PV_MOST: Final = LIMITS["i16"][1]
"""What the temperature register shows when the sensor is broken."""


class AirSource(Protocol):
    """What the controller's sensor measures."""

    def chamber_measured_c(self, t: float) -> float:
        """Return the temperature of the chamber's air in degC at ``t`` s; NaN when the sensor is broken."""
        ...


class ChamberSlave(ModbusSlave):
    """A controller with a loop of its own, driven by ``advance``.

    ``output`` is what it does to the air, -100 (cooling) to 100 %; ``running``, ``setpoint_c``, ``lease_s`` (0 = off),
    ``lease_expired``, ``too_hot`` and ``too_cold`` tell its state. ``stuck_output`` (in %) makes it faulty.
    """

    def __init__(self, profile: DeviceProfile, unit_id: int, source: AirSource) -> None:
        """Put the registers where ``profile`` has them. Raises ProfileError unless it can be simulated."""
        profile.expect("chamber")
        names = [signal.name for signal in profile.blocks[0].signals]
        if len(profile.blocks) != 1 or set(names) != set(_SHOWN):
            raise ProfileError(f"profile {profile.name}: the simulated chamber shows {', '.join(_SHOWN)} in one read")
        block = self._block = profile.blocks[0]
        if any(signal.size != 1 for signal in (*block.signals, *profile.writes.values())):
            raise ProfileError(f"profile {profile.name}: the simulated chamber has registers of 16 bits only")
        self._setpoint, self._lease = profile.writes["setpoint"], profile.writes["lease"]
        self._switch = profile.switches["run"]
        written = [(address, 1) for address in (self._setpoint.address, self._lease.address, self._switch.address)]
        super().__init__(unit_id, profile.timing.turnaround_s, [(block.address, block.count), *written],
                         profile.functions)  # fmt: skip
        self.blocks = {(block.address, block.count): 0}
        self._order = tuple(_SHOWN.index(name) for name in names)
        self._scales = tuple(profile.signal(name).scale for name in _SHOWN[:3])
        self._bits = tuple(profile.bit(name) for name in ("sensor_break", "over_range", "under_range", "lease_expired"))
        self.source = source
        self.due_s = -inf
        self.pv_c = 0.0
        self.output = 0.0
        self.running = False
        self.setpoint_c = 0.0
        self.lease_s = 0.0
        self.lease_expired = self.too_hot = self.too_cold = False
        self.stuck_output: float | None = None
        self._broken = False
        self._integral = 0.0
        self._renewed_s = -inf
        self.dither = 0

    def advance(self, t0: float, t1: float) -> None:
        """Live from ``t0`` to ``t1`` s: run every cycle that falls due."""
        if self.due_s == -inf:
            self.due_s = t0
        while self.due_s <= t1:
            self._cycle(self.due_s)
            self.due_s += CYCLE_S

    def power(self, on: bool) -> None:
        """Switch the supply. Without it the controller is silent and does nothing; it starts in standby."""
        self.powered = on
        self._stand_by()
        self.setpoint_c = self.lease_s = 0.0
        self.lease_expired = False
        self.output = 0.0

    def _cycle(self, t: float) -> None:
        if not self.powered:
            return
        air_c = self.source.chamber_measured_c(t)
        self._broken = not isfinite(air_c)
        if self.lease_s > 0.0 and self.running and t > self._renewed_s + self.lease_s:
            self.lease_expired = True
        if not self._broken:
            self.pv_c = air_c
            self.too_hot, self.too_cold = air_c > HOTTEST_C, air_c < COLDEST_C
        if self._broken or self.lease_expired or self.too_hot or self.too_cold:
            self._stand_by()
        output = self._regulate() if self.running else 0.0
        self.output = output if self.stuck_output is None else self.stuck_output

    def _regulate(self) -> float:
        """Return the output of a proportional and integral loop whose integral rests at the output's ends."""
        direct = 100.0 * (self.setpoint_c - self.pv_c) / BAND_K
        if -100.0 < direct + self._integral < 100.0:
            self._integral += direct * CYCLE_S / INTEGRAL_S
        return min(max(direct + self._integral, -100.0), 100.0)

    def _stand_by(self) -> None:
        self.running = False
        self._integral = 0.0
        self.put(self._switch.address, self._switch.off.to_bytes(2, "big"))

    # its registers ---------------------------------------------------------------------------------------------

    def refresh(self, t: float) -> None:
        """Bring the registers up to date."""
        self.put(self._block.address, self.sample(0, t))

    def sample(self, block: int, t: float) -> bytes:
        """Return what is read, with the state of the last cycle."""
        self.dither = phase = (self.dither + 1) & 3
        pv, setpoint, output = self._scales
        flags = (self._broken, self.too_hot, self.too_cold, self.lease_expired)
        shown = (
            _PV_MOST if self._broken else min(floor(self.pv_c / pv + PATTERN[phase]), _PV_MOST),
            round(self.setpoint_c / setpoint),
            round(self.output / output),
            sum(bit for bit, on in zip(self._bits, flags, strict=True) if on),
        )
        return self._block.pack(*[shown[place] for place in self._order])

    def written(self, address: int, value: int, t: float) -> int:
        """Take setpoint, lease, run or standby; nothing else can be written."""
        switch = self._switch
        if address == self._setpoint.address:
            celsius = (value - 0x10000 if value > 0x7FFF else value) * self._setpoint.scale
            if not self._setpoint.least <= celsius <= self._setpoint.greatest:
                return ILLEGAL_VALUE
            self.setpoint_c = celsius
            self._renewed_s = t
            self.lease_expired = False
        elif address == self._lease.address:
            if not self._lease.least <= value * self._lease.scale <= self._lease.greatest:
                return ILLEGAL_VALUE
            self.lease_s = value * self._lease.scale
        elif address != switch.address:
            return ILLEGAL_ADDRESS
        elif value == switch.on:
            self.running = True
        elif value == switch.off:
            self._stand_by()
        else:
            return ILLEGAL_VALUE
        return 0
