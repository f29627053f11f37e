"""The heat of a rig without its motion: control and interlocks as they are, and the plant's equations of heat.

The wheel rolls under load, with a burst of slip every minute once it is hot. Control scans five times a second, as
often as the sensors are read, so that an hour of heat takes two seconds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from random import Random

from sim.faults.sensors import spoiled
from sim.machines.wheel_on_belt.faults.heat import STICKS_EVERY_S
from sim.nodes.control_loop import CONTROLLED, JACKET_CYCLE_S, JACKET_HOTTEST_C, Pid
from sim.noise import NormalStream
from sim.physics.thermal import CALM_STEP_S, ThermalModel
from sim.sensors import TemperatureSensor
from tester.kinds.wheel_on_belt.control.loops import hub_needed_c
from tester.kinds.wheel_on_belt.control.permissives import rig_bounds
from tester.kinds.wheel_on_belt.control.step import WheelControl
from tester.kinds.wheel_on_belt.image.process_image import Demand, Press
from tester.kinds.wheel_on_belt.interlocks.heat_balance import FIRST, KnownRatio
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.run.past_runs import known_from
from tests.tester.kinds.wheel_on_belt.control.conftest import Bench, healthy_readings

SCAN_S = 0.2
LOAD_N, ROLLING_M_S, SLIP_M_S = 200.0, 0.8, 0.3
BURST_S, BURST_EVERY_S, MU = 4.0, 60.0, {"1#": 0.8, "2#": 1.0, "3#": 1.3}
"""Length and period of bursts, s, and a coefficient of each compound [A]."""
WITHIN_K = 2.0
"""A surface this near to its target counts as hot: bursts begin."""
AFTER_S = 60.0
"""Time after a trip during which the hub may still get hotter, s."""
SHORTED, STICKS = "relay shorted", "relay sticks"
STICKS_S = 3.0


@dataclass(frozen=True, slots=True)
class Lie:
    """The hub sensor's error (the thermometer's too if both lie alike), and the relay's fault.

    ``percent``: gain; ``k_min``: drift, K/min; each from ``at_s``, s. ``relay``: "" or a fault from ``relay_s`` on.
    """

    percent: float = 100.0
    k_min: float = 0.0
    at_s: float = 0.0
    common: bool = False
    relay: str = ""
    relay_s: float = inf


HONEST = Lie()


@dataclass(frozen=True, slots=True)
class Twin:
    """A rig that differs from its file: shares of the file's parameters, air in degC, and a seed."""

    compound: str
    air_c: float
    shares: dict[str, float]
    friction: float
    seed: int


@dataclass(frozen=True, slots=True)
class Heated:
    """The result of a heat: the hottest true hub and surface, degC, what tripped and when, s, and its heat ratio."""

    hub_c: float
    surface_c: float
    trip: str
    at_s: float
    ratio: float
    hot_s: float
    """When the surface was hot, s; infinite if it never was."""


class Kiln:
    """One heat to a surface temperature, and its rig."""

    def __init__(self, rig: RigConfig, twin: Twin, surface_c: float, known: KnownRatio | None = None) -> None:
        """``rig``: as in its file; ``known``: the history of its heatings."""
        self.twin, self.target_c = twin, surface_c - rig.loops.heat.rolling_offset_k
        bounds = rig_bounds(rig)
        control = WheelControl(rig, replace(bounds, hub_c=min(bounds.hub_c, hub_needed_c(rig, surface_c))))
        if known is not None:
            control.view.know_heat(known)
        r = healthy_readings()
        demand = Demand(enabled=True, wheel_speed_m_s=ROLLING_M_S, belt_speed_m_s=ROLLING_M_S)
        self.bench = Bench(control, r, demand)
        thermal = rig.sim.thermal
        off = {key: share * float(getattr(thermal, key)) for key, share in twin.shares.items()}
        self.power_w = off.pop("jacket_power")
        friction = twin.friction * rig.sim.friction_heat_fraction
        self.model = ThermalModel(rig.sim.wheel, replace(thermal, **off), friction, rig.sim.belt_conductance)
        self.state = self.model.state(twin.air_c)
        sensors, rng = rig.sim.sensors, Random(f"kiln {twin.seed}")
        self.hub = TemperatureSensor(sensors.hub_time, sensors.hub_rms, 0.0, NormalStream(twin.seed, "kiln hub"))
        bias_k = rng.uniform(-1.0, 1.0) * sensors.ir_bias
        self.ir = TemperatureSensor(sensors.ir_time, sensors.ir_rms, bias_k, NormalStream(twin.seed, "kiln surface"))
        for sensor in (self.hub, self.ir):
            sensor.reset(twin.air_c)
            sensor.retime(CALM_STEP_S)
        self.pid = Pid(CONTROLLED["jacket"])
        self.noise = NormalStream(twin.seed, "kiln")
        self.output = self.heater_w = self.cycle_s = 0.0
        self.begin()

    def begin(self) -> None:
        """Arm, and roll under load."""
        r, bench = self.bench.readings, self.bench
        r.wheel_speed_m_s = r.belt_speed_m_s = r.force_z_n = r.force_x_n = r.slip_m_s = 0.0
        r.hub_c = r.surface_c = self.twin.air_c
        r.heat_percent, r.contactor_closed = 0.0, False
        for stamp in ("wheel_at_s", "belt_at_s", "jacket_at_s", "surface_at_s", "cell_at_s", "surface_changed_s",
                      "inputs_at_s", "can_heard_s"):  # fmt: skip
            setattr(r, stamp, r.now_s)
        refused = bench.control.start(r)
        assert not refused, refused
        r.wheel_speed_m_s = r.belt_speed_m_s = ROLLING_M_S
        r.force_z_n = LOAD_N
        bench.demand.press, bench.demand.load_n = Press.LOAD, LOAD_N

    def heat(self, lie: Lie, until_s: float) -> Heated:
        """Heat until a trip, or for so long; return the result."""
        bench, state = self.bench, self.state
        bench.demand.surface_c = self.target_c
        balance = bench.control.view.heat
        most_c = surface_c = -inf
        ratio, hot_s, now, tripped_s = 1.0, inf, 0.0, inf
        while now < until_s and now < tripped_s + AFTER_S:
            now += SCAN_S
            hot = now > hot_s
            burst = hot and (now - hot_s) % BURST_EVERY_S < BURST_S
            self._plant(lie, now, burst)
            most_c, surface_c = max(most_c, state.hub_c), max(surface_c, state.surface_c)
            if tripped_s < inf:
                continue
            self._read(lie, now, burst)
            bench.scan(SCAN_S)
            if bench.state.trip is not None:
                tripped_s = now
            if not hot and bench.readings.surface_c > self.target_c - WITHIN_K:
                hot_s = now
                ratio = balance.put_j / balance.shown_j if balance.shown_j > 0.0 else 1.0
        trip = bench.state.trip
        return Heated(most_c, surface_c, trip.name if trip else "", tripped_s, ratio, hot_s)

    def _plant(self, lie: Lie, now: float, burst: bool) -> None:
        out, r = self.bench.state.setpoints, self.bench.readings
        while self.cycle_s < now:
            at_s, self.cycle_s = self.cycle_s, self.cycle_s + JACKET_CYCLE_S
            shown_c = self._shown(self.hub.measure(), lie, at_s)
            if out.heat and shown_c < JACKET_HOTTEST_C:
                self.output = self.pid.step(out.hub_c, shown_c, JACKET_CYCLE_S)
            else:
                self.pid.reset()
                self.output = 0.0
        element = self.output
        since_s = now - lie.relay_s if lie.relay else -1.0
        if since_s >= 0.0 and (lie.relay == SHORTED or since_s % STICKS_EVERY_S < STICKS_S):
            element = 100.0
        self.heater_w = 0.01 * element * self.power_w if out.contactor else 0.0
        r.contactor_closed = out.contactor
        friction_w = MU[self.twin.compound] * LOAD_N * SLIP_M_S if burst else 0.0
        for _ in range(round(SCAN_S / CALM_STEP_S)):
            self.model.calm_step(self.state, self.heater_w, friction_w, self.twin.air_c, True, True)
            self.hub.follow(self.state.hub_c)
            self.ir.follow(self.state.surface_c)

    def _read(self, lie: Lie, now: float, burst: bool) -> None:
        r, demand = self.bench.readings, self.bench.demand
        r.hub_c = round(self._shown(self.hub.measure(), lie, now), 1)
        seen_c = self.ir.measure()
        r.surface_c = round(self._shown(seen_c, lie, now) if lie.common else seen_c, 1)
        r.heat_percent = round(self.output, 1)
        slip = SLIP_M_S if burst else 0.0
        r.slip_m_s, r.belt_speed_m_s = slip, ROLLING_M_S - slip
        r.force_x_n = MU[self.twin.compound] * LOAD_N if burst else 0.0
        demand.belt_speed_m_s, demand.freeze_heat = r.belt_speed_m_s, burst

    def _shown(self, true_c: float, lie: Lie, now: float) -> float:
        if now < lie.at_s:
            return true_c
        if lie.k_min:
            return spoiled("drift", true_c, lie.k_min / 60.0, now - lie.at_s, self.noise, self.twin.air_c)
        return spoiled("gain", true_c, lie.percent, now - lie.at_s, self.noise, self.twin.air_c)


def history(rig: RigConfig, ratio: float) -> KnownRatio:
    """Return a rig's knowledge after three heatings with this ratio of heat put in to heat shown."""
    return known_from(FIRST * [ratio], rig)
