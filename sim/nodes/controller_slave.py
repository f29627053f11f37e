"""A simulated temperature controller: the heating jacket's, or a climate chamber's."""

from __future__ import annotations

from math import floor, inf, isfinite
from typing import Final, Protocol

from drivers.profiles.model import DeviceProfile, ProfileError
from drivers.profiles.numbers import BIT_READS, LIMITS, on_wire
from sim.nodes.control_loop import CONTROLLED, LIMIT_RESET_C, ControlledPlant, Pid
from sim.nodes.modbus_slave import ILLEGAL_ADDRESS, ILLEGAL_VALUE, PATTERN, ModbusSlave

POWER_W: Final = 200.0
"""Heat of the jacket at 100 %, W [A]."""
_SHOWN: Final = ("pv", "output", "setpoint", "status")
_PV_MOST: Final = LIMITS["i16"][1]
"""Count of the temperature when the sensor is broken."""


class TemperatureSource(Protocol):
    """Source of the temperature at the controller's sensor."""

    def controller_measured_c(self, t: float) -> float:
        """Return the controlled temperature in degC at ``t`` s; NaN when the sensor is broken."""
        ...


class ControllerSlave(ModbusSlave):
    """A controller with a loop of its own, driven by ``advance``; it samples its sensor once in each cycle.

    ``output`` in %, below 0 for cooling; ``heater_w`` is a jacket's heat before the contactor in its supply.
    ``running``, ``setpoint_c``, ``lease_s`` (0 = off), ``lease_expired``, ``limited`` and ``sensor_broken`` are its
    state. Setting ``sensor_broken``, ``hottest_c`` or ``stuck_output`` (in %) makes it faulty. ``stuck_element`` (in %)
    is heat that flows at any output: a shorted relay, or an open line.
    """

    __slots__ = (
        "_blocks", "_break_bits", "_broken", "_cold_bits", "_coldest_c", "_cycle_s", "_expired_bits", "_falls_back_s",
        "_floats", "_hot_bits", "_latches", "_lease", "_order", "_pid", "_power_w", "_read_only", "_refuses",
        "_renewed_s", "_scales", "_setpoint", "_setup", "_standby_c", "_switch", "dither", "heater_w", "hottest_c",
        "lease_expired", "lease_s", "limited", "output", "pv_c", "running", "sensor_broken", "setpoint_c", "source",
        "stuck_element", "stuck_output",
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
        shown = [profile.signal(name) for name in _SHOWN[:3]]
        self._scales = tuple(signal.scale for signal in shown)
        self._floats = tuple(signal.type == "f32" for signal in shown)
        self._take_bits(profile)
        self._setpoint = profile.writes["setpoint"]
        self._lease, self._falls_back_s = profile.writes.get("lease"), profile.falls_back_s
        self._order = profile.order
        self._switch = profile.switches.get("run")
        self._standby_c = profile.standby_c
        steps = [write for write in profile.setup if write.read not in BIT_READS]
        self._setup = frozenset(
            (write.address + place, word) for write in steps for place, word in enumerate(write.words)
        )
        self.stored = frozenset({address for address, _ in self._setup} | _kept(profile))
        self._place(profile)
        self.source = source
        self._pid = Pid(plant)
        self._cycle_s, self._coldest_c = plant.cycle_s, plant.coldest_c
        self._latches, self._refuses = plant.latches, plant.refuses
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

    def _take_bits(self, profile: DeviceProfile) -> None:
        """Take the meaning of the status bits."""
        # If the profile has an alarm of its own, over_range is for its sensor.
        self._hot_bits = profile.bit("alarm_1") or profile.bit("over_range")
        self._cold_bits = profile.bit("under_range")
        self._break_bits = profile.bit("sensor_break") | profile.bit("over_range") & ~self._hot_bits
        self._expired_bits = profile.bit("remote_fail") | profile.bit("lease_expired")

    def _place(self, profile: DeviceProfile) -> None:
        """Set the type, the switch to standby, and what the set-up waits for."""
        if profile.identity is not None:
            self.put(profile.identity.address, profile.identity.value.to_bytes(2, "big"))
        for write in profile.setup:
            held = 0 if write.writes else write.words[0]
            if write.read in BIT_READS:
                self.bits.update({write.address + place: held >> place & 1 for place in range(write.count)})
            elif not write.writes:
                self.put(write.address, on_wire(write.words))
        if self._switch is not None and self._switch.coil:
            self.bits[self._switch.address] = self._switch.off
        self._show_standby()

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

    def draw(self, block: int, count: int, t: float) -> None:
        self.dither = (self.dither + count) & 3

    def leap(self, until_s: float, now: float) -> None:
        while self.due_s <= until_s:
            self._cycle(now)
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
        self._show_standby()

    def _show_standby(self) -> None:
        switch = self._switch
        if switch is not None and switch.coil:
            self.bits[switch.address] = switch.off
        elif switch is not None:
            self.put(switch.address, switch.off.to_bytes(2, "big"))

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

    def _show(self) -> list[object]:
        """Return the counts of _SHOWN for one more reading."""
        self.dither = phase = (self.dither + 1) & 3
        pv, output, setpoint = self._scales
        counts = self.pv_c / pv
        if self._broken:
            counts = float(_PV_MOST)
        elif not self._floats[0]:
            counts = float(min(floor(counts + PATTERN[phase]), _PV_MOST))
        status = 0
        if self.limited:
            status = self._cold_bits if self.pv_c <= self._coldest_c else self._hot_bits
        if self._broken:
            status |= self._break_bits
        if self.lease_expired:
            status |= self._expired_bits
        wanted = (counts, self.output / output, self.setpoint_c / setpoint)
        shown: list[object] = [_count(one, self._floats[place]) for place, one in enumerate(wanted)]
        shown.append(status)
        return shown

    def _follow(self, asked_c: float, t: float) -> int:
        """Use a setpoint within the profile's range; return 0, or an exception code."""
        setpoint = self._setpoint
        taken_c = min(max(asked_c, setpoint.least), setpoint.greatest)
        if taken_c != asked_c and (self._refuses or not isfinite(asked_c)):
            return ILLEGAL_VALUE
        self.setpoint_c = taken_c
        self._renewed_s = t
        self.lease_expired = False
        if self._standby_c is not None:
            self.running = taken_c > self._standby_c
        return 0

    def wrote(self, address: int, count: int, t: float) -> None:
        """Use a setpoint of two registers."""
        setpoint = self._setpoint
        if setpoint.size == 2 and address <= setpoint.address and setpoint.address + 2 <= address + count:
            words = (self.get(setpoint.address), self.get(setpoint.address + 1))
            self._follow(setpoint.value(on_wire(words), self._order), t)

    def coil_written(self, address: int, value: int, t: float) -> int:
        """Accept run or standby as a coil."""
        switch = self._switch
        if switch is not None and switch.coil and address == switch.address:
            if value == switch.on:
                self.running = True
            else:
                self._stand_by()
        return 0

    def written(self, address: int, value: int, t: float) -> int:
        """Accept setpoint, run or standby, lease and the options of the set-up; nothing else can be written."""
        if address in self._read_only:
            return ILLEGAL_ADDRESS
        setpoint, lease, switch = self._setpoint, self._lease, self._switch
        if setpoint.size == 1 and address == setpoint.address:
            counts = value - 0x10000 if value > LIMITS[setpoint.type][1] else value
            return self._follow(counts * setpoint.scale, t)
        if setpoint.address <= address < setpoint.address + setpoint.size:
            return 0  # its second register completes it: wrote
        if lease is not None and address == lease.address:
            if not lease.least <= value * lease.scale <= lease.greatest:
                return ILLEGAL_VALUE
            self.lease_s = value * lease.scale
        elif switch is not None and address == switch.address and value == switch.on:
            self.running = True
        elif switch is not None and address == switch.address and value == switch.off:
            self._stand_by()
        elif (address, value) not in self._setup:
            return ILLEGAL_VALUE
        return 0


def _count(value: float, is_float: bool) -> object:
    """Return a count as its register holds it, whole or not."""
    if is_float:
        return value
    return round(value)


def _plant(profile: DeviceProfile) -> ControlledPlant:
    """Return the plant of a profile's controller. Raises ProfileError if it cannot be simulated."""
    plant = CONTROLLED.get(profile.kind)
    if plant is None:
        raise ProfileError(f"profile {profile.name} describes a {profile.kind}, not a temperature controller")
    shown = {signal.name for block in profile.blocks for signal in block.signals}
    if not set(_SHOWN[:3]) <= shown <= set(_SHOWN) or any(block.function in BIT_READS for block in profile.blocks):
        raise ProfileError(f"profile {profile.name}: the simulated controller shows {', '.join(_SHOWN)} in registers")
    return plant


def _registers(profile: DeviceProfile) -> list[tuple[int, int]]:
    """Return (address, count) of every register in use."""
    registers = [(block.address, block.count) for block in profile.blocks]
    registers += [(signal.address, signal.size) for signal in profile.writes.values()]
    registers += [(write.address, write.count) for write in profile.setup if write.read not in BIT_READS]
    registers += [(switch.address, 1) for switch in profile.switches.values() if not switch.coil]
    return registers if profile.identity is None else [*registers, (profile.identity.address, 1)]


def _kept(profile: DeviceProfile) -> set[int]:
    """Return the addresses of the switch and of the lease, if these are registers."""
    switch, lease = profile.switches.get("run"), profile.writes.get("lease")
    kept = {lease.address} if lease is not None else set[int]()
    if switch is not None and not switch.coil:
        kept.add(switch.address)
    return kept
