"""Random commands, faults and time over control with a small plant behind it; the invariants hold after every scan."""

from __future__ import annotations

from math import isfinite, nan

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.interlocks.table import TABLE
from tester.machine.state import Mode
from tests.tester.kinds.wheel_on_belt.control.conftest import Bench, make_bench

RIG = load_rig("sim")
DT = 0.02
FAULTS: dict[str, tuple[str, object]] = {
    "guard": ("guard_closed", False),
    "chain": ("safety_chain", False),
    "drive": ("drive_fault", "belt drive: fault"),
    "cell": ("cell_valid", False),
    "surface": ("surface_valid", False),
    "jacket": ("jacket_valid", False),
    "bus": ("bus_fault", "bus lost"),
    "force": ("force_z_n", nan),
    "wheel": ("wheel_speed_m_s", nan),
    "device": ("device_fault", "jacket: exception 2"),
}
REST = frozenset({Mode.IDLE, Mode.LATCHED})
MOVING = frozenset({Mode.RUN, Mode.HOLD})


class Rig(RuleBasedStateMachine):
    """Drives follow their setpoints on ramps, the press lifts and lands, the heater answers; faults lie about it."""

    def __init__(self) -> None:
        super().__init__()
        self.bench: Bench = make_bench(RIG)
        self.faults: set[str] = set()
        self.wheel, self.belt, self.press = 0.8, 0.5, 11.8
        self.tripped_s = nan
        self.bench.control.view.observer.due_s = float("inf")
        self.bench.control.view.observer.surface_c = 40.0

    # -- the plant ------------------------------------------------------------------------------------------

    def scan(self) -> None:
        out, r, d = self.bench.state.setpoints, self.bench.readings, self.bench.demand
        powered = out.enable or (out.quick_stop and (self.wheel > 0.0 or self.belt > 0.0))
        ramp = (5.0 if out.quick_stop else 2.0) * DT
        targets = (out.wheel_rad_s * 0.045, out.belt_m_s) if powered and not out.power_off else (0.0, 0.0)
        self.wheel += min(max(targets[0] - self.wheel, -ramp), ramp)
        self.belt += min(max(targets[1] - self.belt, -ramp), ramp)
        speed = out.press_mm_s if out.enable and not out.power_off else -20.0
        self.press = min(max(self.press + speed * DT, 0.0), 11.8)
        force = 200.0 if self.press > 10.5 and d.press is Press.LOAD else 0.0 if self.press < 11.0 else 200.0
        r.wheel_speed_m_s, r.belt_speed_m_s, r.press_mm = self.wheel, self.belt, self.press
        r.slip_m_s, r.force_z_n = abs(self.wheel - self.belt), force
        r.force_x_n = 0.7 * force if r.slip_m_s > 0.01 else 0.0
        r.drives_enabled, r.drives_disabled = powered, not powered
        r.heat_percent, r.contactor_closed = (20.0, True) if out.heat else (0.0, out.contactor)
        r.cell_valid = r.surface_valid = r.jacket_valid = r.safety_chain = r.guard_closed = True
        r.drive_fault = r.bus_fault = r.device_fault = ""
        for fault in self.faults:
            field, value = FAULTS[fault]
            setattr(r, field, value)
        before = self.bench.state.mode
        self.bench.scan(DT)
        if before in MOVING and self.bench.state.mode not in MOVING:
            self.tripped_s = r.now_s

    # -- what happens -----------------------------------------------------------------------------------------

    @initialize()
    def settle(self) -> None:
        for _ in range(5):
            self.scan()

    @rule(scans=st.integers(1, 40))
    def time(self, scans: int) -> None:
        for _ in range(scans):
            self.scan()

    @rule(fault=st.sampled_from(sorted(FAULTS)))
    def fault(self, fault: str) -> None:
        self.faults.add(fault)
        self.scan()

    @precondition(lambda self: bool(self.faults))
    @rule()
    def repair(self) -> None:
        self.faults.clear()
        self.scan()

    @rule(fast=st.booleans())
    def stop(self, fast: bool) -> None:
        self.bench.control.request_stop(self.bench.readings.now_s, "test", fast=fast)
        self.scan()

    @rule()
    def hold(self) -> None:
        self.bench.control.request_hold(self.bench.demand, self.bench.readings.now_s, "test")
        self.scan()

    @rule()
    def release(self) -> None:
        self.bench.demand.press, self.bench.demand.belt_speed_m_s = Press.LIFT, self.bench.demand.wheel_speed_m_s
        self.bench.control.request_release(self.bench.readings.now_s, "test")
        self.scan()

    @rule()
    def acknowledge(self) -> None:
        held = self.bench.state.held & ~TABLE.warnings
        latched = self.bench.state.mode is Mode.LATCHED
        self.bench.control.request_ack(self.bench.readings.now_s)
        self.scan()
        if latched and held and self.faults:
            assert self.bench.state.mode is Mode.LATCHED

    @rule()
    def arm(self) -> None:
        mode = self.bench.state.mode
        refused = self.bench.control.start(self.bench.readings)
        assert refused or mode is Mode.IDLE
        if not refused:
            self.bench.demand.press = Press.LIFT
        self.scan()

    @rule(speed=st.sampled_from([0.0, 0.5, 0.8, nan, 1e9, -3.0]), load=st.sampled_from([0.0, 200.0, nan, 1e9]))
    def demand(self, speed: float, load: float) -> None:
        self.bench.demand.belt_speed_m_s, self.bench.demand.load_n = speed, load
        self.scan()

    # -- what always holds ------------------------------------------------------------------------------------

    @invariant()
    def heat_only_turning_in_run_or_hold_with_fresh_temperatures(self) -> None:  # I1
        out, r = self.bench.state.setpoints, self.bench.readings
        if out.heat:
            assert self.bench.state.mode in MOVING
            assert r.wheel_speed_m_s > 0.02 and r.jacket_valid and r.surface_valid

    @invariant()
    def the_press_approaches_only_with_both_speeds_confirmed(self) -> None:  # I2
        out, r = self.bench.state.setpoints, self.bench.readings
        if out.press_mm_s > 0.0 and self.bench.demand.press is Press.LOAD and self.bench.state.mode is Mode.RUN:
            assert r.wheel_speed_m_s > 0.02 and r.belt_speed_m_s > 0.02 and r.cell_valid

    @invariant()
    def a_trip_has_safe_outputs_until_it_is_acknowledged(self) -> None:  # I3
        out = self.bench.state.setpoints
        if self.bench.state.trip is not None:
            assert self.bench.state.mode not in MOVING
            assert not out.heat and not out.contactor and out.press_mm_s <= 0.5

    @invariant()
    def a_rig_that_left_run_is_safe_after_three_seconds(self) -> None:  # I5
        if self.bench.state.mode in MOVING or not self.bench.readings.now_s - self.tripped_s > 3.0:
            return
        if self.bench.state.mode is not Mode.COOLDOWN:
            assert abs(self.wheel) < 0.01 and abs(self.belt) < 0.01
        assert self.press < 10.5

    @invariant()
    def nothing_is_commanded_at_rest(self) -> None:  # I6
        out = self.bench.state.setpoints
        if self.bench.state.mode in REST:
            assert not out.enable and (out.wheel_rad_s, out.belt_m_s, out.press_mm_s) == (0.0, 0.0, 0.0)

    @invariant()
    def outputs_are_numbers_within_limits(self) -> None:  # I10
        out, limits = self.bench.state.setpoints, RIG.limits
        values = (out.wheel_rad_s, out.belt_m_s, out.press_mm_s, out.hub_c, *out.positions.values())
        assert all(isfinite(value) for value in values)
        assert abs(out.wheel_rad_s) * 0.045 <= limits.wheel_speed_m_s + 1e-9
        assert abs(out.belt_m_s) <= limits.belt_speed_m_s and out.hub_c <= limits.jacket_c


TestRig = Rig.TestCase
TestRig.settings = settings(max_examples=60, stateful_step_count=30, deadline=None, derandomize=True)
