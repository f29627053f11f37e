"""Every row of the interlock table: its cause trips it, nothing else does, and unknown counts as the cause."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from tester.control.interlocks import INTERLOCKS
from tester.control.state import Mode, Reaction
from tester.process import Press
from tests.tester.control.conftest import Bench

NAN = math.nan
Break = Callable[[Bench], None]


def _set(**values: object) -> Break:
    def apply(bench: Bench) -> None:
        for name, value in values.items():
            setattr(bench.readings, name, value)

    return apply


CAUSES: dict[str, list[Break]] = {
    "safety chain": [_set(safety_chain=False)],
    "drive fault": [_set(drive_fault="wheel drive: heartbeat lost")],
    "drive data stale": [],
    "load cell stale": [_set(cell_valid=False)],
    "overload": [_set(force_z_n=451.0), _set(force_z_n=NAN)],
    "load overshoot": [_set(force_z_n=231.0), _set(force_z_n=NAN)],
    "contact lost": [_set(force_z_n=15.0), _set(force_z_n=NAN)],
    "slip power": [_set(force_x_n=1200.0), _set(slip_m_s=NAN), _set(force_y_n=NAN)],
    "drive standing under load": [_set(belt_speed_m_s=0.0), _set(wheel_speed_m_s=0.0), _set(belt_speed_m_s=NAN)],
    "overspeed": [_set(wheel_speed_m_s=1.3), _set(belt_speed_m_s=-1.5), _set(wheel_speed_m_s=NAN)],
    "guard open": [_set(guard_closed=False)],
    "surface hot": [_set(surface_c=95.5), _set(surface_c=NAN)],
    "jacket hot": [_set(hub_c=156.0), _set(hub_c=NAN)],
    "jacket runaway": [_set(hub_c=120.0)],
    "heating at standstill": [_set(wheel_speed_m_s=0.0)],
    "surface data stale": [_set(surface_valid=False)],
    "jacket data stale": [_set(jacket_valid=False)],
    "scan late": [],
}


def test_every_row_of_the_table_has_a_test_here() -> None:
    assert [row.name for row in INTERLOCKS] == list(CAUSES)


def test_the_healthy_rig_runs_for_a_minute_without_a_trip(bench: Bench) -> None:
    for _ in range(6000):
        bench.scan()
    assert bench.state.trip is None
    assert bench.state.mode is Mode.RUN


@pytest.mark.parametrize(("name", "number"), [(name, i) for name, causes in CAUSES.items() for i in range(len(causes))])
def test_its_cause_trips_a_row_after_its_delay_and_not_before(bench: Bench, name: str, number: int) -> None:
    index = next(i for i, row in enumerate(INTERLOCKS) if row.name == name)
    delay = INTERLOCKS[index].delay_s(bench.control.rig)
    CAUSES[name][number](bench)
    bench.scan()
    assert math.isfinite(bench.state.pending_s[index]), "the level holds from the first scan"
    began = bench.readings.now_s
    while bench.state.trip is None and bench.readings.now_s < began + 4.0:
        bench.scan()
    trip = bench.state.trip
    assert trip is not None
    # One cause may raise several levels (an unknown force is also an overload): the quickest is first.
    assert trip.at_s - began <= delay + 1e-6
    if trip.name == name:
        assert trip.at_s - began == pytest.approx(delay, abs=0.0101)


@pytest.mark.parametrize("name", [name for name, causes in CAUSES.items() if causes])
def test_a_trip_makes_the_outputs_safe_in_the_same_scan(bench: Bench, name: str) -> None:
    CAUSES[name][0](bench)
    for _ in range(400):
        out = bench.scan()
        if bench.state.trip is not None:
            break
    assert bench.state.trip is not None
    if bench.state.mode is Mode.STOPPING:
        out = bench.scan()
    assert not out.heat
    assert not out.contactor
    assert out.press_mm_s <= 0.0
    assert out.quick_stop is (bench.state.trip.reaction is Reaction.FAST)


def test_stale_drive_data_trip(bench: Bench) -> None:
    r = bench.readings
    stamp = r.belt_at_s
    while bench.state.trip is None and r.now_s < stamp + 1.0:
        r.now_s += 0.01
        r.wheel_at_s = r.press_at_s = r.sideslip_at_s = r.camber_at_s = r.now_s
        r.cell_at_s = r.surface_at_s = r.jacket_at_s = r.now_s
        bench.control.step(bench.demand, r, 0.01)
    assert bench.state.trip is not None
    assert bench.state.trip.name == "drive data stale"
    assert r.now_s - stamp == pytest.approx(0.03, abs=0.0101)


def test_a_late_scan_trips(bench: Bench) -> None:
    r = bench.readings
    r.now_s += 0.2
    r.wheel_at_s = r.belt_at_s = r.press_at_s = r.sideslip_at_s = r.camber_at_s = r.cell_at_s = r.now_s
    bench.control.step(bench.demand, r, 0.01)
    assert bench.state.trip is not None
    assert bench.state.trip.name == "scan late"


def test_drive_data_as_old_as_a_late_scan_was_long_does_not_trip(bench: Bench) -> None:
    r = bench.readings
    r.now_s += 0.045
    r.wheel_at_s = r.belt_at_s = r.press_at_s = r.sideslip_at_s = r.camber_at_s = r.now_s - 0.044
    r.cell_at_s = r.now_s - 0.044
    bench.control.step(bench.demand, r, 0.01)
    assert bench.state.trip is None


def test_a_stale_load_cell_does_not_matter_while_lifted(bench: Bench) -> None:
    bench.demand.press = Press.LIFT
    bench.readings.force_z_n = 0.0
    bench.readings.slip_m_s = 0.0
    for _ in range(50):
        bench.scan()
    bench.readings.cell_valid = False
    for _ in range(50):
        bench.scan()
    assert bench.state.trip is None


def test_the_first_cause_is_kept_when_others_follow(bench: Bench) -> None:
    bench.readings.guard_closed = False
    bench.scan()
    bench.readings.safety_chain = False
    bench.scan()
    assert bench.state.trip is not None
    assert bench.state.trip.name == "guard open"


def test_two_causes_in_one_scan_are_both_evaluated(bench: Bench) -> None:
    bench.readings.guard_closed = False
    bench.readings.safety_chain = False
    bench.scan()
    holding = [row.name for row, since in zip(INTERLOCKS, bench.state.pending_s, strict=True) if math.isfinite(since)]
    assert {"guard open", "safety chain"} <= set(holding)


def test_a_lower_load_is_not_an_overshoot_while_the_press_follows(bench: Bench) -> None:
    bench.demand.load_n = 50.0
    for i in range(100):
        bench.readings.force_z_n = max(50.0, 200.0 - 2.0 * i)
        bench.scan()
    assert bench.state.trip is None


def test_a_higher_load_is_not_a_lost_contact_while_the_press_follows(bench: Bench) -> None:
    bench.demand.load_n = 50.0
    for _ in range(700):
        bench.readings.force_z_n = max(50.0, bench.readings.force_z_n - 2.0)
        bench.scan()
    bench.demand.load_n = 400.0
    for _ in range(300):
        bench.readings.force_z_n = min(400.0, bench.readings.force_z_n + 2.0)
        bench.scan()
    assert bench.state.trip is None
