"""Levels of load and friction that follow from other facts of the rig file."""

from __future__ import annotations

import pytest

from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.control.loops import LoadLoop
from tester.kinds.wheel_on_belt.image.process_image import Demand, Press, Readings
from tester.kinds.wheel_on_belt.interlocks.contact_force import depth_mm
from tester.kinds.wheel_on_belt.interlocks.load import TOUCH_MARGIN_MM

HARM_N = 500.0
STIFFER = 1.3
"""As the corners of the fault campaign."""
RUNOUT_MM = 0.025


def test_a_wheel_that_its_first_contact_may_still_find_is_no_frozen_cell() -> None:
    rig = load_rig("sim")
    p, geometry = rig.interlocks, rig.geometry
    found_mm = 0.5 * p.first_contact_sweep * geometry.wheel_diameter_mm + p.first_contact_place_mm
    demand, readings = Demand(), Readings()
    demand.press, demand.load_n = Press.LOAD, p.first_contact_load_n
    readings.force_z_n, readings.press_mm = 0.0, geometry.touch_mm
    comes_mm_s = LoadLoop().velocity(demand, readings, 1.0 / rig.scan.enabled_hz, rig.loops.load)
    assert 0.0 < comes_mm_s < 1.0
    assert found_mm + comes_mm_s / rig.scan.enabled_hz < p.touch_margin_mm


def test_a_known_contact_that_has_shrunk_and_is_seen_late_is_no_frozen_cell() -> None:
    rig = load_rig("sim")
    p, limits, wear = rig.interlocks, rig.limits, rig.wear
    late_mm = rig.loops.load.touch_speed_mm_s * (p.stale_cell_s + p.stale_cell_delay_s)
    warmer_k = 0.5 * (limits.jacket_c + limits.surface_c) - wear.reference_c
    shrunk_mm = 0.5 * (wear.growth_mm_per_k + wear.growth_uncertainty_mm_per_k) * warmer_k
    assert late_mm + shrunk_mm + RUNOUT_MM < p.touch_margin_mm


def test_the_load_growing_under_a_dead_cell_does_no_harm() -> None:
    stiff = STIFFER * load_rig("sim").loops.load.stiffness_n_per_mm
    hardest_mm = float((TOUCH_MARGIN_MM.hardest or "").removesuffix(" mm"))
    assert depth_mm(HARM_N, stiff) > hardest_mm
    assert depth_mm(325.0, stiff) == pytest.approx(hardest_mm, rel=0.01), "what the table says of it"
