"""The thermometer against the hub's sensor after a soak, and a slip that the diameter leaves uncertain."""

from __future__ import annotations

from math import nan

import pytest

from tester.analysis.flags import SLIP_UNSURE
from tester.analysis.results import SoakCheck
from tester.kinds.wheel_on_belt.procedures.on_record import (
    HUB_K,
    MODEL_SHARE,
    THERMOMETER_K,
    WheelResults,
    allowed_k,
    soak_check,
)
from tester.store.recorder import NullRecorder
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Bench, condition_of, make_bench


def soaked(surface_c: float, *, model_c: float = 40.0, hub_c: float = 52.0, valid: bool = True) -> SoakCheck | None:
    """Return the finding on a rig with these readings."""
    bench: Bench = make_bench()
    ctx = bench.ctx
    ctx.observer.surface_c = model_c
    ctx.readings.hub_c, ctx.readings.jacket_valid = hub_c, valid
    ctx.gates.surface.slow_c = surface_c
    return soak_check(ctx, 3)


def test_the_allowance_is_the_sum_of_three_terms() -> None:
    assert allowed_k(52.0, 40.0) == pytest.approx(THERMOMETER_K + HUB_K + 12.0 * MODEL_SHARE)
    assert THERMOMETER_K == 1.0


@pytest.mark.parametrize(("surface_c", "agrees"), [(40.0, True), (43.0, True), (44.0, False), (36.0, False)])
def test_a_thermometer_agrees_within_the_allowance(surface_c: float, agrees: bool) -> None:
    found = soaked(surface_c)
    assert found is not None and (found.condition, found.off_k) == (3, surface_c - 40.0)
    assert found.agrees == agrees


def test_near_the_air_less_is_allowed() -> None:
    found = soaked(28.0, model_c=25.0, hub_c=27.0)
    assert found is not None and not found.agrees


def test_without_a_hub_sensor_nothing_is_found() -> None:
    assert soaked(40.0, valid=False) is None


def test_without_a_model_nothing_is_found() -> None:
    assert soaked(40.0, model_c=nan) is None


@pytest.mark.parametrize(("slip_m_s", "u_mm", "doubted"), [(0.1, 0.3, False), (0.1, 0.4, True), (0.3, 0.6, False),
                                                           (0.3, 0.7, True)])  # fmt: skip
def test_a_slip_is_not_sure_where_the_diameter_is_not(slip_m_s: float, u_mm: float, doubted: bool) -> None:
    """At 0.8 m/s and 90 mm, 3 mm/s are 0.34 mm of diameter, and 2 % of 0.3 m/s are 0.68 mm."""
    ctx, step = make_bench().ctx, condition_of(SHORT.replace("300 mm/s", f"{1e3 * slip_m_s:g} mm/s"))
    ctx.wheel.followed = True
    ctx.wheel.estimate.begin(0.3, 0.0, 0.0, 0.0)
    ctx.wheel.estimate.measured(0.0, u_mm)
    assert WheelResults(NullRecorder()).doubts(ctx, step) == ((SLIP_UNSURE,) if doubted else ())
