"""A simulated temperature controller, with registers of 16 bits: the heating jacket's, or a climate chamber's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import floor, inf, isfinite
from typing import Final, Protocol

from drivers.profiles.model import LIMITS, DeviceProfile, Kind, ProfileError
from sim.nodes.modbus_slave import ILLEGAL_ADDRESS, ILLEGAL_VALUE, PATTERN, ModbusSlave

JACKET_CYCLE_S: Final = 0.125
"""Time between two runs of the jacket's loop [A]."""
CHAMBER_CYCLE_S: Final = 0.5
"""Time between two runs of the chamber's loop [A]."""
POWER_W: Final = 200.0
"""Heat of the jacket at 100 %, W [A]."""
JACKET_HOTTEST_C: Final = 155.0
"""The jacket's own limiter: from this temperature there is no heat until a standby below LIMIT_RESET_C [A]."""
LIMIT_RESET_C: Final = 145.0
CHAMBER_HOTTEST_C: Final = 105.0
CHAMBER_COLDEST_C: Final = -55.0
"""The chamber's own limiter: outside these temperatures it goes to standby [A]."""
_SHOWN: Final = ("pv", "output", "setpoint", "status")
_PV_MOST: Final = LIMITS["i16"][1]
"""Content of the temperature register when the sensor is broken."""


@dataclass(frozen=True, slots=True)
class ControlledPlant:
    """A loop and its limiter, tuned for the plant under control."""

    cycle_s: float
    band_k: float
    """Proportional band, K: its width is 100 % of output."""
    integral_s: float
    derivative_s: float
    least_percent: float
    """Least output, %; an output below 0 cools."""
    hottest_c: float
    coldest_c: float
    latches: bool
    """Whether the limiter holds until standby below LIMIT_RESET_C; otherwise it puts the controller in standby."""
    refuses: bool
    """Whether a setpoint beyond the profile's range is refused; otherwise the end of the range is used."""


CONTROLLED: Final[Mapping[Kind, ControlledPlant]] = {
    "jacket": ControlledPlant(
        JACKET_CYCLE_S, 2.5, 60.0, 1.0, 0.0, JACKET_HOTTEST_C, -inf, latches=True, refuses=False
    ),
    "chamber": ControlledPlant(
        CHAMBER_CYCLE_S, 3.0, 300.0, 0.0, -100.0, CHAMBER_HOTTEST_C, CHAMBER_COLDEST_C, latches=False, refuses=True
    ),
}
"""Plants by the kind of profile. The jacket's is tuned for 200 W on a hub of 420 J/K with 20 W/K to the rubber and a
sensor lag of 1 s; the chamber has full output at 3 K off its setpoint. [A]"""
FILTER_S: Final = 2.0
"""Time constant of the derivative's filter, s [A]."""


class TemperatureSource(Protocol):
    """Source of the temperature at the controller's sensor."""

    def controller_measured_c(self, t: float) -> float:
        """Return the controlled temperature in degC at ``t`` s; NaN when the sensor is broken."""
        ...


class Pid:
    """Output in % from setpoint and measurement; derivative of the measurement, integral without wind-up."""

    def __init__(self, plant: ControlledPlant) -> None:
        """Take the tuning of a plant; output 0."""
        self.plant = plant
        self.reset()

    def reset(self) -> None:
        """Forget everything: output 0."""
        self.integral = self._derivative = 0.0
        self._last_pv: float | None = None

    def step(self, setpoint: float, pv: float, dt: float) -> float:
        """Advance by ``dt`` s and return the output in %."""
        plant = self.plant
        if self._last_pv is not None:
            rate = (pv - self._last_pv) / dt
            self._derivative += (rate - self._derivative) * dt / (FILTER_S + dt)
        self._last_pv = pv
        gain = 100.0 / plant.band_k
        error = setpoint - pv
        direct = gain * (error - plant.derivative_s * self._derivative)
        wanted, least = direct + self.integral, plant.least_percent
        # The integral stops while the output is at a limit and the error would drive it further there.
        driven_up, driven_down = wanted >= 100.0 and error > 0.0, wanted <= least and error < 0.0
        if not driven_up and not driven_down:
            self.integral += gain * error * dt / plant.integral_s
            self.integral = min(max(self.integral, least), 100.0)
        return min(max(direct + self.integral, least), 100.0)


class ControllerSlave(ModbusSlave):
    """A controller with a loop of its own, driven by ``advance``; it samples its sensor once in each cycle.

    ``output`` in %, below 0 for cooling; ``heater_w`` is a jacket's heat before the contactor in its supply.
    ``running``, ``setpoint_c``, ``lease_s`` (0 = off), ``lease_expired``, ``limited`` and ``sensor_broken`` are its
    state. Setting ``sensor_broken``, ``hottest_c`` or ``stuck_output`` (in %) makes it faulty. ``stuck_element`` (in %)
    is heat that flows at any output: a shorted relay, or an open line.
    """

    __slots__ = (
        "_blocks", "_break_bits", "_broken", "_cold_bits", "_coldest_c", "_cycle_s", "_expired_bits", "_falls_back_s",
        "_hot_bits", "_latches", "_lease", "_pid", "_power_w", "_read_only", "_refuses", "_renewed_s", "_scales",
        "_setpoint", "_setup", "_switch", "dither", "heater_w", "hottest_c", "lease_expired", "lease_s", "limited",
        "output", "pv_c", "running", "sensor_broken", "setpoint_c", "source", "stuck_element", "stuck_output",
    )  # fmt: skip

    def __init__(self, profile: DeviceProfile, unit_id: int, source: TemperatureSource) -> None:
        """Place the registers as in ``profile``. Raises ProfileError unless it can be simulated."""
        plant = _plant(profile)
        super().__init__(unit_id, profile.timing.turnaround_s, _registers(profile), profile.functions)
        self._read_only = frozenset(
            address for block in profile.blocks for address in range(block.address, block.address + block.count)
        )
        self._blocks = tuple(
            (block, tuple(_SHOWN.index(signal.name) for signal in block.signals)) for block in profile.blocks
        )
        self.blocks = {(block.address, block.count): number for number, block in enumerate(profile.blocks)}
        self._scales = tuple(profile.signal(name).scale for name in ("pv", "output", "setpoint"))
        # If the profile has an alarm of its own, over_range is for its sensor.
        self._hot_bits = profile.bit("alarm_1") or profile.bit("over_range")
        self._cold_bits = profile.bit("under_range")
        self._break_bits = profile.bit("sensor_break") | profile.bit("over_range") & ~self._hot_bits
        self._expired_bits = profile.bit("remote_fail") | profile.bit("lease_expired")
        self._setpoint = profile.writes["setpoint"]
        self._lease = profile.writes.get("lease")
        self._falls_back_s = profile.falls_back_s
        self._switch = profile.switches["run"]
        self._setup = frozenset((write.address, write.words[0]) for write in profile.setup)
        kept = {self._switch.address, *(write.address for write in profile.setup)}
        if self._lease is not None:
            kept.add(self._lease.address)
        self.stored = frozenset(kept)
        self.put(self._switch.address, self._switch.off.to_bytes(2, "big"))
        self.source = source
        self._pid = Pid(plant)
        self._cycle_s, self._coldest_c, self._latches = plant.cycle_s, plant.coldest_c, plant.latches
        self._refuses = plant.refuses
        self._power_w = POWER_W if profile.kind == "jacket" else 0.0
        self.hottest_c = plant.hottest_c
        self.due_s = -inf
        self.pv_c = self.heater_w = self.setpoint_c = self.lease_s = self.output = 0.0
        self.running = self.lease_expired = self.limited = self.sensor_broken = False
        self.stuck_output: float | None = None
        self.stuck_element: float | None = None
        self._broken = False
        self._renewed_s = -inf
        self.dither = 0

    # the controller --------------------------------------------------------------------------------------------

    def advance(self, t0: float, t1: float) -> None:
        """Advance from ``t0`` to ``t1`` s: run every cycle that is due."""
        if t1 < self.due_s:
            return
        if self.due_s == -inf:
            self.due_s = t0
        while self.due_s <= t1:
            self._cycle(self.due_s)
            self.due_s += self._cycle_s

    def power(self, on: bool) -> None:
        """Switch the supply. Without supply the controller is silent and gives no heat; it starts in standby."""
        self.powered = on
        self._stand_by()
        self.setpoint_c = 0.0
        self.lease_expired = False
        self._heat(0.0)

    def _cycle(self, t: float) -> None:
        if not self.powered:
            return
        pv_c = self.source.controller_measured_c(t)
        self._broken = broken = self.sensor_broken or not isfinite(pv_c)
        if self.lease_s > 0.0 and self.running and t > self._renewed_s + self.lease_s:
            self.lease_expired = True
            self._stand_by()
        if self._falls_back_s is not None and self.running and t > self._renewed_s + self._falls_back_s:
            # Until the next setpoint comes: its own, which the set-up has made a setpoint without heat.
            self.lease_expired = True
            self.setpoint_c = 0.0
        if not broken:
            self.pv_c = pv_c
            self._limit(pv_c)
        output = 0.0
        if self.running and not broken and not self.limited and not self.lease_expired:
            output = self._pid.step(self.setpoint_c, pv_c, self._cycle_s)
        else:
            self._pid.reset()
        self._heat(output if self.stuck_output is None else self.stuck_output)

    def _limit(self, pv_c: float) -> None:
        """Apply the controller's own limiter."""
        beyond = pv_c >= self.hottest_c or pv_c <= self._coldest_c
        if not self._latches:
            self.limited = beyond
            if beyond:
                self._stand_by()
        elif beyond:
            self.limited = True
        elif not self.running and pv_c < LIMIT_RESET_C:
            self.limited = False

    def _stand_by(self) -> None:
        self.running = False
        self._pid.reset()
        self.put(self._switch.address, self._switch.off.to_bytes(2, "big"))

    def _heat(self, output: float) -> None:
        self.output = output
        element = output if self.stuck_element is None else self.stuck_element
        self.heater_w = 0.01 * element * self._power_w

    # its registers ---------------------------------------------------------------------------------------------

    def refresh(self, t: float) -> None:
        """Write the state of the last cycle into the registers."""
        shown = self._show()
        for block, places in self._blocks:
            self.put(block.address, block.pack(*[shown[place] for place in places]))

    def sample(self, block: int, t: float) -> bytes:
        """Return a block of the profile with the state of the last cycle."""
        shown = self._show()
        which, places = self._blocks[block]
        return which.pack(*[shown[place] for place in places])

    def _show(self) -> tuple[int, int, int, int]:
        """Return the counts of _SHOWN for one more reading."""
        self.dither = phase = (self.dither + 1) & 3
        pv, output, setpoint = self._scales
        status = 0
        if self.limited:
            status = self._cold_bits if self.pv_c <= self._coldest_c else self._hot_bits
        if self._broken:
            status |= self._break_bits
        if self.lease_expired:
            status |= self._expired_bits
        return (
            _PV_MOST if self._broken else min(floor(self.pv_c / pv + PATTERN[phase]), _PV_MOST),
            round(self.output / output),
            round(self.setpoint_c / setpoint),
            status,
        )

    def written(self, address: int, value: int, t: float) -> int:
        """Accept setpoint, run or standby, lease and the options of the set-up; nothing else can be written."""
        if address in self._read_only:
            return ILLEGAL_ADDRESS
        setpoint, lease, switch = self._setpoint, self._lease, self._switch
        if address == setpoint.address:
            counts = value - 0x10000 if value > LIMITS[setpoint.type][1] else value
            asked_c = counts * setpoint.scale
            taken_c = min(max(asked_c, setpoint.least), setpoint.greatest)
            if self._refuses and taken_c != asked_c:
                return ILLEGAL_VALUE
            self.setpoint_c = taken_c
            self._renewed_s = t
            self.lease_expired = False
        elif lease is not None and address == lease.address:
            if not lease.least <= value * lease.scale <= lease.greatest:
                return ILLEGAL_VALUE
            self.lease_s = value * lease.scale
        elif address == switch.address and value == switch.on:
            self.running = True
        elif address == switch.address and value == switch.off:
            self._stand_by()
        elif (address, value) not in self._setup:
            return ILLEGAL_VALUE
        return 0


def _plant(profile: DeviceProfile) -> ControlledPlant:
    """Return the plant of a profile's controller. Raises ProfileError if it cannot be simulated."""
    plant = CONTROLLED.get(profile.kind)
    if plant is None:
        raise ProfileError(f"profile {profile.name} describes a {profile.kind}, not a temperature controller")
    shown = [signal for block in profile.blocks for signal in block.signals]
    sizes = {signal.size for signal in (*profile.writes.values(), *shown)}
    if sizes != {1} or any(len(write.words) != 1 or not write.writes for write in profile.setup):
        raise ProfileError(f"profile {profile.name}: the simulated controller has registers of 16 bits, without waits")
    if {signal.name for signal in shown} != set(_SHOWN) or profile.identity is not None:
        raise ProfileError(f"profile {profile.name}: the simulated controller shows {', '.join(_SHOWN)}, and no type")
    return plant


def _registers(profile: DeviceProfile) -> list[tuple[int, int]]:
    """Return (address, count) of every register in use."""
    registers = [(block.address, block.count) for block in profile.blocks]
    registers += [(write.address, 1) for write in profile.writes.values()]
    registers += [(write.address, 1) for write in profile.setup]
    return [*registers, (profile.switches["run"].address, 1)]
