"""The plant as a whole: contact, friction, heat and wear together, and what is random in it."""

from __future__ import annotations

import copy
import math
from dataclasses import replace
from itertools import pairwise

import pytest

from sim.machines.wheel_on_belt.plant import Plant
from sim.machines.wheel_on_belt.rubbing import WheelSetting
from sim.physics.contact import ContactModel
from sim.physics.friction import KNOWN, FrictionModel
from sim.physics.laws import LawSetting, StatedLaw
from sim.physics.parameters import ContactParameters, DriveParameters, SimParameters
from sim.physics.slip import cornering_factor, predict, slip_velocity, traction_direction

EXACT = SimParameters(noise=0.0, scatter=0.0, running_in=0.0, growth=0.0, ambient=25.0)
ROUND = replace(EXACT, contact=ContactParameters(runout=0.0))
WHEEL_RAD_S = 0.8 / 0.045
MIDDLE = WheelSetting(0.3, 200.0, (0.0, 0.0), 40.0)


def mounted(parameters: SimParameters = ROUND, compound: str = "1#", seed: int = 1) -> Plant:
    plant = Plant(parameters, seed)
    plant.install(1, 1, compound, True)
    return plant


def press_for(load_n: float) -> float:
    return 10.0 + ContactModel(ContactParameters()).depth_mm(load_n)


def run(
    plant: Plant,
    seconds: float,
    load_n: float = 0.0,
    belt_m_s: float = 0.5,
    sideslip_deg: float = 0.0,
    dt: float = 0.01,
    heater_w: float = 0.0,
    wheel_rad_s: float = WHEEL_RAD_S,
) -> None:
    """Run with the press at the depth of a load on a new wheel (0 = fully lifted)."""
    press_mm = press_for(load_n) if load_n > 0.0 else 0.0
    for _ in range(round(seconds / dt)):
        plant.advance(dt, wheel_rad_s, belt_m_s, press_mm, 0.0, sideslip_deg, heater_w)


def test_before_a_wheel_is_installed_there_is_nothing_to_touch() -> None:
    plant = Plant(ROUND, 1)
    run(plant, 0.1, 400.0)
    assert (plant.force_z_n, plant.force_x_n) == (0.0, 0.0)


def test_lifted_wheel_has_no_force() -> None:
    plant = mounted()
    plant.advance(0.01, WHEEL_RAD_S, 0.5, 9.9, 0.0, 0.0, 0.0)
    assert plant.force_z_n == plant.force_x_n == plant.drive_torque_nm == 0.0
    assert plant.slip_m_s == pytest.approx(0.3)


@pytest.mark.parametrize("load_n", [100.0, 200.0, 400.0])
def test_press_position_sets_the_load(load_n: float) -> None:
    plant = mounted()
    run(plant, 0.01, load_n)
    assert plant.force_z_n == pytest.approx(load_n)


@pytest.mark.parametrize("sideslip_deg", [0.0, 20.0, -20.0])
@pytest.mark.parametrize("compound", KNOWN)
def test_coefficient_is_the_models_once_the_contact_has_settled(compound: str, sideslip_deg: float) -> None:
    plant = mounted(compound=compound)
    run(plant, 1.5, 200.0, sideslip_deg=sideslip_deg)
    measured = math.hypot(plant.force_x_n, plant.force_y_n) / plant.force_z_n
    expected = predict(compound, 0.3, plant.force_z_n, plant.surface_c, sideslip_deg, 0.4 * plant.diameter_mm / 45.0)
    assert plant.mu == pytest.approx(measured, rel=1e-9)
    assert measured == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("model", ["paper", "v2"])
def test_friction_model_is_the_one_asked_for(model: str) -> None:
    plant = mounted(replace(ROUND, friction_model=model))
    run(plant, 1.5, 400.0)
    assert plant.mu == pytest.approx(predict("1#", 0.3, 400.0, 25.0, model=model), rel=0.01)


@pytest.mark.parametrize("model", ["paper", "v2"])
@pytest.mark.parametrize("belt_m_s", [0.3, 0.8001, 0.7998, 1.1])
@pytest.mark.parametrize("sideslip_deg", [0.0, 12.0])
@pytest.mark.parametrize("load_n", [5.0, 200.0])
def test_rubbing_follows_the_formulas(
    model: str, belt_m_s: float, sideslip_deg: float, load_n: float
) -> None:
    plant = mounted(replace(SimParameters(noise=0.0, friction_model=model), contact=ROUND.contact))
    plant.begin_repeat(1, 1, 1, MIDDLE)
    run(plant, 0.02, load_n, belt_m_s, sideslip_deg)
    for _ in range(3):
        surface_c, diameter_mm, sliding_m, touched_s = plant.surface_c, plant.diameter_mm, plant.sliding_m, 0.02
        run(plant, 0.01, load_n, belt_m_s, sideslip_deg)
        wheel_m_s = 0.0005 * diameter_mm * WHEEL_RAD_S
        vx, vy, slip_m_s = slip_velocity(wheel_m_s, belt_m_s, sideslip_deg)
        mu = FrictionModel("1#", model).mu(surface_c, max(plant.force_z_n, 20.0), slip_m_s)
        mu *= cornering_factor("1#", sideslip_deg) * (1.0 + 0.15 * math.exp(-sliding_m / 10.0))
        mu *= plant.wheel_factor * plant.condition_factor * plant.run_factor
        within = plant.mu / mu / (1.0 - 0.1 * math.exp(-touched_s / 0.25))
        assert within == pytest.approx(1.0, abs=0.06)
        cx, cy = traction_direction(vx, vy)
        forces = (plant.force_x_n, plant.force_y_n)
        assert forces == pytest.approx((plant.mu * plant.force_z_n * cx, plant.mu * plant.force_z_n * cy), rel=1e-12)
        assert plant.sliding_m == pytest.approx(sliding_m + 0.01 * slip_m_s, rel=1e-12)
        worn_mm = 0.08 * plant.force_z_n * 0.01 * slip_m_s / (math.pi * diameter_mm * 30.0)  # Archard
        assert diameter_mm - plant.diameter_mm == pytest.approx(2.0 * worn_mm, rel=1e-6, abs=1e-13)


@pytest.mark.parametrize("sliding_m", [0.0, 25.0, 369.0, 371.0, 5000.0])
def test_running_in_is_that_of_the_formula_at_any_distance(sliding_m: float) -> None:
    worn, never = Plant(replace(ROUND, running_in=1.0), 1), Plant(ROUND, 1)
    for plant in (worn, never):
        plant.install(1, 1, "1#", True, sliding_m=sliding_m)
        run(plant, 0.01, 200.0)
    assert worn.mu / never.mu == pytest.approx((1.0 + 0.15 * math.exp(-sliding_m / 10.0)), rel=1e-12)


def test_force_has_the_direction_of_the_slip() -> None:
    plant = mounted(replace(ROUND, wear=0.0))
    run(plant, 1.5, 200.0, sideslip_deg=20.0)
    friction_n = 200.0 * predict("1#", 0.3, 200.0, plant.surface_c, 20.0)
    fx, fy = (friction_n * share for share in traction_direction(*slip_velocity(0.8, 0.5, 20.0)[:2]))
    assert (plant.force_x_n, plant.force_y_n) == pytest.approx((fx, fy), rel=2e-3)


def test_braking_slip_turns_friction_and_torque_round() -> None:
    plant = mounted()
    run(plant, 1.0, 200.0, belt_m_s=1.1)
    assert plant.force_x_n < -100.0
    assert plant.drive_torque_nm < -5.0


def test_a_belt_that_does_not_grip_carries_no_friction_and_loads_no_drive() -> None:
    plant = mounted()
    run(plant, 2.0, 200.0)
    rubbing_n = plant.force_x_n
    plant.set_grip(0.0)
    run(plant, 0.1, 200.0)
    assert rubbing_n > 50.0 and plant.force_z_n > 150.0
    assert plant.force_x_n == plant.force_y_n == plant.drive_torque_nm == 0.0
    plant.begin_repeat(1, 1, 1, MIDDLE)
    run(plant, 0.1, 200.0)
    assert plant.force_x_n == 0.0
    plant.set_grip(1.0)
    run(plant, 0.1, 200.0)
    assert plant.force_x_n > 50.0


def test_drive_torque_is_friction_times_radius() -> None:
    plant = mounted()
    run(plant, 1.0, 200.0)
    assert plant.drive_torque_nm == pytest.approx(plant.force_x_n * 0.0005 * plant.diameter_mm)


def test_aligning_moment_is_next_to_nothing_under_drive_slip_and_small_under_sideslip() -> None:
    plant = mounted()
    run(plant, 0.5, 200.0)
    assert abs(plant.moment_z_nm) < 0.02
    run(plant, 0.5, 200.0, sideslip_deg=30.0)
    assert plant.moment_z_nm == pytest.approx(0.001 * plant.force_y_n)
    assert 0.05 < plant.moment_z_nm < 0.3


@pytest.mark.parametrize("sideslip_deg", [0.0, 15.0, -30.0])
def test_power_of_both_drives_is_the_friction_power(sideslip_deg: float) -> None:
    plant = mounted()
    run(plant, 1.0, 200.0, sideslip_deg=sideslip_deg)
    drives_w = plant.drive_torque_nm * WHEEL_RAD_S - plant.belt_force_n * 0.5
    assert drives_w == pytest.approx(plant.mu * plant.force_z_n * plant.slip_m_s, rel=1e-4)


def test_rolling_at_matched_speeds_carries_traction_but_makes_no_heat_or_wear() -> None:
    plant = mounted()
    run(plant, 5.0, 200.0, belt_m_s=0.8)
    assert plant.force_x_n == pytest.approx(200.0 * predict("1#", 0.0, 200.0, 25.0), rel=0.01)
    assert plant.diameter_mm == pytest.approx(90.0, abs=1e-12)
    assert plant.surface_c == pytest.approx(25.0, abs=1e-6)


def test_friction_builds_up_in_the_first_second_of_contact() -> None:
    plant = mounted(replace(ROUND, wear=0.0))
    run(plant, 0.01, 200.0)
    settled = predict("1#", 0.3, 200.0, 25.0)
    assert plant.mu == pytest.approx(0.9 * settled, rel=1e-3)
    run(plant, 1.0, 200.0)
    assert plant.mu == pytest.approx(predict("1#", 0.3, 200.0, plant.surface_c), rel=2.5e-3)


def test_friction_builds_up_again_after_lifting() -> None:
    plant = mounted()
    run(plant, 2.0, 200.0)
    settled = plant.mu
    run(plant, 0.01)
    run(plant, 0.01, 200.0)
    assert plant.mu < 0.92 * settled


def test_new_wheel_runs_in_over_its_first_metres() -> None:
    plant = mounted(replace(ROUND, running_in=1.0, wear=0.0))
    run(plant, 1.5, 200.0)
    fresh = plant.mu / predict("1#", 0.3, 200.0, plant.surface_c)
    run(plant, 160.0, 200.0, dt=0.1)
    worn_in = plant.mu / predict("1#", 0.3, 200.0, plant.surface_c)
    assert fresh == pytest.approx(1.0 + 0.15 * math.exp(-0.045), rel=3e-3)
    assert plant.sliding_m == pytest.approx(48.45)
    assert worn_in == pytest.approx(1.0, abs=2e-3)


def test_a_minute_at_200_n_wears_34_um_off_the_radius() -> None:
    plant = mounted()
    press_mm = press_for(200.0)
    for _ in range(6000):
        lost_mm = 0.5 * (90.0 - plant.diameter_mm)
        rad_s = 1.6 / (0.001 * plant.diameter_mm)
        plant.advance(0.01, rad_s, 0.5, press_mm + lost_mm, 0.0, 0.0, 0.0)
    assert 0.5 * (90.0 - plant.diameter_mm) == pytest.approx(0.034, abs=2e-4)
    assert plant.force_z_n == pytest.approx(200.0, rel=1e-3)


def test_worn_wheel_touches_later_and_runs_slower() -> None:
    plant = mounted(replace(ROUND, wear=0.0))
    plant.install(1, 1, "1#", False, diameter_mm=88.0)
    run(plant, 0.1, 0.0)
    assert plant.slip_m_s == pytest.approx(0.8 * 88.0 / 90.0 - 0.5)
    plant.advance(0.01, WHEEL_RAD_S, 0.5, press_for(200.0), 0.0, 0.0, 0.0)
    loose_n = plant.force_z_n
    plant.advance(0.01, WHEEL_RAD_S, 0.5, press_for(200.0) + 1.0, 0.0, 0.0, 0.0)
    assert loose_n < 120.0
    assert plant.force_z_n == pytest.approx(200.0)


@pytest.mark.parametrize("load_n", [200.0, 400.0])
def test_runout_makes_a_ripple_of_7_to_10_n_once_a_turn(load_n: float) -> None:
    plant = mounted(replace(EXACT, wear=0.0))
    loads: list[float] = []
    while plant.wheel_angle_rev < 3.0 - 1e-9:
        plant.advance(0.0025, WHEEL_RAD_S, 0.8, press_for(load_n), 0.0, 0.0, 0.0)
        loads.append(plant.force_z_n)
    assert 7.0 < max(loads) - min(loads) < 10.0
    mean = sum(loads) / len(loads)
    crossings = sum(a < mean <= b for a, b in pairwise(loads))
    assert crossings in (2, 3)
    assert mean == pytest.approx(load_n, rel=2e-3)


def test_fast_retraction_never_pulls() -> None:
    plant = mounted()
    run(plant, 0.5, 100.0)
    press_mm = press_for(100.0)
    while press_mm > 5.0:
        press_mm -= 2.0
        plant.advance(0.1, WHEEL_RAD_S, 0.5, press_mm, -20.0, 0.0, 0.0)
        assert plant.force_z_n >= 0.0
    assert plant.force_z_n == plant.force_x_n == plant.belt_force_n == 0.0


def test_heater_warms_the_hub_and_then_the_surface() -> None:
    plant = mounted()
    run(plant, 206.0, heater_w=200.0, dt=0.05)
    assert plant.surface_c == pytest.approx(40.0, abs=0.2)
    assert plant.hub_c > 80.0


def test_pre_grind_on_the_calm_rig_leaves_the_surface_basically_unchanged() -> None:
    plant = mounted(replace(ROUND, running_in=1.0))
    run(plant, 240.0, 200.0, belt_m_s=0.6, dt=0.05)
    assert 25.0 < plant.surface_c < 28.5
    assert plant.belt_c < 32.0


def test_pre_grind_on_the_hot_rig_ends_as_worked_out() -> None:
    plant = mounted(replace(ROUND, friction_heat_fraction=0.5, belt_conductance=0.3, wear=0.0))
    run(plant, 240.0, 200.0, belt_m_s=0.6, dt=0.05)
    assert plant.surface_c == pytest.approx(43.7, abs=0.2)


@pytest.mark.parametrize("dt", [0.001, 0.0173, 0.05, 0.1])
def test_result_does_not_depend_on_the_length_of_the_tick(dt: float) -> None:
    reference, other = mounted(), mounted()
    run(reference, 17.3, 300.0, heater_w=100.0)
    run(other, 17.3, 300.0, heater_w=100.0, dt=dt)
    assert other.surface_c == pytest.approx(reference.surface_c, abs=0.05)
    assert other.hub_c == pytest.approx(reference.hub_c, abs=0.03)
    assert other.diameter_mm == pytest.approx(reference.diameter_mm, abs=2e-4)
    assert other.sliding_m == pytest.approx(reference.sliding_m, rel=1e-3)
    assert other.mu == pytest.approx(reference.mu, rel=1e-3)


def test_new_wheel_is_cold_new_and_keeps_the_hubs_temperature() -> None:
    plant = mounted()
    run(plant, 120.0, 200.0, dt=0.05, heater_w=200.0)
    hub_c, belt_c = plant.hub_c, plant.belt_c
    plant.install(1, 2, "1#", False)
    assert (plant.hub_c, plant.belt_c) == (hub_c, belt_c)
    assert (plant.surface_c, plant.heat.cells_c) == (25.0, [25.0] * 10)
    assert (plant.diameter_mm, plant.sliding_m, plant.force_z_n) == (90.0, 0.0, 0.0)


def test_new_specimen_starts_with_everything_at_ambient() -> None:
    plant = mounted()
    run(plant, 60.0, 200.0, dt=0.05, heater_w=200.0)
    plant.install(2, 1, "2#", True)
    assert (plant.hub_c, plant.belt_c, plant.surface_c, plant.load_cell.cell_c) == (25.0,) * 4


def test_installing_a_compound_without_a_usable_law_is_refused_and_changes_nothing() -> None:
    plant = mounted()
    run(plant, 5.0, 200.0)
    plant.setting = LawSetting(stated=lambda name: StatedLaw("v2", {"a": 1.0}))
    with pytest.raises(ValueError, match="all of them"):
        plant.install(1, 2, "NBR", True)
    assert plant.sliding_m > 1.0


def test_a_compound_rubs_by_the_law_of_its_file() -> None:
    figures = {"a": 0.6, "v0": 0.3, "n": 0.2, "n0": 200.0, "m": -0.1}
    plant = Plant(ROUND, 1)
    plant.setting = LawSetting(stated=lambda name: StatedLaw("power", figures, 0.5) if name == "own" else None)
    plant.install(1, 1, "own", True)
    assert plant.truth(25.0, 200.0, 0.3, 0.0)["model"] == 0.6
    assert plant.truth(25.0, 200.0, 0.3, 30.0)["model"] == pytest.approx(0.6 * 1.25)
    plant.install(1, 2, "other", True)
    assert plant.truth(25.0, 200.0, 0.3, 0.0)["model"] == FrictionModel("1#").mu(25.0, 200.0, 0.3)


def test_repeat_without_a_wheel_is_refused() -> None:
    with pytest.raises(RuntimeError, match="install"):
        Plant(ROUND, 1).begin_repeat(1, 1, 1, MIDDLE)


def test_without_noise_the_sensors_read_the_truth() -> None:
    plant = mounted()
    run(plant, 3.0, 200.0, belt_m_s=0.8, sideslip_deg=10.0)
    truth = (plant.force_x_n, plant.force_y_n, plant.force_z_n, plant.moment_z_nm)
    assert plant.forces_measured(3.0) == truth
    assert plant.surface_measured_c(3.0) == pytest.approx(plant.surface_c, abs=0.05)
    assert plant.controller_measured_c(3.0) == pytest.approx(plant.hub_c, abs=1e-3)
    assert plant.wheel_speed.measure(0.8) == 0.8
    assert plant.belt_speed.measure(0.5) == 0.5


def test_thermometer_bias_is_the_sessions_and_within_a_kelvin() -> None:
    biases: list[float] = []
    for seed in range(40):
        plant = mounted(SimParameters(), seed=seed)
        biases.append(sum(plant.surface_measured_c(0.0) for _ in range(400)) / 400.0 - plant.surface_c)
    assert max(map(abs, biases)) < 1.03
    assert min(biases) < -0.7
    assert max(biases) > 0.7


def measured(plant: Plant) -> list[tuple[float, ...]]:
    """A short repeat as the sensors show it."""
    rows: list[tuple[float, ...]] = []
    for i in range(100):
        plant.advance(0.01, WHEEL_RAD_S, 0.5, press_for(200.0), 0.0, 0.0, 0.0)
        speeds = (plant.wheel_speed.measure(0.8), plant.belt_speed.measure(0.5))
        thermometers = (plant.surface_measured_c(0.01 * i), plant.controller_measured_c(0.01 * i))
        rows.append((*plant.forces_measured(0.01 * i), *thermometers, *speeds))
    return rows


def test_same_seed_gives_the_same_readings_and_another_gives_others() -> None:
    readings: list[list[tuple[float, ...]]] = []
    for seed in (1, 1, 2):
        plant = mounted(SimParameters(), seed=seed)
        plant.begin_repeat(1, 1, 1, MIDDLE)
        readings.append(measured(plant))
    assert readings[0] == readings[1]
    assert readings[0] != readings[2]


def test_random_numbers_of_a_repeat_do_not_depend_on_its_past() -> None:
    direct, late = mounted(SimParameters()), mounted(SimParameters())
    measured(late)
    late.begin_repeat(1, 1, 1, MIDDLE)
    measured(late)
    late.install(1, 1, "1#", True)
    for plant in (direct, late):
        plant.begin_repeat(2, 3, 1, MIDDLE)
    assert measured(direct) == measured(late)


@pytest.mark.parametrize("place", [(2, 1, 1), (1, 2, 1), (1, 1, 2)])
def test_condition_repeat_and_attempt_each_draw_a_repeat_anew(place: tuple[int, int, int]) -> None:
    plant = mounted(SimParameters())
    plant.begin_repeat(1, 1, 1, MIDDLE)
    first = plant.run_factor
    plant.begin_repeat(*place, MIDDLE)
    assert plant.run_factor != first


def test_a_setting_has_one_factor_in_every_place_and_on_every_wheel() -> None:
    plant = mounted(SimParameters())
    plant.begin_repeat(4, 1, 1, MIDDLE)
    wheel, setting = plant.wheel_factor, plant.condition_factor
    plant.begin_repeat(9, 2, 3, MIDDLE)
    assert (plant.wheel_factor, plant.condition_factor) == (wheel, setting)
    plant.install(1, 2, "1#", False)
    plant.begin_repeat(12, 1, 1, MIDDLE)
    assert plant.condition_factor == setting and plant.wheel_factor != wheel
    plant.begin_repeat(12, 1, 1, MIDDLE._replace(load_n=100.0))
    assert plant.condition_factor != setting


def test_resumed_wheel_has_its_scatter_diameter_and_distance_again() -> None:
    plant = mounted(SimParameters())
    run(plant, 20.0, 200.0)
    resumed = Plant(SimParameters(), 1)
    resumed.install(1, 1, "1#", True, diameter_mm=plant.cold_mm, sliding_m=plant.sliding_m)
    assert resumed.wheel_factor == plant.wheel_factor
    assert (resumed.cold_mm, resumed.sliding_m) == (plant.cold_mm, plant.sliding_m)
    assert resumed.diameter_mm == resumed.cold_mm < plant.diameter_mm, "it has cooled down meanwhile"


def test_contact_loses_three_percent_of_its_load_in_each_decade_at_held_depth() -> None:
    plant = mounted(replace(ROUND, relaxation=1.0))
    loads: list[float] = []
    for seconds in (10.0, 90.0, 900.0):
        run(plant, seconds, 200.0, belt_m_s=0.8, dt=0.05)
        loads.append(plant.force_z_n)
    assert loads[0] == pytest.approx(200.0 * (1.0 - 0.03 * 1.72), rel=2e-3)
    assert [(a - b) / 200.0 for a, b in pairwise(loads)] == pytest.approx([0.03, 0.03], abs=2e-3)


def test_relaxed_rubber_recovers_when_it_is_left_alone() -> None:
    plant = mounted(replace(ROUND, relaxation=1.0))
    run(plant, 100.0, 200.0, belt_m_s=0.8, dt=0.05)
    relaxed_n = plant.force_z_n
    again: list[float] = []
    for apart_s in (1.0, 2000.0):
        twin = copy.deepcopy(plant)
        run(twin, apart_s, dt=0.1)
        run(twin, 0.01, 200.0, belt_m_s=0.8)
        again.append(twin.force_z_n)
    assert relaxed_n + 1.0 < again[0] < again[1] < 200.0
    assert again[1] == pytest.approx(200.0, abs=0.5)


def test_another_wheel_knows_nothing_of_the_last_one_s_load() -> None:
    plant = mounted(replace(ROUND, relaxation=1.0))
    run(plant, 100.0, 200.0, belt_m_s=0.8, dt=0.05)
    plant.install(1, 2, "1#", False)
    run(plant, 0.01, 200.0)
    assert plant.force_z_n == pytest.approx(200.0, rel=1e-3)


def test_contact_softens_by_the_mean_temperature_of_the_rubber() -> None:
    plant = mounted(replace(ROUND, softening=1.0))
    run(plant, 900.0, heater_w=60.0, dt=0.1)
    cells = plant.heat.cells_c
    run(plant, 0.01, 200.0)
    softened = math.log(200.0 / plant.force_z_n) / 0.004
    assert softened > 30.0 and min(cells) - 25.0 < softened < max(cells) - 25.0


def test_heated_wheel_grows_touches_sooner_and_runs_faster_and_its_cold_size_stays() -> None:
    plant = mounted(replace(ROUND, growth=1.0))
    run(plant, 500.0, heater_w=60.0, dt=0.1)
    grown_mm = 0.5 * (plant.diameter_mm - 90.0)
    layer_k = (grown_mm - 37.0 * 2.3e-5 * (plant.hub_c - 25.0)) / (8.0 * 4e-4)
    assert min(plant.heat.cells_c) - 25.0 < layer_k < max(plant.heat.cells_c) - 25.0
    assert 0.1 < grown_mm < 0.3 and plant.cold_mm == 90.0
    assert plant.slip_m_s == pytest.approx(0.8 * plant.diameter_mm / 90.0 - 0.5)
    plant.advance(0.01, WHEEL_RAD_S, 0.5, 10.0, 0.0, 0.0, 0.0)
    assert plant.force_z_n == pytest.approx(ContactModel(ContactParameters()).load_n(grown_mm, 0.0), rel=1e-3)


def test_wear_takes_as_much_of_the_cold_as_of_the_warm_wheel() -> None:
    plant = mounted(replace(ROUND, growth=1.0))
    run(plant, 600.0, heater_w=60.0, dt=0.1)
    warm_mm = plant.diameter_mm
    run(plant, 0.02, 200.0)
    worn_mm = 90.0 - plant.cold_mm
    assert worn_mm > 0.0 and warm_mm - plant.diameter_mm == pytest.approx(worn_mm, rel=1e-2)


def test_without_the_rubber_s_effects_nothing_of_them_is_there() -> None:
    plant = mounted()
    run(plant, 300.0, heater_w=100.0, dt=0.1)
    run(plant, 30.0, 200.0, belt_m_s=0.8, dt=0.05)
    assert plant.diameter_mm == plant.cold_mm
    assert plant.force_z_n == pytest.approx(200.0, rel=1e-6)


def test_press_position_follows_the_contact_whatever_its_past() -> None:
    plant = mounted(SimParameters(noise=0.0, relaxation=1.0, softening=1.0))
    run(plant, 60.0, 300.0, heater_w=100.0, dt=0.01)
    wanted_mm = plant.press_at_mm(350.0)
    plant.advance(0.001, 0.0, 0.0, wanted_mm, 0.0, 0.0, 0.0)
    assert plant.force_z_n == pytest.approx(350.0, rel=1e-3)


def test_scatter_multiplies_the_friction() -> None:
    plant = mounted(replace(SimParameters(noise=0.0, running_in=0.0, ambient=25.0), contact=ROUND.contact))
    plant.begin_repeat(1, 1, 1, MIDDLE)
    ratios: list[float] = []
    for _ in range(6000):
        plant.advance(0.01, WHEEL_RAD_S, 0.5, press_for(200.0), 0.0, 0.0, 0.0)
        ratios.append(plant.mu / predict("1#", plant.slip_m_s, plant.force_z_n, plant.surface_c))
    fixed = plant.wheel_factor * plant.condition_factor * plant.run_factor
    assert fixed != 1.0
    assert sum(ratios[200:]) / len(ratios[200:]) == pytest.approx(fixed, rel=3e-3)


def test_copy_continues_identically_and_independently() -> None:
    plant = mounted(SimParameters())
    plant.begin_repeat(1, 1, 1, MIDDLE)
    measured(plant)
    twin = copy.deepcopy(plant)
    before = (twin.surface_c, twin.diameter_mm, twin.wheel_angle_rev)
    ahead = measured(plant)
    assert (twin.surface_c, twin.diameter_mm, twin.wheel_angle_rev) == before
    assert measured(twin) == ahead


@pytest.mark.parametrize(
    "wrong",
    [
        {"noise": -1.0},
        {"scatter": math.nan},
        {"friction_heat_fraction": 1.5},
        {"friction_model": "x"},
        {"ambient": 90.0},
    ],
)
def test_parameters_out_of_range_are_refused_by_name(wrong: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        SimParameters(**wrong)  # type: ignore[arg-type]


def test_group_parameters_out_of_range_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"ContactParameters\.reference_stiffness"):
        ContactParameters(reference_stiffness=0.0)
    with pytest.raises(ValueError, match=r"ContactParameters\.relaxation"):
        ContactParameters(relaxation=0.2)
    with pytest.raises(ValueError, match=r"DriveParameters\.screw_efficiency"):
        DriveParameters(screw_efficiency=0.52)


def test_stick_slip_swings_friction_about_its_mean() -> None:
    steady, sticking = mounted(), mounted(replace(ROUND, stick_slip=0.1, stick_slip_frequency=5.0))
    run(steady, 2.0, 200.0)
    run(sticking, 2.0, 200.0)
    shares: list[float] = []
    for _ in range(200):
        run(steady, 0.01, 200.0)
        run(sticking, 0.01, 200.0)
        shares.append(sticking.mu / steady.mu)
    assert min(shares) == pytest.approx(0.9, abs=0.02) and max(shares) == pytest.approx(1.1, abs=0.02)
    assert sum(shares) / len(shares) == pytest.approx(1.0, abs=0.02)


def test_stick_slip_needs_slip() -> None:
    steady, sticking = mounted(), mounted(replace(ROUND, stick_slip=0.1))
    run(steady, 2.0, 200.0, belt_m_s=0.8)
    run(sticking, 2.0, 200.0, belt_m_s=0.8)
    assert sticking.mu == steady.mu
