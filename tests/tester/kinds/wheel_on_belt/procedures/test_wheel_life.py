"""The wheel's two diameters: cold on record, warm on the machine."""

from __future__ import annotations

import math

import pytest

from tester.kinds.wheel_on_belt.image.process_image import Readings
from tester.kinds.wheel_on_belt.procedures.wheel_life import WheelLife
from tests.tester.inputs.recipe.texts import rig
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Simulation

WEAR = rig().wear


def shown(wheel: WheelLife, hub_c: float, surface_c: float, *, surface_valid: bool = True) -> Readings:
    r = Readings(hub_c=hub_c, surface_c=surface_c, surface_valid=surface_valid, jacket_valid=True)
    wheel.show(r, WEAR)
    return r


def test_a_wheel_at_the_reference_temperature_has_its_cold_diameter() -> None:
    r = shown(WheelLife(installed_mm=90.0, loss_mm=0.5), WEAR.reference_c, WEAR.reference_c)
    assert r.diameter_mm == r.cold_mm == 89.5


def test_a_warm_wheel_is_larger_by_its_growth_and_keeps_its_cold_diameter() -> None:
    wheel = WheelLife(installed_mm=90.0, loss_mm=0.5)
    r = shown(wheel, WEAR.reference_c + 60.0, WEAR.reference_c + 20.0)
    assert r.diameter_mm == pytest.approx(89.5 + 40.0 * WEAR.growth_mm_per_k)
    assert r.cold_mm == wheel.cold_mm == 89.5


def test_growth_is_unsure_by_its_stated_uncertainty_and_by_the_rubber_that_is_gone() -> None:
    new, worn = WheelLife(installed_mm=90.0), WheelLife(installed_mm=90.0, loss_mm=8.0)
    assert new.growth_u_mm_per_k(WEAR, 8.0) == WEAR.growth_uncertainty_mm_per_k
    assert worn.growth_u_mm_per_k(WEAR, 8.0) == pytest.approx(
        WEAR.growth_uncertainty_mm_per_k + 0.5 * WEAR.growth_mm_per_k
    )


def test_a_wheel_with_an_unknown_surface_keeps_its_thermal_growth() -> None:
    wheel = WheelLife(installed_mm=90.0)
    warm_mm = shown(wheel, 63.0, 43.0).diameter_mm
    assert shown(wheel, 63.0, 300.0, surface_valid=False).diameter_mm == warm_mm


@pytest.mark.parametrize("hub_c", [math.nan, math.inf])
def test_a_temperature_that_is_no_number_changes_nothing(hub_c: float) -> None:
    assert shown(WheelLife(installed_mm=90.0), hub_c, 43.0).diameter_mm == 90.0


def test_wear_takes_from_both_diameters_alike() -> None:
    wheel = WheelLife(installed_mm=90.0)
    before = shown(wheel, 63.0, 43.0)
    wheel.slide(200.0, 0.3, 60.0, 0.08)
    after = shown(wheel, 63.0, 43.0)
    assert before.diameter_mm - after.diameter_mm == pytest.approx(wheel.loss_mm) and wheel.loss_mm > 0.0


def test_a_heated_wheel_of_a_run_is_believed_as_large_as_it_is() -> None:
    hot = SHORT.replace("25 degC", "50 degC")
    run = Simulation(hot, ("sim.noise=0",)).until(lambda s: s.world.plant.surface_c > 45.0)
    plant, r = run.world.plant, run.ctx.readings
    grown_mm = plant.diameter_mm - plant.cold_mm
    assert grown_mm > 0.15
    assert r.diameter_mm - r.cold_mm == pytest.approx(grown_mm, abs=0.25 * grown_mm)
