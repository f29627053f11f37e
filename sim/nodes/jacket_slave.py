"""The simulated temperature controller of the heating jacket."""

from __future__ import annotations

from math import floor, inf, isfinite
from typing import Final, Protocol

from drivers.profiles.model import LIMITS, DeviceProfile, ProfileError
from sim.nodes.dither import PATTERN
from sim.nodes.modbus_slave import ILLEGAL_ADDRESS, ILLEGAL_VALUE, ModbusSlave
from sim.nodes.pid import Pid

CYCLE_S: Final = 0.125
"""Time between two runs of the controller's loop [A]."""
POWER_W: Final = 200.0
"""Heat of the jacket at 100 % [A]."""
SETPOINT_MAX_C: Final = 150.0
"""The controller takes no setpoint above this [A]."""
LIMIT_C: Final = 155.0
"""The controller's own limiter: from here on no heat until it has been in standby below LIMIT_RESET_C [A]."""
LIMIT_RESET_C: Final = 145.0
_SHOWN: Final = ("pv", "output", "setpoint", "status")
_PV_MOST: Final = LIMITS["i16"][1]
"""What the temperature register shows when the sensor is broken."""


class HubSource(Protocol):
    """What the controller's sensor measures."""

    def hub_measured_c(self, t: float) -> float:
        """Return the hub temperature in degC at ``t`` s; NaN when the sensor is broken."""
        ...


class HeaterSink(Protocol):
    """What takes the controller's heat."""

    heater_w: float


class JacketSlave(ModbusSlave):
    """A controller with a PID of its own, driven by ``advance``; what it measures is sampled once in each cycle.

    ``heater_w`` is its heat before the contactor in the supply, also given to ``sink``. ``running``, ``setpoint_c``,
    ``lease_s`` (0 = off), ``lease_expired``, ``limited`` and ``sensor_broken`` tell its state; setting
    ``sensor_broken`` or ``stuck_output`` (in %) makes it faulty; ``stuck_element`` (in %) is the heat that flows
    whatever the output says: a shorted relay, or an open line.
    """

    def __init__(
        self,
        profile: DeviceProfile,
        unit_id: int,
        source: HubSource,
        sink: HeaterSink | None = None,
        *,
        power_w: float = POWER_W,
        setpoint_max_c: float = SETPOINT_MAX_C,
        limit_c: float = LIMIT_C,
        cycle_s: float = CYCLE_S,
    ) -> None:
        """Put the registers where ``profile`` has them. Raises ProfileError unless it can be simulated."""
        _check(profile)
        super().__init__(unit_id, profile.timing.turnaround_s, _registers(profile), profile.functions)
        self._read_only = frozenset(
            address for block in profile.blocks for address in range(block.address, block.address + block.count)
        )
        self._blocks = tuple(
            (block, tuple(_SHOWN.index(signal.name) for signal in block.signals)) for block in profile.blocks
        )
        self.blocks = {(block.address, block.count): number for number, block in enumerate(profile.blocks)}
        self._scales = tuple(profile.signal(name).scale for name in ("pv", "output", "setpoint"))
        self._alarm_bits = profile.bit("alarm_1")
        self._break_bits = profile.bit("sensor_break") | profile.bit("over_range")
        self._remote_bits = profile.bit("remote_fail")
        self._setpoint = profile.writes["setpoint"]
        self._lease = profile.writes.get("lease")
        self._falls_back_s = profile.falls_back_s
        self._switch = profile.switches["run"]
        self._setup = frozenset((write.address, write.value) for write in profile.setup)
        kept = {self._switch.address, *(write.address for write in profile.setup)}
        if self._lease is not None:
            kept.add(self._lease.address)
        self.stored = frozenset(kept)
        self.put(self._switch.address, self._switch.off.to_bytes(2, "big"))
        self.source = source
        self.sink = sink
        self.power_w = power_w
        self.setpoint_max_c = setpoint_max_c
        self.limit_c = limit_c
        self.cycle_s = cycle_s
        self.pid = Pid()
        self.due_s = -inf
        self.pv_c = 0.0
        self.heater_w = 0.0
        self.running = False
        self.setpoint_c = 0.0
        self.lease_s = 0.0
        self.lease_expired = False
        self.limited = False
        self.sensor_broken = False
        self.output = 0.0
        self.stuck_output: float | None = None
        self.stuck_element: float | None = None
        self._broken = False
        self._renewed_s = -inf
        self.dither = 0

    # the controller --------------------------------------------------------------------------------------------

    def advance(self, t0: float, t1: float) -> None:
        """Live from ``t0`` to ``t1`` s: run every cycle that falls due."""
        if t1 < self.due_s:
            return
        if self.due_s == -inf:
            self.due_s = t0
        while self.due_s <= t1:
            self._cycle(self.due_s)
            self.due_s += self.cycle_s

    def power(self, on: bool) -> None:
        """Switch the supply. Without it the controller is silent and gives no heat; it starts in standby."""
        self.powered = on
        self._stand_by()
        self.setpoint_c = 0.0
        self.lease_expired = False
        self._heat(0.0)

    def _cycle(self, t: float) -> None:
        if not self.powered:
            return
        pv_c = self.source.hub_measured_c(t)
        self._broken = broken = self.sensor_broken or not isfinite(pv_c)
        if self.lease_s > 0.0 and self.running and t > self._renewed_s + self.lease_s:
            self.lease_expired = True
            self._stand_by()
        if self._falls_back_s is not None and self.running and t > self._renewed_s + self._falls_back_s:
            # Its own setpoint, which the set-up has made one of no heat, until the next comes.
            self.lease_expired = True
            self.setpoint_c = 0.0
        if not broken:
            self.pv_c = pv_c
            if pv_c >= self.limit_c:
                self.limited = True
            elif self.limited and not self.running and pv_c < LIMIT_RESET_C:
                self.limited = False
        may_heat = self.running and not broken and not self.limited and not self.lease_expired
        if may_heat:
            output = self.pid.step(self.setpoint_c, pv_c, self.cycle_s)
        else:
            self.pid.reset()
            output = 0.0
        self._heat(output if self.stuck_output is None else self.stuck_output)

    def _stand_by(self) -> None:
        self.running = False
        self.pid.reset()
        self.put(self._switch.address, self._switch.off.to_bytes(2, "big"))

    def _heat(self, output: float) -> None:
        self.output = output
        element = output if self.stuck_element is None else self.stuck_element
        self.heater_w = 0.01 * element * self.power_w
        if self.sink is not None:
            self.sink.heater_w = self.heater_w

    # its registers ---------------------------------------------------------------------------------------------

    def refresh(self, t: float) -> None:
        """Show the state of the last cycle."""
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
        status = self._alarm_bits if self.limited else 0
        if self._broken:
            status |= self._break_bits
        if self.lease_expired:
            status |= self._remote_bits
        return (
            _PV_MOST if self._broken else min(floor(self.pv_c / pv + PATTERN[phase]), _PV_MOST),
            round(self.output / output),
            round(self.setpoint_c / setpoint),
            status,
        )

    def written(self, address: int, value: int, t: float) -> int:
        """Take setpoint, run or standby, off-line time and the options of the set-up; nothing else can be written."""
        if address in self._read_only:
            return ILLEGAL_ADDRESS
        lease, switch = self._lease, self._switch
        if address == self._setpoint.address:
            counts = value - 0x10000 if value > LIMITS[self._setpoint.type][1] else value
            self.setpoint_c = min(max(counts * self._setpoint.scale, 0.0), self.setpoint_max_c)
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


def _check(profile: DeviceProfile) -> None:
    """Raise ProfileError for a profile that the simulated controller cannot follow."""
    profile.expect("jacket")
    shown = [signal for block in profile.blocks for signal in block.signals]
    if any(signal.size != 1 for signal in (*profile.writes.values(), *shown)):
        raise ProfileError(f"profile {profile.name}: the simulated controller has registers of 16 bits only")
    if {signal.name for signal in shown} != set(_SHOWN) or profile.identity is not None:
        raise ProfileError(f"profile {profile.name}: the simulated controller shows {', '.join(_SHOWN)}, and no type")


def _registers(profile: DeviceProfile) -> list[tuple[int, int]]:
    """Return (address, count) of every register in use."""
    registers = [(block.address, block.count) for block in profile.blocks]
    registers += [(write.address, 1) for write in profile.writes.values()]
    registers += [(write.address, 1) for write in profile.setup]
    return [*registers, (profile.switches["run"].address, 1)]
