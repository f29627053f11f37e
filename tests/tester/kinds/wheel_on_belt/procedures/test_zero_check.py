"""The zero of the load cell is checked after long contact, wherever a recipe has it."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.interlocks.contact_force import depth_mm
from tester.kinds.wheel_on_belt.procedures.thermal_steps import roll
from tester.kinds.wheel_on_belt.procedures.wheel_steps import PreGrindStep
from tester.kinds.wheel_on_belt.procedures.zero_check import ZeroCheck, contact_s, informs, is_due
from tester.kinds.wheel_on_belt.recipe.plan_steps import PreGrind
from tester.machine.activity import MoveFailedError
from tester.machine.motions import Power, Sequence
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Bench, Simulation, make_bench

EVERY_S = 600.0
REFERENCE = [0.0, 0.0, 0.0, 0.0]


@pytest.fixture
def bench() -> Bench:
    made = make_bench()
    made.run(Sequence(Power(True), roll(0.8, 200.0)))
    return made


def lifts(bench: Bench) -> int:
    """Return how often contact was given up."""
    wanted = [demand.press for demand in bench.demands]
    return sum(a is Press.LOAD and b is Press.LIFT for a, b in pairwise(wanted))


def test_it_is_due_after_ten_minutes_of_contact_without_a_break(bench: Bench) -> None:
    bench.ctx.gates.touched_s = bench.ctx.now - EVERY_S + 1.0
    assert not is_due(bench.ctx)
    bench.ctx.gates.touched_s -= 2.0
    assert is_due(bench.ctx)


def test_it_is_due_where_the_press_is_too_deep_by_half_of_the_allowance(bench: Bench) -> None:
    ctx = bench.ctx
    p, needed_mm = ctx.rig.interlocks, depth_mm(200.0, ctx.rig.loops.load.stiffness_n_per_mm)
    allowed_mm = (p.depth_factor - 1.0) * needed_mm + p.depth_margin_mm
    ctx.view.contact_mm = ctx.readings.press_mm - needed_mm - 0.49 * allowed_mm
    ctx.gates.touched_s = ctx.now - 20.0
    assert not is_due(ctx)
    ctx.view.contact_mm -= 0.02 * allowed_mm
    assert is_due(ctx)
    ctx.gates.touched_s = ctx.now - 10.0  # just touched: soft rubber
    assert not is_due(ctx)


def press_deeper(bench: Bench, share: float) -> None:
    """Let the press be deeper than the load needs, by a share of what is allowed."""
    ctx = bench.ctx
    p, needed_mm = ctx.rig.interlocks, depth_mm(200.0, ctx.rig.loops.load.stiffness_n_per_mm)
    allowed_mm = (p.depth_factor - 1.0) * needed_mm + p.depth_margin_mm
    ctx.view.contact_mm = ctx.readings.press_mm - needed_mm - share * allowed_mm


def slide_on(bench: Bench, exposure_n_m: float, u_rate: float, rate: float = 0.3) -> None:
    """Let the wheel slide since its last touch, with a rate that is known so well, in mm3/(N m)."""
    wheel = bench.ctx.wheel
    wheel.estimate.begin(rate, u_rate, 0.0, wheel.exposure_n_m)
    wheel.exposure_n_m += exposure_n_m
    bench.ctx.gates.touched_s = bench.ctx.now - 20.0


def test_a_touch_informs_once_a_wheel_wears_unlike_the_belief_by_more_than_a_touch_is_unsure(bench: Bench) -> None:
    bench.ctx.wheel.followed = True
    slide_on(bench, 8000.0, u_rate=0.1)  # 0.19 mm
    assert not informs(bench.ctx)
    slide_on(bench, 9000.0, u_rate=0.1)  # 0.21 mm
    assert informs(bench.ctx)


def test_a_touch_informs_no_more_once_the_rate_is_known_to_a_tenth(bench: Bench) -> None:
    bench.ctx.wheel.followed = True
    slide_on(bench, 50_000.0, u_rate=0.031)
    assert informs(bench.ctx)
    slide_on(bench, 50_000.0, u_rate=0.029)
    assert not informs(bench.ctx)


def test_a_wheel_that_wears_as_believed_is_not_touched_for_its_rate(bench: Bench) -> None:
    slide_on(bench, 50_000.0, u_rate=0.2, rate=0.08)
    press_deeper(bench, 0.24)
    assert not informs(bench.ctx)
    press_deeper(bench, 0.26)
    assert informs(bench.ctx)


def test_a_grind_whose_touches_do_not_know_the_rate_is_broken_off_early(bench: Bench) -> None:
    bench.ctx.wheel.followed = True
    slide_on(bench, 50_000.0, u_rate=0.2)
    step = PreGrindStep(PreGrind(1, 0.8, 0.6, 200.0, 60.0), list(REFERENCE))
    bench.run(step, at_most_s=200.0, dt=0.1)
    assert bench.notes.texts("tare") and step.grind.done_s == pytest.approx(60.0, abs=0.2)


def test_a_lifted_wheel_has_no_age_of_contact(bench: Bench) -> None:
    bench.ctx.gates.touched_s = float("inf")
    assert contact_s(bench.ctx) == 0.0


def test_it_lifts_takes_the_zero_and_records_its_drift_with_the_limit(bench: Bench) -> None:
    bench.zero_n = 3.0
    bench.ctx.gates.touched_s = bench.ctx.now - 720.0
    bench.run(ZeroCheck(0.8, list(REFERENCE)))
    assert bench.ctx.demand.press is Press.LIFT and bench.cell.tare[2] == pytest.approx(3.0)
    assert bench.notes.texts("tare") == ["zero checked after 12 min of contact: 3.0 N off, at most 20 N"]


def test_a_zero_beyond_its_limit_ends_the_run(bench: Bench) -> None:
    bench.zero_n = -25.0
    with pytest.raises(MoveFailedError, match=r"drifted by 25\.0 N"):
        bench.run(ZeroCheck(0.8, list(REFERENCE)))


def test_long_grinding_is_broken_off_every_ten_minutes_and_takes_its_whole_time(bench: Bench) -> None:
    step = PreGrindStep(PreGrind(1, 0.8, 0.6, 200.0, 1500.0), list(REFERENCE))
    bench.run(step, at_most_s=1600.0, dt=0.1)
    assert len(bench.notes.texts("tare")) == 2 and lifts(bench) == 3
    assert step.grind.done_s == pytest.approx(1500.0, abs=0.2)


def test_pre_grinding_of_the_papers_four_minutes_is_not_broken_off(bench: Bench) -> None:
    bench.run(PreGrindStep(PreGrind(1, 0.8, 0.6, 200.0, 240.0), list(REFERENCE)), at_most_s=300.0, dt=0.1)
    assert bench.notes.texts("tare") == [] and lifts(bench) == 1


def heated(*overrides: str) -> Simulation:
    return Simulation(SHORT.replace("25 degC", "40 degC"), overrides, seed=5)


def test_after_a_long_heating_up_the_zero_is_checked_before_the_soak() -> None:
    run = heated("interlocks.zero_check_every=30 s").to_the_end(4000.0)
    checks = [text for text in run.notes.texts("tare") if text.startswith("zero checked")]
    assert len(checks) == 1 and run.notes.written("INSERT INTO trip") == []


def longest_without_a_check_s(run: Simulation) -> float:
    """Return the longest contact without a break in the first two hours of a run, s."""
    longest = 0.0
    while not run.run.finished and run.now < 7200.0:
        run.tick()
        longest = max(longest, contact_s(run.ctx))
    return longest


@pytest.mark.campaign
@pytest.mark.parametrize("name", ["quickstart", "pre-grind", "table2-load"])
def test_no_packaged_recipe_stays_in_contact_for_longer_than_the_limit(name: str) -> None:
    text = (Path(__file__).parents[5] / "recipes" / f"{name}.yaml").read_text(encoding="utf-8")
    assert longest_without_a_check_s(Simulation(text, seed=1)) < EVERY_S + 60.0
