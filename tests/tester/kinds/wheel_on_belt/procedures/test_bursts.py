"""One repeat: how bursts begin, count and end, and temperatures that do not hold."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import hypot
from statistics import fmean

import pytest

from tester.analysis.blocks import blocks_from_samples
from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.procedures.burst_state import Phase
from tester.kinds.wheel_on_belt.procedures.bursts import TARE_FRESH_S, MeasureRepeat
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition
from tester.machine.measured import Ending
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Bench, Simulation, condition_of, make_bench

AT_40 = condition_of(SHORT.replace("25 degC", "40 degC"))
YAWED = condition_of(SHORT.replace("25 degC", "40 degC") + "    sideslip: 20 deg\n")
ROLLING = condition_of(SHORT.replace("25 degC", "40 degC").replace("300 mm/s", "0 mm/s"))


@pytest.fixture
def bench() -> Bench:
    made = make_bench()
    made.surface_c = 39.0
    return made


def measure(bench: Bench, step: WheelCondition = AT_40, at_most_s: float = 3000.0, dt: float = 0.01) -> MeasureRepeat:
    """Measure one repeat to its end."""
    repeat = MeasureRepeat(step, [], 1.0)
    bench.run(repeat, at_most_s, dt)
    return repeat


# -- how a repeat goes --------------------------------------------------------------------------------------------


def test_a_repeat_collects_its_window(bench: Bench) -> None:
    repeat = measure(bench)
    assert repeat.ending is Ending.COMPLETE and repeat.revolutions >= 14


def test_a_repeat_begins_with_a_tare_and_ends_lifted_at_matched_speeds(bench: Bench) -> None:
    repeat = MeasureRepeat(AT_40, [], 1.0)
    bench.scan(repeat)
    assert repeat.phase is Phase.TARE and bench.ctx.demand.press is Press.LIFT
    bench.run(repeat)
    demand = bench.ctx.demand
    assert len(bench.notes.written("INSERT INTO tare")) == 1
    assert demand.press is Press.LIFT and demand.wheel_speed_m_s == demand.belt_speed_m_s == 0.8


def test_slip_comes_by_the_belt_at_held_load(bench: Bench) -> None:
    measure(bench)
    first = next(i for i, d in enumerate(bench.demands) if d.belt_speed_m_s == 0.5)
    before, pulse = bench.demands[first - 1], bench.demands[first]
    assert before.press is pulse.press is Press.LOAD and before.load_n == pulse.load_n == 200.0
    assert before.belt_speed_m_s == before.wheel_speed_m_s == pulse.wheel_speed_m_s == 0.8


def test_the_jacket_does_not_answer_a_slip_pulse(bench: Bench) -> None:
    measure(bench)
    assert all(d.freeze_heat for d in bench.demands if d.belt_speed_m_s == 0.5)


def test_between_bursts_rolling_is_held_below_the_setpoint(bench: Bench) -> None:
    repeat = MeasureRepeat(AT_40, [], 1.0)
    bench.scan(repeat)
    assert bench.ctx.demand.surface_c == 39.0


def test_no_sample_after_the_window_is_in_a_burst(bench: Bench) -> None:
    repeat = measure(bench)
    last = repeat.counter.blocks[-1].ended_s
    assert all(row[QUANTITIES.index("burst")] == 0.0 for row in bench.notes.rows if row[0] > last)


def test_a_burst_waits_for_the_lower_part_of_the_band(bench: Bench) -> None:
    bench.surface_c = 40.5
    repeat = MeasureRepeat(AT_40, [], 1.0)
    bench.hold(repeat, 30.0)
    assert repeat.phase is Phase.READY
    bench.surface_c = 39.0
    bench.until(repeat, lambda: repeat.phase is Phase.COUNT, at_most_s=10.0)


def test_a_surface_far_below_the_band_is_waited_for(bench: Bench) -> None:
    bench.surface_c = 37.0
    repeat = MeasureRepeat(AT_40, [], 1.0)
    bench.hold(repeat, 120.0)
    assert repeat.phase is Phase.READY


@pytest.mark.parametrize(("waited_s", "tares"), [(TARE_FRESH_S - 20.0, 1), (TARE_FRESH_S + 20.0, 2)])
def test_a_zero_that_has_grown_old_is_taken_anew_before_the_first_burst(
    bench: Bench, waited_s: float, tares: int
) -> None:
    bench.surface_c = 37.0
    repeat = MeasureRepeat(AT_40, [], 1.0)
    bench.hold(repeat, waited_s)
    bench.surface_c = 39.0
    bench.until(repeat, lambda: repeat.phase is Phase.COUNT, at_most_s=60.0)
    assert len(bench.notes.written("INSERT INTO tare")) == tares
    # Some seconds until the slip is there: 120 s at most when the first sample counts.
    assert bench.now - repeat.tared_s < 115.0


def test_a_zero_is_not_taken_anew_between_bursts(bench: Bench) -> None:
    bench.warming_k_s, bench.returning_k_s = 1.0, 0.02
    repeat = measure(bench, replace(AT_40, window=replace(AT_40.window, revolutions=60.0, extend_to=60.0)))
    assert repeat.bursts > 1 and bench.now - repeat.tared_s > TARE_FRESH_S
    assert len(bench.notes.written("INSERT INTO tare")) == 1


def test_a_burst_ends_as_far_above_the_setpoint_as_it_began_below(bench: Bench) -> None:
    bench.warming_k_s, bench.returning_k_s = 2.0, 0.5
    repeat = MeasureRepeat(replace(AT_40, window=replace(AT_40.window, revolutions=60.0)), [], 1.0)
    hottest = 0.0
    while not bench.scan(repeat) and repeat.bursts < 3:
        hottest = max(hottest, bench.surface_c)
    assert 40.5 < hottest < 42.0


def test_a_burst_that_stays_cold_starts_the_next_one_higher(bench: Bench) -> None:
    step = replace(AT_40, window=replace(AT_40.window, revolutions=20.0, extend_to=20.0))
    repeat = MeasureRepeat(step, [], 1.5)
    bench.surface_c = 38.5
    bench.run(repeat, 300.0)
    assert repeat.offset_k < 1.5


def test_without_slip_one_burst_is_the_window(bench: Bench) -> None:
    bench.surface_c = 40.0
    repeat = measure(bench, ROLLING, dt=0.05)
    assert repeat.ending is Ending.COMPLETE and repeat.bursts == 1 and repeat.rolling_only


def test_without_slip_the_window_is_at_the_slow_rate_and_the_heat_stays_in_control(bench: Bench) -> None:
    bench.surface_c = 40.0
    repeat = MeasureRepeat(ROLLING, [], 1.0)
    while repeat.phase is not Phase.COUNT:
        bench.scan(repeat, 0.05)
    bench.scan(repeat, 0.05)
    assert not bench.ctx.moving and not bench.ctx.demand.freeze_heat


# -- sideslip -----------------------------------------------------------------------------------------------------


def test_a_yawed_burst_lifts_yaws_and_touches_at_speed(bench: Bench) -> None:
    measure(bench, YAWED)
    pairs = list(pairwise(bench.demands))
    turned = [after for before, after in pairs if before.positions != after.positions]
    assert turned and all(demand.press is Press.LIFT for demand in turned)
    touched = [after for before, after in pairs if (before.press, after.press) == (Press.LIFT, Press.LOAD)]
    yawed = [demand for demand in touched if demand.positions["sideslip"] == 20.0]
    assert yawed and all(d.belt_speed_m_s == 0.5 and d.quick_touch for d in yawed)


def test_between_yawed_bursts_the_wheel_rolls_straight(bench: Bench) -> None:
    measure(bench, YAWED)
    rolled = [d for d in bench.demands if d.press is Press.LOAD and d.belt_speed_m_s == 0.8]
    assert rolled and all(d.positions["sideslip"] == 0.0 for d in rolled)


# -- unstable temperatures ----------------------------------------------------------------------------------------


def test_a_contact_that_warms_through_the_band_within_a_turn_cannot_be_held(bench: Bench) -> None:
    bench.warming_k_s, bench.returning_k_s = 20.0, 0.5
    repeat = measure(bench)
    assert repeat.ending is Ending.CANNOT_HOLD and repeat.revolutions == 0


def test_the_rate_is_that_of_the_surface_and_the_band_would_hold_a_turn(bench: Bench) -> None:
    bench.warming_k_s, bench.returning_k_s = 20.0, 0.5
    repeat = measure(bench)
    assert repeat.warming_k_s == pytest.approx(20.0, rel=0.2)
    assert 2.0 * repeat.holdable_band_k > 20.0 * 0.353
    assert "K/s; a band of" in repeat.detail


def test_a_band_that_failed_is_not_suggested(bench: Bench) -> None:
    bench.warming_k_s, bench.returning_k_s = 6.0, 0.5
    repeat = measure(bench, replace(AT_40, temperature_band_k=0.5))
    assert repeat.ending is Ending.CANNOT_HOLD and repeat.holdable_band_k > 0.5


def test_one_empty_burst_after_good_ones_ends_nothing(bench: Bench) -> None:
    bench.warming_k_s, bench.returning_k_s = 2.0, 0.5
    repeat = MeasureRepeat(replace(AT_40, window=replace(AT_40.window, revolutions=60.0)), [], 3.5)
    bench.until(repeat, lambda: repeat.bursts == 5 and repeat.phase is Phase.COUNT)
    gained, repeat.offset_k, bench.surface_c = repeat.revolutions, 3.5, 43.0
    bench.until(repeat, lambda: repeat.bursts == 6)
    assert gained > 0 and repeat.ending is None


def test_a_temperature_that_does_not_come_back_ends_as_not_reached(bench: Bench) -> None:
    bench.surface_c = 41.0
    step = replace(AT_40, soak=replace(AT_40.soak, at_most_s=900.0))
    began = bench.now
    repeat = measure(bench, step, at_most_s=2000.0, dt=0.05)
    assert repeat.ending is Ending.NOT_REACHED and bench.now - began < 900.0 + 400.0


def test_a_wheel_that_rolling_does_not_cool_is_lifted(bench: Bench) -> None:
    bench.surface_c = 41.0
    repeat = MeasureRepeat(AT_40, [], 1.0)
    bench.hold(repeat, 200.0, dt=0.05)
    assert repeat.phase is Phase.COOL and bench.ctx.demand.press is Press.LIFT
    bench.surface_c = 38.9
    bench.until(repeat, lambda: repeat.phase is Phase.COUNT, at_most_s=20.0)


def test_the_mean_of_counted_samples_stays_near_the_setpoint_when_nothing_cools(bench: Bench) -> None:
    bench.warming_k_s = 1.0
    step = replace(AT_40, soak=replace(AT_40.soak, at_most_s=600.0))
    repeat = measure(bench, step, at_most_s=3000.0, dt=0.01)
    rows = [row for row in bench.notes.rows if row[18] == 0.0 and row[19] != 0.0]
    assert abs(fmean(row[12] for row in rows) - 40.0) < 0.7
    assert repeat.ending is not None


def test_a_zero_that_has_drifted_ends_the_repeat_before_it_touches(bench: Bench) -> None:
    bench.zero_n = 25.0
    repeat = MeasureRepeat(AT_40, [0.0, 0.0, 0.0, 0.0], 1.0)
    bench.run(repeat)
    assert repeat.ending is Ending.ZERO_DRIFT
    assert all(demand.press is Press.LIFT for demand in bench.demands)


def test_too_few_revolutions_after_all_bursts_are_incomplete(bench: Bench) -> None:
    bench.warming_k_s, bench.returning_k_s = 2.0, 2.0
    step = replace(AT_40, max_bursts=2, window=replace(AT_40.window, revolutions=60.0, extend_to=60.0))
    repeat = measure(bench, step)
    assert repeat.ending is Ending.INCOMPLETE and repeat.bursts == 2


# -- on the simulated rig -----------------------------------------------------------------------------------------


def counted(run: Simulation) -> list[dict[str, float]]:
    """Return the samples that count."""
    return [row for row in run.rows(gate=0.0) if row["burst"] > 0.0]


def test_slip_pulses_start_below_and_end_above_the_setpoint(pulsed_run: Simulation) -> None:
    rows, truth = counted(pulsed_run), dict(pulsed_run.truth)
    bursts = [[truth[row["time_s"]] for row in rows if row["burst"] == burst] for burst in (1.0, 2.0, 3.0)]
    assert all(24.0 < pulse[0] < 25.0 < pulse[-1] < 26.5 for pulse in bursts)


def test_the_surface_s_mean_over_a_window_is_near_the_setpoint(pulsed_run: Simulation) -> None:
    truth = dict(pulsed_run.truth)
    assert abs(fmean(truth[row["time_s"]] for row in counted(pulsed_run)) - 25.0) < 0.7


def test_the_hot_rig_counts_nothing_warm_as_cold(warm_run: Simulation) -> None:
    rows, truth = counted(warm_run), dict(warm_run.truth)
    surface = [truth[row["time_s"]] for row in rows]
    # The band is 2 K; the thermometer lags by 0.15 s and is read five times a second, and the surface warms by 3 to 4
    # K/s: a reading is 0.1 s old in the mean, and up to 0.2 s with the few readings that a pulse has.
    assert rows and max(surface) < 25.0 + 2.0 + 0.5
    assert fmean(surface) - fmean(row["surface_c"] for row in rows) < 1.2


def test_the_live_count_agrees_with_the_samples(noisy_run: Simulation) -> None:
    import numpy as np

    table = np.array(noisy_run.notes.rows)
    columns = {name: table[:, i] for i, name in enumerate(QUANTITIES.names)}
    stored = blocks_from_samples(columns, QUANTITIES)
    bursts = noisy_run.notes.written("INSERT INTO burst")
    assert len(stored) == sum(int(str(values[2])) for values in bursts)


def test_yaw_never_moves_under_load(yawed_run: Simulation) -> None:
    rows = yawed_run.rows()
    moved = [b for a, b in pairwise(rows) if abs(a["sideslip_deg"] - b["sideslip_deg"]) > 0.05]
    assert moved and all(abs(row["force_z_n"]) < 20.0 for row in moved)


def test_yawed_samples_slip_by_the_vector(yawed_run: Simulation) -> None:
    rows = counted(yawed_run)
    assert rows
    assert fmean(row["slip_m_s"] for row in rows) == pytest.approx(0.371814, abs=0.004)
    assert all(row["sideslip_deg"] == pytest.approx(20.0, abs=0.1) for row in rows)


def test_load_is_applied_only_to_a_turning_wheel_and_belt(yawed_run: Simulation) -> None:
    loaded = [row for row in yawed_run.rows() if row["force_z_n"] > 20.0]
    assert min(row["wheel_speed_m_s"] for row in loaded) > 0.78
    assert min(row["belt_speed_m_s"] for row in loaded) > 0.48


def test_rolling_is_one_window_without_slip(rolling_run: Simulation) -> None:
    rows = counted(rolling_run)
    assert {row["burst"] for row in rows} == {1.0}
    assert max(row["slip_m_s"] for row in rows) < 0.005


def test_the_event_of_a_condition_without_a_value_is_a_warning(hot_run: Simulation, quiet_run: Simulation) -> None:
    for run, expected in ((hot_run, "warning"), (quiet_run, "info")):
        assert [severity for _, kind, _, severity in run.notes.events if kind == "condition"] == [expected]


def test_a_condition_that_cannot_be_held_counts_no_revolution(hot_run: Simulation) -> None:
    assert hot_run.notes.written("INSERT INTO burst") == []


def test_the_coefficient_is_that_of_the_forces(quiet_run: Simulation) -> None:
    rows = counted(quiet_run)
    force = hypot(fmean(row["force_x_n"] for row in rows), fmean(row["force_y_n"] for row in rows))
    (text,) = quiet_run.notes.texts("repeat")
    measured = float(text.partition("mu as measured ")[2].partition(",")[0])
    assert measured == pytest.approx(force / fmean(r["force_z_n"] for r in rows), rel=0.01)
