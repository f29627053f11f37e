"""Every row of the interlock table: its cause, or an unknown input, trips it at its delay and not before."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.interlocks.contact_force import depth_mm
from tester.kinds.wheel_on_belt.interlocks.table import TABLE
from tester.machine.row import Reaction
from tester.machine.state import Mode
from tests.tester.kinds.wheel_on_belt.control.conftest import STAMPS, Bench

NAN = math.nan
Break = Callable[[Bench], None]


def _set(**values: object) -> Break:
    def apply(bench: Bench) -> None:
        for name, value in values.items():
            setattr(bench.readings, name, value)

    return apply


def _stale(*stamps: str) -> Break:
    def apply(bench: Bench) -> None:
        bench.stale.update(stamps)

    return apply


def _rolling(bench: Bench) -> None:
    """Remove the slip, so that only the load matters."""
    bench.readings.slip_m_s = bench.readings.force_x_n = 0.0


def _hub(hub_c: float) -> Break:
    """Bring the hub to a temperature without a jump."""

    def apply(bench: Bench) -> None:
        bench.control.view.jacket.forget(bench.readings.now_s)
        bench.readings.hub_c = hub_c

    return apply


def _model(offset_k: float) -> Break:
    """Hold the model this far off the surface."""

    def apply(bench: Bench) -> None:
        observer = bench.control.view.observer
        observer.due_s = math.inf
        observer.surface_c = bench.readings.surface_c + offset_k
        bench.control.view.surface.model_c = observer.surface_c

    return apply


def _frozen_thermometer(bench: Bench) -> None:
    bench.stale.add("surface_changed_s")
    bench.control.view.observer.due_s = math.inf
    bench.control.view.observer.surface_c += 1.5


def _stuck(bench: Bench) -> None:
    """No output for long, and the hub rises."""
    bench.demand.surface_c = NAN
    bench.readings.heat_percent = 0.0
    bench.readings.contactor_closed = False
    bench.scans(7.5)
    old_s, old_c, new_s, new_c = bench.control.view.jacket.marks
    bench.control.view.jacket.marks = (old_s, old_c - 2.0, new_s, new_c - 2.0)


def _line_open(bench: Bench) -> None:
    """Full output, hub well below its setpoint, no rise: until a moment before the trip."""
    bench.readings.heat_percent = 100.0
    _hub(40.0)(bench)
    bench.demand.freeze_heat = True
    bench.state.setpoints.hub_c = 60.0
    bench.scans(bench.control.rig.interlocks.open_s - 0.02)


def _hidden_heat(bench: Bench) -> None:
    """The heater gives a power that no reading shows, then one that readings show."""
    heat = bench.control.view.heat
    heat.unseen_k, heat.put_w = 5.2, heat.shown_w


def _lacking(off_k: float) -> Break:
    """Let heat be missing by nine tenths of its allowance, and the model be this far off the surface."""

    def apply(bench: Bench) -> None:
        heat = bench.control.view.heat
        heat.lack_j, heat.may_lack_j, heat.shown_w = 90e3, 100e3, heat.put_w
        _model(off_k)(bench)

    return apply


def _ungiven_heat(bench: Bench) -> None:
    """The readings show more heat than the heater gives."""
    bench.control.view.heat.ungiven_k = 9.0


def _frozen_hub(bench: Bench) -> None:
    """The hub's reading stays constant although the heater gives more."""
    bench.control.view.heat.still_k = 31.0


def _sprung(off_share: float) -> Break:
    """The press's torque differed from its spring's, in free travel."""

    def apply(bench: Bench) -> None:
        bench.control.view.free.off_share = off_share

    return apply


def _torn(bench: Bench) -> None:
    bench.readings.force_x_n = bench.readings.drive_torque_nm = 0.0


def _touched(press_mm: float) -> Break:
    """Set the touch of the wheel to this position."""

    def apply(bench: Bench) -> None:
        bench.state.load.contact_mm = press_mm

    return apply


def _dropped(bench: Bench) -> None:
    bench.readings.drives_enabled = False


def _stepped(by_n: float) -> Break:
    """Change the force without the press."""

    def apply(bench: Bench) -> None:
        bench.readings.force_z_n += by_n

    return apply


def _shafts(by_w: float) -> Break:
    """Let the shafts take this much more than friction and slip."""

    def apply(bench: Bench) -> None:
        bench.shafts = False
        bench.readings.drive_torque_nm += by_w / bench.readings.wheel_rad_s

    return apply


def _belt_pulls(torque_nm: float) -> Break:
    """Let the belt's drive pull with this where it should brake."""

    def apply(bench: Bench) -> None:
        bench.shafts = False
        bench.readings.belt_torque_nm = torque_nm

    return apply


def _screwed(force_n: float) -> Break:
    """Let the press's drive show the torque for another force, its screw in the middle of its friction."""

    def apply(bench: Bench) -> None:
        screw = bench.control.rig.axes.press.screw
        assert screw is not None
        bench.screws = False
        bench.readings.press_torque_nm = screw.lead_mm / (2000.0 * math.pi) * (force_n + screw.spring_n)

    return apply


CAUSES: dict[str, list[Break]] = {
    "safety chain": [_set(safety_chain=False)],
    "CAN silent": [_stale("can_heard_s")],
    "drive fault": [_set(drive_fault="wheel drive: heartbeat lost")],
    "bus lost": [_set(bus_fault="bus lost: unplugged")],
    "second master": [_set(foreign_master="NMT 000#0100")],
    "guard open": [_set(guard_closed=False)],
    "drive data stale": [_stale(stamp) for stamp in STAMPS[:4]],
    "inputs stale": [_stale("inputs_at_s")],
    "drive dropped out": [_dropped],
    "overspeed": [_set(wheel_speed_m_s=1.3), _set(belt_speed_m_s=-1.5), _set(wheel_speed_m_s=NAN)],
    "wheel speed": [_set(wheel_speed_m_s=0.7), _set(wheel_speed_m_s=0.9), _set(wheel_speed_m_s=NAN)],
    "belt speed": [_set(belt_speed_m_s=0.4), _set(belt_speed_m_s=0.6), _set(belt_speed_m_s=NAN)],
    "press speed": [_set(press_mm=12.2), _set(press_mm=NAN)],
    "press travel": [_set(press_mm=20.1), _set(press_mm=-1.1), _set(press_mm=NAN)],
    "drive standing under load": [_set(belt_speed_m_s=0.0), _set(wheel_speed_m_s=0.0), _set(belt_speed_m_s=NAN)],
    "belt torn": [_torn],
    "load cell silent": [_stale("cell_at_s"), _set(cell_silent=True, cell_valid=False)],
    "load cell saturated": [_set(cell_valid=False)],
    "load cell frozen": [_stale("cell_changed_s")],
    "overload": [_set(force_z_n=451.0), _set(force_z_n=NAN)],
    "load overshoot": [_set(force_z_n=231.0), _set(force_z_n=NAN)],
    "contact too deep": [_touched(11.8 - 2.6), _set(press_mm=NAN)],
    "contact lost": [_set(force_z_n=15.0), _set(force_z_n=NAN)],
    "force step": [_stepped(30.0), _stepped(-30.0), _set(press_mm=NAN)],
    "press torque": [_screwed(450.0), _screwed(80.0), _screwed(NAN)],
    "press spring": [_sprung(0.06), _sprung(NAN)],
    "friction sign": [_set(force_x_n=-30.0), _set(force_x_n=NAN)],
    "shaft power": [_shafts(60.0), _shafts(-60.0), _shafts(NAN)],
    "belt caught": [_belt_pulls(44.0), _belt_pulls(NAN)],
    "belt torque": [_belt_pulls(-3.0), _belt_pulls(9.0)],
    "friction beyond load": [_set(force_y_n=640.0, slip_m_s=0.0), _set(force_y_n=NAN)],
    "slip power": [_set(force_x_n=1200.0), _set(slip_m_s=NAN), _set(force_y_n=NAN)],
    "surface hot": [_set(surface_c=95.5), _set(surface_c=NAN)],
    "jacket hot": [_hub(153.5), _hub(NAN)],
    "jacket runaway": [_hub(120.0), _hub(NAN)],
    "heater stuck": [_stuck],
    "heater line open": [_line_open],
    "heating at standstill": [_set(wheel_speed_m_s=0.0), _set(wheel_speed_m_s=NAN)],
    "hub sensor jump": [_set(hub_c=56.0), _set(hub_c=44.0)],
    "surface sensor jump": [_set(surface_c=46.0), _set(surface_c=34.0)],
    "thermometer frozen": [_frozen_thermometer],
    "surface off model": [_model(8.5), _model(-8.5), _model(NAN)],
    "heat not shown": [_hidden_heat],
    "hub hotter than shown": [_model(6.5), _model(-6.5), _lacking(3.5)],
    "heat not given": [_ungiven_heat],
    "hub sensor frozen": [_frozen_hub],
    "thermometer silent": [_stale("surface_at_s"), _set(surface_silent=True, surface_valid=False)],
    "surface not valid": [_set(surface_valid=False)],
    "jacket silent": [_stale("jacket_at_s"), _set(jacket_silent=True, jacket_valid=False)],
    "hub sensor broken": [_set(jacket_valid=False)],
    "device refused": [_set(device_fault="jacket: exception 2")],
    "line noisy": [_set(line_errors=0.5), _set(line_errors=NAN)],
    "wheel worn": [_set(cold_mm=77.9), _set(cold_mm=NAN)],
}
"""Causes by the row they belong to. Rows of a stop, of rest, of the scan and of the contactor have their own tests."""

OWN_TESTS = {
    "clock jump", "scan late", "scan delayed", "not lifted", "lift failed", "not stopping", "quick stop failed",
    "heat not off", "output not off", "stop not ended", "contactor welded", "moving at rest", "loaded at rest",
    "wheel frozen",
}  # fmt: skip

AGES = {
    "CAN silent": 0.025, "inputs stale": 0.25, "load cell silent": 0.05, "load cell frozen": 0.5,
    "thermometer silent": 1.0, "jacket silent": 1.0,
}  # fmt: skip
"""What an age adds to the delay, s."""

CASES = [(name, i) for name, causes in CAUSES.items() for i in range(len(causes))]


def index_of(name: str) -> int:
    return TABLE.bit(name).bit_length() - 1


def test_every_row_of_the_table_has_a_test_here() -> None:
    assert {row.name for row in TABLE.rows} == set(CAUSES) | OWN_TESTS


def test_names_are_unique_and_every_row_is_complete() -> None:
    assert len({row.name for row in TABLE.rows}) == len(TABLE.rows)
    assert all(row.cause and row.watch.level and row.reset for row in TABLE.rows)


def test_the_healthy_rig_runs_for_a_minute_without_a_level(bench: Bench) -> None:
    for _ in range(6000):
        bench.scan()
        assert bench.state.held == 0
    assert bench.state.trip is None and bench.state.mode is Mode.RUN


QUICKER = {
    ("overspeed", 2): "drive standing under load", ("wheel speed", 2): "drive standing under load",
    ("belt speed", 2): "drive standing under load", ("press travel", 0): "press speed",
    ("press travel", 2): "press speed", ("overload", 1): "load cell frozen", ("load overshoot", 0): "force step",
    ("load overshoot", 1): "load cell frozen", ("contact too deep", 1): "press speed",
    ("contact lost", 0): "load cell frozen", ("contact lost", 1): "load cell frozen",
    ("slip power", 2): "belt caught",
    ("force step", 2): "press speed", ("friction sign", 1): "belt caught", ("friction beyond load", 1): "belt caught",
    ("surface hot", 0): "surface sensor jump", ("surface hot", 1): "surface sensor jump",
    ("jacket runaway", 1): "jacket hot", ("heating at standstill", 0): "drive standing under load",
    ("heating at standstill", 1): "drive standing under load", ("surface off model", 2): "thermometer frozen",
    ("surface off model", 0): "hub hotter than shown", ("surface off model", 1): "hub hotter than shown",
}  # fmt: skip
"""A cause may raise several levels: for these another row trips first."""


@pytest.mark.parametrize(("name", "number"), CASES)
def test_a_cause_raises_its_level_and_something_trips_within_the_rows_delay(
    bench: Bench, name: str, number: int
) -> None:
    CAUSES[name][number](bench)
    began = bench.readings.now_s
    delay = TABLE.rows[index_of(name)].delay_s(bench.control.view.parameters) + AGES.get(name, 0.0)
    seen = 0
    while bench.state.trip is None and bench.readings.now_s - began < delay + 0.1:
        bench.scan()
        seen |= bench.state.held
    trip = bench.state.trip
    assert trip is not None and trip.at_s - began <= delay + 0.0401
    assert seen & TABLE.bit(name)
    assert trip.name == QUICKER.get((name, number), name)


def at_little_load(bench: Bench, load_n: float, friction_n: float, torque_nm: float) -> float:
    """Press with little load and return the seconds until something trips, in a second."""
    stiffness = bench.control.rig.loops.load.stiffness_n_per_mm
    r, bench.demand.load_n = bench.readings, load_n
    bench.shafts = False
    r.press_mm += depth_mm(load_n, stiffness) - depth_mm(r.force_z_n, stiffness)
    r.force_x_n, r.force_z_n, r.drive_torque_nm = friction_n, load_n, torque_nm
    r.belt_torque_nm = -0.05 * friction_n
    return bench.until_trip(1.0)


@pytest.mark.parametrize("torque_nm", [0.21, -0.21, NAN])
def test_bearings_and_seals_of_the_wheel_do_not_hide_a_torn_belt_at_little_load(
    bench: Bench, torque_nm: float
) -> None:
    """0.21 N m are 5 % of 93 N at 45 mm."""
    assert at_little_load(bench, 50.0, 0.0, torque_nm) < math.inf
    assert bench.state.trip is not None and bench.state.trip.name == "belt torn"


@pytest.mark.parametrize(("friction_n", "torque_nm"), [(20.0, 0.0), (0.0, 0.9)])
def test_friction_that_cell_or_drive_shows_at_little_load_is_a_whole_belt(
    bench: Bench, friction_n: float, torque_nm: float
) -> None:
    assert at_little_load(bench, 50.0, friction_n, torque_nm) == math.inf


NO_NUMBER = {
    "safety chain", "drive fault", "bus lost", "second master", "guard open", "drive dropped out",
    "load cell saturated", "device refused", "contactor welded",
}  # fmt: skip
"""Rows that look at a state, not at a number."""
AT_LEAST = {"drive standing under load", "belt torn", "contact lost", "heater line open", "wheel worn", "clock jump"}
"""Rows whose value has to be above its limit; of the others, below."""
MEASURED_LIMIT = {"press torque"}
"""Rows whose limit follows from a reading, which may be unknown."""
BOTH_WAYS = {"wheel speed", "belt speed", "press travel", "press torque"}


@pytest.mark.parametrize(("name", "number"), CASES)
def test_a_trip_names_the_value_that_is_beyond_its_limit(bench: Bench, name: str, number: int) -> None:
    CAUSES[name][number](bench)
    bench.until_trip(40.0)
    trip = bench.state.trip
    assert trip is not None
    value, limit, unit = trip.compared.value, trip.compared.limit, trip.compared.unit
    if trip.name in NO_NUMBER:
        assert math.isnan(value) and math.isnan(limit) and unit == ""
        return
    assert (unit and not math.isnan(limit)) or math.isnan(value) or trip.name in MEASURED_LIMIT
    assert trip.name in BOTH_WAYS or not (value >= limit if trip.name in AT_LEAST else value <= limit)


@pytest.mark.parametrize("name", sorted(set(CAUSES) - {"drive data stale", "hub sensor jump", "surface sensor jump"}))
def test_a_row_does_not_trip_before_its_delay(bench: Bench, name: str) -> None:
    if name in ("overload", "load overshoot", "contact lost", "force step"):
        _rolling(bench)
    delay = TABLE.rows[index_of(name)].delay_s(bench.control.view.parameters) + AGES.get(name, 0.0)
    CAUSES[name][0](bench)
    began = bench.readings.now_s
    while bench.readings.now_s - began < delay - 0.0151:
        bench.scan()
        if bench.state.trip is not None:
            assert bench.state.trip.name != name


@pytest.mark.parametrize("name", sorted(CAUSES))
def test_a_trip_makes_the_outputs_safe_in_the_same_scan(bench: Bench, name: str) -> None:
    CAUSES[name][0](bench)
    out = bench.scan()
    for _ in range(4000):
        if bench.state.trip is not None:
            break
        out = bench.scan()
    trip = bench.state.trip
    assert trip is not None
    assert not out.heat and not out.contactor and out.press_mm_s <= 0.0
    assert out.wheel_rad_s == 0.0 or bench.state.mode is Mode.STOPPING
    assert out.quick_stop is (trip.reaction is not Reaction.CONTROLLED)


@pytest.mark.parametrize("name", sorted(set(CAUSES) - {"hub sensor jump", "surface sensor jump", "load cell frozen"}))
def test_an_acknowledgement_with_the_cause_still_there_is_refused(bench: Bench, name: str) -> None:
    """Rows of the load and of speeds are no longer active once the rig is lifted and at rest."""
    CAUSES[name][0](bench)
    bench.until_trip(40.0)
    r = bench.readings
    r.wheel_speed_m_s = r.belt_speed_m_s = r.slip_m_s = r.force_z_n = r.force_x_n = r.press_mm = 0.0
    r.heat_percent, r.contactor_closed = 0.0, False
    bench.state.cooled = True
    bench.scans(12.0)
    assert bench.state.mode is Mode.LATCHED
    asked = ("guard open", "thermometer silent", "surface not valid")  # watched only while wanted, read now
    holding = bench.state.held or name in asked
    assert bench.control.request_ack(r.now_s) == ""
    bench.scans(1.5)
    assert bench.state.mode is (Mode.LATCHED if holding else Mode.IDLE)
    if holding:
        assert bench.texts("acknowledgement")[-1].startswith("refused, still there: ")


STANDING_CAUSES = ("safety chain", "drive fault", "bus lost", "second master", "device refused", "line noisy",
                   "wheel worn", "surface hot", "jacket hot", "jacket silent", "hub sensor broken")  # fmt: skip


@pytest.mark.parametrize("name", STANDING_CAUSES)
def test_a_level_that_holds_at_standstill_refuses_to_arm(bench: Bench, name: str) -> None:
    bench.control.request_stop(bench.readings.now_s, "test", fast=True)
    r = bench.readings
    r.wheel_speed_m_s = r.belt_speed_m_s = r.slip_m_s = r.force_z_n = r.force_x_n = r.press_mm = 0.0
    r.heat_percent, r.contactor_closed, r.drives_enabled, r.drives_disabled = 0.0, False, False, True
    bench.scans(1.0)
    bench.control.request_ack(r.now_s)
    bench.scans(0.1)
    assert bench.state.mode is Mode.IDLE
    CAUSES[name][0](bench)
    bench.scans(2.0)
    refused = bench.control.start(r)
    assert refused.startswith("not armed: ") and name in refused
    assert bench.state.mode is Mode.IDLE


# -- the scan -----------------------------------------------------------------------------------------------------


def late_scan(bench: Bench, seconds: float) -> None:
    """Do a scan that is this much later than its period, with fresh readings."""
    r = bench.readings
    r.now_s += 0.01 + seconds
    for stamp in STAMPS:
        setattr(r, stamp, r.now_s)
    bench.control.step(bench.demand, r, 0.01)
    bench.journal += bench.state.events
    bench.state.events.clear()


def test_a_scan_160_ms_late_trips_at_once(bench: Bench) -> None:
    late_scan(bench, 0.16)
    assert bench.state.trip is not None and bench.state.trip.name == "scan late"


def test_a_scan_60_ms_late_is_a_warning_and_each_is_reported_once(bench: Bench) -> None:
    late_scan(bench, 0.06)
    bench.scans(0.5)
    late_scan(bench, 0.06)
    assert bench.state.trip is None and bench.state.mode is Mode.RUN
    assert [text.split(":")[0] for text in bench.texts("warning")] == ["scan delayed", "scan delayed"]


def test_a_scan_40_ms_late_is_neither(bench: Bench) -> None:
    late_scan(bench, 0.04)
    assert bench.state.trip is None and not bench.texts("warning")


def test_a_clock_that_goes_back_trips(bench: Bench) -> None:
    bench.readings.now_s -= 1.0
    bench.scan(0.0)
    assert bench.state.trip is not None and bench.state.trip.name == "clock jump"


# -- what must not trip -------------------------------------------------------------------------------------------


def test_drive_data_as_old_as_a_late_scan_was_long_does_not_trip(bench: Bench) -> None:
    r = bench.readings
    r.now_s += 0.045
    r.wheel_at_s = r.belt_at_s = r.press_at_s = r.positions_at_s = r.now_s - 0.044
    r.cell_at_s = r.now_s - 0.044
    bench.control.step(bench.demand, r, 0.01)
    assert bench.state.trip is None


def test_a_stale_load_cell_does_not_matter_while_lifted(bench: Bench) -> None:
    bench.demand.press = Press.LIFT
    bench.readings.force_z_n = bench.readings.slip_m_s = 0.0
    bench.scans(0.5)
    bench.readings.cell_valid = False
    bench.scans(0.5)
    assert bench.state.trip is None


def _press(bench: Bench, force_n: float) -> None:
    """Bring the load to a value, and the press to where it needs to be for it."""
    rig = bench.control.rig
    bench.readings.force_z_n = force_n
    bench.readings.press_mm = rig.geometry.touch_mm + depth_mm(force_n, rig.loops.load.stiffness_n_per_mm)


def test_a_lower_load_is_not_an_overshoot_while_the_press_follows(bench: Bench) -> None:
    bench.demand.load_n = 50.0
    for i in range(100):
        _press(bench, max(50.0, 200.0 - 2.0 * i))
        bench.scan()
    assert bench.state.trip is None


def test_a_softer_rubber_is_not_too_deep(bench: Bench) -> None:
    _touched(11.8 - 2.4)(bench)
    bench.scans(1.0)
    assert bench.state.trip is None


def test_a_wheel_that_wears_under_load_is_not_too_deep(bench: Bench) -> None:
    _touched(11.8 - 2.6)(bench)
    bench.state.load.diameter_mm = bench.readings.diameter_mm + 1.0
    bench.scans(1.0)
    assert bench.state.trip is None


def test_how_deep_is_judged_only_once_the_wheel_was_touched(bench: Bench) -> None:
    bench.state.load.in_contact = bench.state.load.loaded = False
    bench.readings.force_z_n = bench.readings.slip_m_s = bench.readings.force_x_n = 0.0
    bench.control.view.force.forget()
    _touched(11.8 - 1.4)(bench)
    bench.scans(1.0)
    assert bench.state.trip is None


def test_a_higher_load_is_not_a_lost_contact_while_the_press_follows(bench: Bench) -> None:
    bench.demand.load_n = 50.0
    for _ in range(700):
        _press(bench, max(50.0, bench.readings.force_z_n - 2.0))
        bench.scan()
    bench.demand.load_n = 400.0
    for _ in range(300):
        _press(bench, min(400.0, bench.readings.force_z_n + 2.0))
        bench.scan()
    assert bench.state.trip is None


@pytest.mark.parametrize("dt", [0.01, 0.05])
def test_a_speed_on_its_ramp_is_not_a_speed_error(bench: Bench, dt: float) -> None:
    bench.demand.belt_speed_m_s = 0.8
    delayed = [0.5, 0.5]
    for _ in range(60):
        bench.readings.belt_speed_m_s = delayed.pop(0)
        bench.readings.slip_m_s = 0.8 - bench.readings.belt_speed_m_s
        if bench.readings.slip_m_s < 0.02:
            bench.readings.force_x_n = 0.0
        delayed.append(min(0.8, delayed[-1] + 2.0 * dt))
        bench.scan(dt)
    assert bench.state.trip is None


def test_a_hub_that_was_heated_at_full_power_until_now_is_no_stuck_heater(bench: Bench) -> None:
    bench.readings.heat_percent = 100.0
    for i in range(150):
        bench.readings.hub_c = 50.0 + 0.47 * 0.2 * min(i, 25)
        if i == 25:
            bench.demand.surface_c = NAN
            bench.readings.heat_percent, bench.readings.contactor_closed = 0.0, False
        bench.scan(0.2)
        assert not bench.state.held & TABLE.bit("heater stuck")


def _long_off(bench: Bench, hub_c: float) -> None:
    """Leave the heat off for longer than setpoints are valid, with a hub that stays hot."""
    bench.demand.surface_c = NAN
    bench.readings.heat_percent, bench.readings.contactor_closed = 0.0, False
    bench.control.view.jacket.forget(bench.readings.now_s)
    bench.readings.hub_c = hub_c
    _model(0.0)(bench)
    bench.scans(620.0, 0.1)


def test_a_hot_hub_that_cools_for_longer_than_setpoints_count_is_no_runaway(bench: Bench) -> None:
    _long_off(bench, 110.0)
    for _ in range(6000):
        bench.readings.hub_c -= 0.01
        bench.scan(0.1)
    assert bench.state.trip is None


def test_a_hub_that_a_hotter_rubber_warms_is_no_runaway(bench: Bench) -> None:
    _long_off(bench, 23.0)
    for _ in range(3750):
        bench.readings.hub_c += 0.004
        bench.scan(0.1)
    assert bench.state.trip is None and bench.readings.hub_c < bench.readings.surface_c


def test_a_hub_that_friction_has_warmed_may_cool_more_slowly_than_the_rubber(bench: Bench) -> None:
    _long_off(bench, 23.0)
    readings = bench.readings
    while readings.hub_c < 36.0:
        readings.hub_c += 0.004
        bench.scan(0.1)
    for _ in range(1500):
        readings.surface_c = max(readings.surface_c - 0.02, 24.0)
        _model(0.0)(bench)
        readings.hub_c -= 0.002
        bench.scan(0.1)
    assert bench.state.trip is None
    assert readings.hub_c > readings.surface_c + bench.control.rig.interlocks.runaway_k
    coolest_c = readings.hub_c
    for _ in range(9000):
        readings.hub_c += 0.001
        bench.scan(0.1)
        if bench.state.trip is not None:
            break
    assert bench.state.trip is not None and bench.state.trip.name == "jacket runaway"
    assert readings.hub_c <= coolest_c + bench.control.rig.interlocks.runaway_k + 0.1


def test_a_hotter_rubber_excuses_no_hub_that_is_given_output(bench: Bench) -> None:
    bench.control.view.jacket.forget(bench.readings.now_s)
    bench.readings.surface_c = 60.0
    _model(0.0)(bench)
    bench.control.view.surface.forget(bench.readings.now_s)
    highest_c = bench.state.hub_ceiling[0][1]
    bench.readings.hub_c = highest_c + bench.control.rig.interlocks.runaway_k + 1.0
    bench.scans(2.5)
    assert bench.readings.hub_c < bench.readings.surface_c + bench.control.rig.interlocks.runaway_k
    assert bench.state.trip is not None and bench.state.trip.name == "jacket runaway"


def test_a_hub_that_gets_hotter_without_output_is_a_runaway_however_slowly(bench: Bench) -> None:
    _long_off(bench, 60.0)
    for _ in range(9000):
        bench.readings.hub_c += 0.001
        bench.scan(0.1)
        if bench.state.trip is not None:
            break
    assert bench.state.trip is not None and bench.state.trip.name == "jacket runaway"
    assert bench.readings.hub_c <= 60.0 + bench.control.rig.interlocks.runaway_k + 0.1


def test_a_heater_that_is_stuck_on_is_found_within_10_s_of_the_command(bench: Bench) -> None:
    bench.demand.surface_c = NAN
    bench.readings.heat_percent, bench.readings.contactor_closed = 0.0, False
    began = bench.readings.now_s
    while bench.state.trip is None and bench.readings.now_s < began + 20.0:
        bench.readings.hub_c += 0.47 * 0.1
        bench.scan(0.1)
    assert bench.state.trip is not None and bench.state.trip.name == "heater stuck"
    assert bench.readings.now_s - began < 10.0


def test_a_transient_shorter_than_its_delay_does_not_trip(bench: Bench) -> None:
    for speed_m_s in (0.72, 0.8, 0.72):
        bench.readings.wheel_speed_m_s = speed_m_s
        bench.scans(0.09)
    assert bench.state.trip is None


# -- first-up -----------------------------------------------------------------------------------------------------


def test_the_first_cause_is_kept_when_others_follow_and_those_are_journalled(bench: Bench) -> None:
    bench.readings.guard_closed = False
    bench.scan()
    bench.readings.drive_fault = "belt drive: fault"
    bench.scan()
    assert bench.state.trip is not None and bench.state.trip.name == "guard open"
    assert [text.split(":")[0] for text in bench.texts("alarm")] == ["drive fault"]


def test_each_row_trips_once(bench: Bench) -> None:
    bench.readings.guard_closed = False
    bench.scans(0.5)
    assert len(bench.texts("trip")) == 1 and not [text for text in bench.texts("alarm") if text.startswith("guard")]


def test_two_causes_in_one_scan_are_both_evaluated(bench: Bench) -> None:
    bench.readings.guard_closed = False
    bench.readings.drive_fault = "belt drive: fault"
    bench.scan()
    assert bench.state.held & TABLE.bit("guard open") and bench.state.held & TABLE.bit("drive fault")
