"""Steps that wait for a temperature: what they hold meanwhile, when they are done, and their time limits."""

from __future__ import annotations

from math import isnan, nan

import pytest

from tester.inputs.recipe.plan import Soak
from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.interlocks.heat_balance import HeatBalance
from tester.kinds.wheel_on_belt.procedures.motions import Load, Turn
from tester.kinds.wheel_on_belt.procedures.thermal_steps import (
    CoolDown,
    HeatUp,
    RestStep,
    SoakTo,
    Straighten,
    roll,
    soak_within_k,
)
from tester.kinds.wheel_on_belt.recipe.plan_steps import Cool, Heat, Rest
from tester.kinds.wheel_on_belt.run.past_runs import ratios_of
from tester.machine.motions import Power, Sequence
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Bench, Simulation, make_bench

SOAK = Soak(1.0, 60.0, 1800.0)


@pytest.fixture
def bench() -> Bench:
    return make_bench()


def rest(at_least_s: float = 60.0, until_c: float | None = 25.0, at_most_s: float = 300.0) -> Rest:
    return Rest(1, at_least_s, until_c, 2.0, at_most_s)


def test_rolling_contact_is_loaded_at_matched_speeds(bench: Bench) -> None:
    bench.run(roll(0.8, 200.0))
    demand = bench.ctx.demand
    assert demand.enabled and demand.wheel_speed_m_s == demand.belt_speed_m_s == 0.8
    assert demand.press is Press.LOAD and demand.load_n == 200.0


def test_nothing_presses_before_the_speeds_are_there(bench: Bench) -> None:
    bench.run(roll(0.8, 200.0))
    first = next(i for i, demand in enumerate(bench.demands) if demand.press is Press.LOAD)
    assert bench.demands[first - 1].wheel_speed_m_s == bench.demands[first - 1].belt_speed_m_s == 0.8


def test_a_yawed_wheel_is_lifted_before_it_is_straightened(bench: Bench) -> None:
    bench.run(Sequence(Power(True), Turn(0.8, 0.8)))
    bench.ctx.demand.positions["sideslip"] = 20.0
    bench.run(Load(200.0))
    seen = len(bench.demands)
    bench.run(Straighten())
    turned = next(d for d in bench.demands[seen:] if d.positions["sideslip"] == 0.0)
    assert turned.press is Press.LIFT


def test_a_straight_wheel_stays_in_contact_when_it_is_straightened(bench: Bench) -> None:
    bench.run(roll(0.8, 200.0))
    bench.run(Straighten())
    assert bench.ctx.demand.press is Press.LOAD


@pytest.mark.parametrize("setpoint, within", [(40.0, 1.0), (25.0, 2.0), (20.1, 2.0), (26.5, 1.0)])
def test_near_ambient_a_soak_is_to_the_band(setpoint: float, within: float) -> None:
    assert soak_within_k(SOAK, setpoint, 23.0, 2.0) == within


def test_a_soak_lasts_from_when_the_surface_is_near(bench: Bench) -> None:
    bench.surface_c = 30.0
    soak = SoakTo(40.0, 1.0, 60.0, 1800.0)
    bench.hold(soak, 20.0, dt=0.1)
    bench.surface_c = 40.0
    assert bench.run(soak, at_most_s=100.0, dt=0.1) == pytest.approx(65.0, abs=4.0)
    assert soak.reached


def test_a_soak_that_is_left_starts_again(bench: Bench) -> None:
    bench.surface_c = 40.0
    soak = SoakTo(40.0, 1.0, 60.0, 1800.0)
    bench.hold(soak, 50.0, dt=0.1)
    bench.surface_c = 43.0
    bench.hold(soak, 10.0, dt=0.1)
    bench.surface_c = 40.0
    assert bench.run(soak, at_most_s=100.0, dt=0.1) > 59.0


def test_a_soak_is_given_up_after_its_longest_time(bench: Bench) -> None:
    bench.surface_c = 30.0
    soak = SoakTo(40.0, 1.0, 60.0, 300.0)
    assert bench.run(soak, at_most_s=400.0, dt=0.1) == pytest.approx(300.1, abs=0.2)
    assert not soak.reached


def test_an_unknown_surface_is_not_soaked(bench: Bench) -> None:
    bench.surface_c = nan
    soak = SoakTo(40.0, 1.0, 0.0, 10.0)
    bench.run(soak, at_most_s=20.0, dt=0.1)
    assert not soak.reached


def heat_up() -> HeatUp:
    return HeatUp(Heat(1, 40.0), 0.8, 400.0, 1.0, 1.0)


def test_heating_up_is_in_rolling_contact_at_a_moderate_load(bench: Bench) -> None:
    bench.surface_c = 39.0
    bench.run(heat_up(), dt=0.05)
    assert bench.ctx.demand.load_n == 200.0 and bench.ctx.demand.surface_c == 39.0


def test_heat_is_wanted_from_the_first_scan_of_heating_up(bench: Bench) -> None:
    bench.scan(heat_up())
    assert bench.ctx.demand.surface_c == 39.0 and not bench.ctx.demand.freeze_heat


def test_a_temperature_that_is_not_reached_is_a_warning_and_no_end(bench: Bench) -> None:
    bench.run(heat_up(), at_most_s=6000.0, dt=0.5)
    assert bench.notes.texts("heat") == ["40 degC not reached in time"]


def test_resting_is_lifted_standing_unpowered_and_cold(bench: Bench) -> None:
    bench.run(roll(0.8, 200.0))
    bench.run(RestStep(rest(), ask_when_late=False), at_most_s=100.0, dt=0.1)
    demand = bench.ctx.demand
    assert demand.press is Press.LIFT and not demand.enabled and isnan(demand.surface_c)
    assert demand.wheel_speed_m_s == demand.belt_speed_m_s == 0.0


def test_a_rest_stands_still_before_the_power_goes(bench: Bench) -> None:
    bench.run(roll(0.8, 200.0))
    seen = len(bench.demands)
    bench.run(RestStep(rest(), ask_when_late=False), at_most_s=100.0, dt=0.1)
    off = next(i for i in range(seen, len(bench.demands)) if not bench.demands[i].enabled)
    assert bench.demands[off - 1].wheel_speed_m_s == 0.0 and bench.demands[off - 1].press is Press.LIFT


def test_a_rest_takes_at_least_its_time(bench: Bench) -> None:
    step = RestStep(rest(at_least_s=60.0), ask_when_late=False)
    assert 60.0 <= bench.run(step, at_most_s=100.0, dt=0.1) < 62.0


def test_a_rest_waits_for_the_surface(bench: Bench) -> None:
    bench.surface_c = 30.0
    step = RestStep(rest(), ask_when_late=False)
    bench.hold(step, 100.0, dt=0.1)
    bench.surface_c = 26.9
    assert bench.scan(step)


def test_a_rest_does_not_wait_for_a_colder_room_to_warm_up(bench: Bench) -> None:
    bench.surface_c = 15.0
    assert bench.run(RestStep(rest(), ask_when_late=False), at_most_s=100.0, dt=0.1) < 62.0


def test_a_rest_that_is_too_long_continues_with_a_warning(bench: Bench) -> None:
    bench.surface_c = 40.0
    step = RestStep(rest(at_most_s=120.0), ask_when_late=False)
    assert bench.run(step, at_most_s=200.0, dt=0.1) == pytest.approx(120.0, abs=1.0)
    (warning,) = bench.notes.texts("rest")
    assert warning.startswith("not reached: after 2 min of rest the surface is at 40.0 degC")


def test_a_person_is_asked_about_a_rest_that_is_too_long() -> None:
    bench = make_bench(automatic=False)
    bench.surface_c = 40.0
    step = RestStep(rest(at_most_s=120.0), ask_when_late=True)
    bench.hold(step, 150.0, dt=0.1)
    waiting = bench.ctx.prompts.waiting
    assert waiting is not None and waiting.text.endswith("go on?")
    waiting.answer = "yes"
    assert bench.scan(step)


def test_cooling_turns_unloaded_without_heat(bench: Bench) -> None:
    bench.run(roll(0.8, 200.0))
    bench.surface_c = 60.0
    step = CoolDown(Cool(1, 45.0), 0.1)
    bench.hold(step, 30.0, dt=0.1)
    demand = bench.ctx.demand
    assert demand.press is Press.LIFT and demand.enabled and isnan(demand.surface_c)
    assert demand.wheel_speed_m_s == demand.belt_speed_m_s == 0.1


def test_cooling_ends_when_the_hub_is_cool(bench: Bench) -> None:
    bench.surface_c = 60.0
    step = CoolDown(Cool(1, 45.0), 0.1)
    bench.hold(step, 30.0, dt=0.1)
    bench.surface_c = 44.9
    assert bench.scan(step)


def test_cooling_is_given_up_after_hours(bench: Bench) -> None:
    bench.surface_c = 60.0
    assert bench.run(CoolDown(Cool(1, 45.0), 0.1), at_most_s=4 * 3600.0, dt=2.0) > 3 * 3600.0


def test_a_rest_surely_waits_for_its_least_time_then_while_the_surface_is_warm(bench: Bench) -> None:
    bench.surface_c = 30.0
    step = RestStep(rest(at_least_s=60.0, at_most_s=300.0), ask_when_late=False)
    assert step.waits_s(bench.ctx) == 0.0
    bench.hold(step, 20.0, dt=0.1)
    assert step.waits_s(bench.ctx) == pytest.approx(40.0, abs=2.0)
    bench.hold(step, 60.0, dt=0.1)
    assert step.waits_s(bench.ctx) == pytest.approx(220.0, abs=2.0)


def test_a_rest_near_its_end_may_act_at_any_time(bench: Bench) -> None:
    bench.surface_c = 30.0
    step = RestStep(rest(), ask_when_late=False)
    bench.hold(step, 100.0, dt=0.1)
    bench.surface_c = 27.2
    assert not bench.scan(step)
    assert step.waits_s(bench.ctx) == 0.0


def test_cooling_surely_continues_while_the_hub_is_far_from_cool(bench: Bench) -> None:
    bench.surface_c = 60.0
    step = CoolDown(Cool(1, 45.0), 0.1)
    assert step.waits_s(bench.ctx) == 0.0
    bench.hold(step, 30.0, dt=0.1)
    assert step.waits_s(bench.ctx) > 3600.0
    bench.surface_c = 46.0
    bench.scan(step)
    assert step.waits_s(bench.ctx) == 0.0


def heated() -> Simulation:
    """Return a run that has just heated up to 40 degC."""
    run = Simulation(SHORT.replace("25 degC", "40 degC"), seed=5)
    run.until(lambda it: any(text.startswith("heat balance") for text in it.notes.texts("heat")))
    return run


def test_after_heating_up_the_heat_balance_is_on_record_as_numbers() -> None:
    run = heated()
    (data,) = (str(values[-1]) for values in run.notes.written("INSERT INTO event") if "heat" in values)
    (ratio,) = ratios_of([data], run.run.engine.ctx.rig)
    assert abs(ratio - 1.0) < 0.03 and f"{ratio:.2f} of what" in run.notes.texts("heat")[0]


def heats(bench: Bench, hub_c: float, put_j: float, shown_j: float, *, forget: bool = False) -> list[str]:
    """Heat up from a surface and hub of 24 degC to a hub of ``hub_c``; return the message about it."""
    bench.ctx.heat = heat = HeatBalance(420.0, 0.15, 200.0, 23.0, 0.3, 5.0, put_j=7e3, shown_j=6e3)
    step = heat_up()
    bench.hold(step, 30.0, dt=0.05)
    if forget:
        heat.forget()
    heat.put_j, heat.shown_j = 7e3 + put_j, 6e3 + shown_j
    bench.surface_c = hub_c
    bench.run(step, dt=0.05)
    return bench.notes.texts("heat")


def test_only_the_heat_of_this_heating_is_reported(bench: Bench) -> None:
    told = "heat balance: 22.0 kJ put in, 1.10 of what the temperatures show"
    assert heats(bench, 45.0, 22e3, 20e3) == [told]


@pytest.mark.parametrize(("hub_c", "shown_j"), [(40.0, 20e3), (45.0, 9e3)])
def test_a_heating_of_little_heat_or_rise_gives_no_result(bench: Bench, hub_c: float, shown_j: float) -> None:
    assert heats(bench, hub_c, 22e3, shown_j) == []


def test_a_balance_restarted_meanwhile_gives_no_result(bench: Bench) -> None:
    assert heats(bench, 45.0, 22e3, 20e3, forget=True) == []
