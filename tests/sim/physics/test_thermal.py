"""Heat model against the worked figures of the rig and against closed forms.

The worked figures hold at 25 degC ambient; heat-up is with the hub held at its 150 degC limit once there.
"""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from sim.physics.friction import FrictionModel
from sim.physics.parameters import ThermalParameters, WheelParameters
from sim.physics.thermal import CALM_STEP_S, MAX_STEP_S, ThermalModel, ThermalState, cell_thicknesses
from tests.sim.physics.thermal_example import surface_temperature

AMBIENT_C = 25.0
STEP_S = 0.05
LOSSLESS = replace(
    ThermalParameters(), film_stopped=0.0, film_rotating=0.0, film_sides=0.0, hub_to_shaft=0.0, belt_to_air=0.0
)


def build(share: float = 0.06, belt_w_k: float = 0.06, thermal: ThermalParameters | None = None) -> ThermalModel:
    return ThermalModel(WheelParameters(), thermal or ThermalParameters(), share, belt_w_k)


def wait(model: ThermalModel, state: ThermalState, seconds: float, rotating: bool = False) -> None:
    model.step(state, seconds, 0.0, 0.0, AMBIENT_C, 0.0, rotating)


def slide(
    model: ThermalModel, state: ThermalState, compound: str, load_n: float, slip_m_s: float, seconds: float
) -> None:
    friction = FrictionModel(compound)
    for _ in range(round(seconds / STEP_S)):
        power_w = friction.mu(state.surface_c, load_n, slip_m_s) * load_n * slip_m_s
        model.step(state, STEP_S, 0.0, power_w, AMBIENT_C, 1.0, True)


def soak_rolling(model: ThermalModel, hub_c: float) -> ThermalState:
    """Roll in contact with the hub held at a temperature until nothing changes any more."""
    state = model.state(AMBIENT_C)
    for _ in range(1800):
        state.hub_c = hub_c
        model.step(state, 1.0, 0.0, 0.0, AMBIENT_C, 1.0, True)
    return state


def seconds_to_warm(state: ThermalState, model: ThermalModel, compound: str, load_n: float, slip_m_s: float) -> float:
    """Slide until the surface is 2 K warmer; the hub is held."""
    start_c, hub_c, t = state.surface_c, state.hub_c, 0.0
    while state.surface_c < start_c + 2.0:
        slide(model, state, compound, load_n, slip_m_s, STEP_S)
        state.hub_c = hub_c
        t += STEP_S
    return t


def test_heat_up_at_200_w_reaches_the_test_temperatures_when_worked_out() -> None:
    model, reached = build(), {}
    state, t = model.state(AMBIENT_C), 0.0
    goals = [40.0, 55.0, 70.0, 85.0]
    while len(reached) < len(goals):
        heater_w = 200.0 if state.hub_c < 150.0 else 0.0
        model.step(state, STEP_S, heater_w, 0.0, AMBIENT_C, 0.0, True)
        t += STEP_S
        if state.surface_c >= goals[len(reached)]:
            reached[goals[len(reached)]] = t
    assert list(reached.values()) == pytest.approx([206.0, 293.0, 371.0, 471.0], abs=1.5)


def test_pre_grind_on_the_hot_rig_ends_warm_and_needs_more_than_the_rest() -> None:
    model = build(0.5, 0.3)
    state = model.state(AMBIENT_C)
    slide(model, state, "1#", 200.0, 0.2, 240.0)
    assert state.surface_c == pytest.approx(43.7, abs=0.15)
    wait(model, state, 1200.0)
    assert state.surface_c == pytest.approx(26.4, abs=0.1)


def test_wheel_soaked_through_at_85_is_far_from_cold_after_20_minutes_of_standing() -> None:
    model = build()
    state = model.state(AMBIENT_C)
    state.hub_c = 85.0
    state.set_rubber(85.0)
    wait(model, state, 1200.0)
    assert state.surface_c == pytest.approx(54.4, abs=0.2)


def test_sliding_warms_the_surface_by_2_k_in_about_18_s_at_200_n() -> None:
    model = build()
    assert seconds_to_warm(model.state(AMBIENT_C), model, "1#", 200.0, 0.3) == pytest.approx(18.5, abs=1.0)


def test_sliding_warms_the_surface_by_2_k_in_about_5_s_at_400_n() -> None:
    model = build()
    assert seconds_to_warm(model.state(AMBIENT_C), model, "1#", 400.0, 0.3) == pytest.approx(5.5, abs=0.5)


def test_sliding_warms_a_soaked_3_by_2_k_in_about_1_s() -> None:
    model = build()
    state = soak_rolling(model, 135.5)
    assert state.surface_c == pytest.approx(85.0, abs=0.2)
    assert seconds_to_warm(state, model, "3#", 200.0, 0.4) == pytest.approx(1.3, abs=0.3)


def test_sliding_on_the_hot_rig_warms_the_surface_by_2_k_in_about_a_fifth_of_a_second() -> None:
    model = build(0.5, 0.3)
    assert seconds_to_warm(model.state(AMBIENT_C), model, "1#", 200.0, 0.3) == pytest.approx(0.2, abs=0.11)


def test_85_degc_can_be_held_in_contact_with_the_hub_at_its_limit_only_on_the_calm_rig() -> None:
    assert soak_rolling(build(), 150.0).surface_c > 90.0
    assert soak_rolling(build(0.5, 0.3), 150.0).surface_c < 70.5


@pytest.mark.parametrize(("seconds", "tolerance"), [(0.5, 0.06), (1.0, 0.04), (2.0, 0.03), (5.0, 0.03), (10.0, 0.03)])
def test_surface_rises_with_the_square_root_of_time(seconds: float, tolerance: float) -> None:
    model = build(1.0, 0.0, LOSSLESS)
    state = model.state(AMBIENT_C)
    area_m2 = math.pi * 0.09 * 0.03
    flux_w_m2 = 5000.0
    model.step(state, seconds, 0.0, flux_w_m2 * area_m2, AMBIENT_C, 1.0, True)
    effusivity = math.sqrt(0.25 * 1120.0 * 1850.0)
    expected = 2.0 * flux_w_m2 * math.sqrt(seconds / math.pi) / effusivity
    rise = surface_temperature(model, state, flux_w_m2 * area_m2, AMBIENT_C, 1.0, True) - AMBIENT_C
    assert rise == pytest.approx(expected, rel=tolerance)


def stored_j(model: ThermalModel, state: ThermalState) -> float:
    """Heat stored above ambient, from the parameters and the geometry alone."""
    p, t = ThermalParameters(), ThermalState(model.cells, AMBIENT_C)
    radius_m, heat = 0.037, p.hub_capacity * (state.hub_c - t.hub_c) + p.belt_capacity * (state.belt_c - t.belt_c)
    for thick_mm, cell_c in zip(cell_thicknesses(8.0, 10, 0.12), state.cells_c, strict=True):
        outer_m = radius_m + 1e-3 * thick_mm
        volume_m3 = math.pi * (outer_m**2 - radius_m**2) * 0.03
        heat += p.density * p.heat_capacity * volume_m3 * (cell_c - AMBIENT_C)
        radius_m = outer_m
    return heat


def test_without_losses_all_heat_put_in_is_stored() -> None:
    model = build(0.3, 0.2, LOSSLESS)
    state = model.state(AMBIENT_C)
    model.step(state, 300.0, 200.0, 0.0, AMBIENT_C, 0.0, True)
    model.step(state, 120.0, 150.0, 40.0, AMBIENT_C, 1.0, True)
    model.step(state, 77.77, 0.0, 60.0, AMBIENT_C, 0.4, False)
    given_j = 300.0 * 200.0 + 120.0 * 190.0 + 77.77 * 60.0
    assert stored_j(model, state) == pytest.approx(given_j, rel=1e-9)


@pytest.mark.parametrize("touching", [False, True])
def test_without_losses_all_heat_put_in_is_stored_by_implicit_steps_too(touching: bool) -> None:
    model = build(0.3, 0.2, LOSSLESS)
    state = model.state(AMBIENT_C)
    for _ in range(1000):
        model.calm_step(state, 150.0, 40.0 if touching else 0.0, AMBIENT_C, touching, False)
    given_j = 1000 * CALM_STEP_S * (190.0 if touching else 150.0)
    assert stored_j(model, state) == pytest.approx(given_j, rel=1e-9)


@pytest.mark.parametrize("rotating", [False, True])
@pytest.mark.parametrize("touching", [False, True])
def test_implicit_steps_agree_with_explicit_ones_where_nothing_is_sudden(touching: bool, rotating: bool) -> None:
    model = build(0.5, 0.3)
    one, other = model.state(AMBIENT_C), model.state(AMBIENT_C)
    for _ in range(1500):
        friction_w = 0.5 if touching else 0.0
        model.step(one, CALM_STEP_S, 200.0, friction_w, AMBIENT_C, float(touching), rotating)
        model.calm_step(other, 200.0, friction_w, AMBIENT_C, touching, rotating)
        surface_c = surface_temperature(model, one, friction_w, AMBIENT_C, float(touching), rotating)
        assert other.surface_c == pytest.approx(surface_c, abs=0.02)
        assert other.hub_c == pytest.approx(one.hub_c, abs=0.02)
        assert other.belt_c == pytest.approx(one.belt_c, abs=0.01)
    assert one.surface_c > AMBIENT_C + 10.0


def test_at_ambient_temperature_nothing_changes() -> None:
    model = build()
    state = model.state(AMBIENT_C)
    model.step(state, 1000.0, 0.0, 0.0, AMBIENT_C, 1.0, True)
    assert [state.hub_c, state.belt_c, state.surface_c, *state.cells_c] == pytest.approx([AMBIENT_C] * 13)


def test_result_hardly_depends_on_how_the_time_is_cut() -> None:
    model = build()
    whole, cut = model.state(AMBIENT_C), model.state(AMBIENT_C)
    model.step(whole, 60.0, 200.0, 40.0, AMBIENT_C, 1.0, True)
    for i in range(1200):
        dt = 0.03 if i % 2 else 0.07
        model.step(cut, dt, 200.0, 40.0, AMBIENT_C, 1.0, True)
    assert cut.surface_c == pytest.approx(whole.surface_c, abs=0.01)
    assert cut.hub_c == pytest.approx(whole.hub_c, abs=0.01)


def test_finer_cells_change_the_figures_by_less_than_a_few_percent() -> None:
    coarse, fine = build(), build(thermal=replace(ThermalParameters(), cells=30, outer_cell=0.05))
    rises = []
    for model in (coarse, fine):
        state = model.state(AMBIENT_C)
        slide(model, state, "1#", 200.0, 0.3, 10.0)
        rises.append(state.surface_c - AMBIENT_C)
    assert rises[0] == pytest.approx(rises[1], rel=0.03)


def test_cells_shrink_outward_and_fill_the_layer() -> None:
    thick = cell_thicknesses(8.0, 10, 0.12)
    assert sum(thick) == pytest.approx(8.0)
    assert thick[-1] == pytest.approx(0.12)
    assert thick == sorted(thick, reverse=True)


def test_cells_are_equal_where_the_outer_one_fills_the_layer_already() -> None:
    assert cell_thicknesses(1.0, 4, 0.5) == [0.25] * 4


def test_step_is_shortened_where_the_cells_need_it() -> None:
    assert build().step_s == MAX_STEP_S
    thin = build(thermal=replace(ThermalParameters(), outer_cell=0.02))
    assert thin.step_s < 0.01
    state = thin.state(AMBIENT_C)
    slide(thin, state, "1#", 200.0, 0.3, 2.0)
    assert AMBIENT_C < state.surface_c < AMBIENT_C + 2.0


@pytest.mark.parametrize("belt_w_k", [0.0, 0.06, 0.3, 5.0])
def test_no_node_overshoots_its_neighbours(belt_w_k: float) -> None:
    model = build(0.5, belt_w_k)
    state = model.state(AMBIENT_C)
    state.set_rubber(85.0)
    for _ in range(400):
        before = [state.hub_c, *state.cells_c, AMBIENT_C, state.belt_c]
        model.step(state, model.step_s, 0.0, 0.0, AMBIENT_C, 1.0, True)
        after = [state.hub_c, *state.cells_c]
        assert max(after) <= max(before) + 1e-9
        assert min(after) >= min(before) - 1e-9


def test_turning_wheel_cools_faster_than_a_standing_one() -> None:
    model = build()
    still, turning = model.state(AMBIENT_C), model.state(AMBIENT_C)
    for state, rotating in ((still, False), (turning, True)):
        state.set_rubber(85.0)
        wait(model, state, 300.0, rotating)
    assert turning.surface_c < still.surface_c - 1.0
