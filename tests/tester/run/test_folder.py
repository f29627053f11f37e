"""Runs in parts: a simulated rig can exist several times, a real one cannot."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tester.inputs.recipe.loader import load_checked
from tester.kinds import load_rig
from tester.run.folder import work_of
from tester.run.kind_lookup import recipe_part
from tests.tester.kinds.wheel_on_belt.run.test_runs import THREE


@pytest.mark.parametrize(("simulated", "parts"), [(True, 3), (False, 1)])
def test_only_a_simulated_rig_gets_a_part_for_each_specimen(simulated: bool, parts: int) -> None:
    rig = load_rig("sim")
    work = work_of(load_checked(THREE, rig, recipe_part(rig)).recipe, replace(rig, simulated=simulated))
    assert len(work.parts) == parts
    assert simulated or work.parts[0].plan is work.plan
