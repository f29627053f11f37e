"""Recipes of a plain machine: steps, estimates, limits, and their remaining steps."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tester.inputs.recipe.plain_recipe import Mount
from tester.inputs.recipe.plan import ConditionStep, Mounted, Stand
from tester.inputs.recipe.plan_text import lines
from tests.tester.machine.plain.bench import RECIPE, BenchRuns, bench_plan, bench_rig

PART = BenchRuns.part


def steps_of(text: str = RECIPE) -> list[object]:
    return [(step.specimen, step.piece) if isinstance(step, Mount) else getattr(step, "condition", None)
            for step in bench_plan(text).steps]  # fmt: skip


def test_each_replicate_of_a_specimen_is_put_on_once_and_goes_through_every_condition() -> None:
    assert steps_of() == [(1, 1), 1, 2, (2, 2), 3, 4]
    twice = RECIPE + "replicates: 2\n"
    assert steps_of(twice) == [(1, 1), 1, 2, (1, 2), 3, 4, (2, 3), 5, 6, (2, 4), 7, 8]
    rows = [step.row for step in bench_plan(twice).conditions()]
    assert rows == [1, 2, 1, 2, 3, 4, 3, 4]


def test_the_estimate_counts_collecting_and_the_time_between() -> None:
    plan, rig = bench_plan(), bench_rig()
    found = PART.estimate(plan, rig)
    one, step = found.steps[1], plan.steps[1]
    assert isinstance(step, ConditionStep) and one.repeats == pytest.approx(2.0, rel=0.02)
    collected_s = 1.5 * 10.0 * 4.0 / 10.0
    assert one.seconds == pytest.approx(one.repeats * (collected_s + PART.settle_s + PART.between_s))
    assert one.sliding_m == pytest.approx(one.repeats * (collected_s + PART.settle_s) * 0.01)
    assert found.rig_seconds_low < found.rig_seconds < found.rig_seconds_high
    real = PART.estimator(replace(rig, simulated=False)).walk(plan)
    assert real[0].seconds == PART.person_s and found.steps[0].seconds == 0.0


def test_a_plan_reads_in_words() -> None:
    plan = bench_plan()
    told = "\n".join(lines(plan, PART.estimate(plan, bench_rig()), PART))
    assert "specimen 2, replicate 1" in told and "put on specimen 2: B (worn)" in told
    assert "A, 40 mm/s: 2 x 10 rev" in told


@pytest.mark.parametrize(
    ("ended", "left"),
    [
        (set(), [(1, 3), 1, 2, (2, 4), 3, 4]),
        ({1}, [(1, 3), 2, (2, 4), 3, 4]),
        ({1, 2}, [(2, 3), 3, 4]),
        ({1, 2, 3}, [(2, 3), 4]),
        ({1, 2, 3, 4}, []),
    ],
)
def test_the_rest_begins_with_the_specimen_mounted_again_under_a_new_number(
    ended: set[int], left: list[object]
) -> None:
    mounted = tuple(Mounted(n, 1, 1, float("nan"), 0.0, ground=True) for n in (1, 2))
    plan = PART.remaining(bench_plan(), Stand(ended=frozenset(ended), mounted=mounted))
    found = [(step.specimen, step.piece) if isinstance(step, Mount) else getattr(step, "condition", None)
             for step in plan.steps]  # fmt: skip
    assert found == left
