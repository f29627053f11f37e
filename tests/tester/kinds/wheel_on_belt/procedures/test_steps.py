"""Steps in their order, unplanned wheel changes, the end."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite

import pytest

from tester.inputs.recipe.plan import Plan, PromptStep
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.interlocks.contact_force import depth_mm
from tester.kinds.wheel_on_belt.procedures.first_contact import OFF
from tester.kinds.wheel_on_belt.procedures.steps import WheelProcedures
from tester.kinds.wheel_on_belt.procedures.wear_estimate import DISAGREEMENTS, loss_per_n_m
from tester.kinds.wheel_on_belt.recipe.plan_steps import Cool, Heat, Install, PreGrind, Rest, WheelCondition
from tester.machine.executor import Executor
from tests.tester.inputs.recipe.texts import rig
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Bench, condition_of, make_bench, plan_of
from tests.tester.kinds.wheel_on_belt.procedures.test_condition import Results

LOADS = SHORT.replace("load: 200 N", "load: [100 N, 200 N, 300 N]").replace("25 degC", "40 degC")


class Wearing(Results):
    """Predicts the same loss for every condition, and takes it off the wheel."""

    def __init__(self, loss_mm: float = 0.5) -> None:
        super().__init__()
        self.loss_mm = loss_mm
        self.asked: list[int] = []

    def predicted_loss_mm(self, step: WheelCondition, rig: object) -> float:
        self.asked.append(step.condition)
        return self.loss_mm


def executor_of(plan: Plan, results: Results) -> Executor[Context]:
    return Executor(plan, WheelProcedures(plan, results, hardware=False))


def walk(
    plan: Plan, results: Results, bench: Bench | None = None, worn_mm: float = 0.0
) -> tuple[Executor[Context], Bench]:
    """Run a plan to its end on the ideal rig; every repeat that begins costs the wheel ``worn_mm``."""
    bench = bench or make_bench()
    executor = executor_of(plan, results)
    touched_mm = bench.pressed_mm

    class Walk:
        begun = 0

        def step(self, ctx: object) -> bool:
            bench.surface_c = 39.0 if isfinite(bench.ctx.demand.surface_c) else 20.0
            bench.ctx.wheel.sliding_m = 48.0  # a wheel that has been ground in
            executor.step(bench.ctx)
            if len(results.begun) > self.begun:
                self.begun = len(results.begun)
                bench.ctx.wheel.loss_mm += worn_mm
            bench.ctx.wheel.show(bench.ctx.readings, bench.ctx.rig.wear)
            bench.pressed_mm = touched_mm + 0.5 * bench.ctx.wheel.loss_mm
            return executor.finished

    bench.run(Walk(), 20_000.0, dt=0.02)
    return executor, bench


def steps_of(bench: Bench) -> list[str]:
    return [text.split()[0] for text in bench.notes.texts("step")]


def test_a_plan_is_walked_in_order_to_its_end() -> None:
    executor, bench = walk(plan_of(LOADS), Results())
    assert steps_of(bench) == ["install", "heat", "1#,", "1#,", "1#,"]
    assert executor.finished and not executor.failed


def test_nothing_is_left_running_at_the_end() -> None:
    executor, bench = walk(plan_of(LOADS), Results())
    executor.step(bench.ctx)
    assert executor.activity is None and not executor.steps


def test_progress_counts_steps() -> None:
    _, bench = walk(plan_of(LOADS), Results())
    progress = bench.ctx.progress
    assert (progress.step, progress.steps) == (5, 5)


def test_a_step_does_not_begin_with_the_phase_of_the_one_before() -> None:
    bench, plan = make_bench(), plan_of(LOADS)
    bench.ctx.progress.phase = "first contact"
    heat = replace(plan, steps=tuple(step for step in plan.steps if isinstance(step, Heat)))
    executor_of(heat, Results()).step(bench.ctx)
    assert not bench.ctx.progress.phase


def test_heating_is_under_the_load_of_the_condition_that_follows() -> None:
    bench = make_bench()
    walk(plan_of(LOADS), Results(), bench)
    first_contact_n = 2.0 * rig().interlocks.first_contact_load_n
    loads = [d.load_n for d in bench.demands if d.press is Press.LOAD and d.load_n > first_contact_n]
    assert loads[0] == 100.0


def test_a_zero_that_drifts_ends_the_run_after_the_condition() -> None:
    bench = make_bench()

    class Drifts(Results):
        def begin_repeat(self, *arguments: object) -> int:
            bench.zero_n += 25.0
            return super().begin_repeat(*arguments)  # type: ignore[arg-type]

    executor, _ = walk(plan_of(LOADS), Drifts(), bench)
    assert executor.finished and "drifted" in executor.failed
    assert steps_of(bench).count("1#,") == 1


def test_a_silent_load_cell_at_the_reference_tare_ends_the_run() -> None:
    bench = make_bench()
    bench.ctx.readings.cell_valid = False
    executor, _ = walk(plan_of(LOADS), Results(), bench)
    assert "load cell" in executor.failed and steps_of(bench) == ["install"]


def test_a_worn_wheel_is_changed_between_conditions() -> None:
    plan = replace(plan_of(LOADS), replace_after_mm=1.2)
    _, bench = walk(plan, Wearing(), worn_mm=0.5)
    assert steps_of(bench) == ["install", "heat", "1#,", "1#,", "cool", "install", "heat", "1#,"]


def test_a_wheel_that_lasts_is_not_changed() -> None:
    plan = replace(plan_of(LOADS), replace_after_mm=2.0)
    _, bench = walk(plan, Wearing(), worn_mm=0.5)
    assert steps_of(bench).count("install") == 1


def test_a_change_never_interrupts_a_condition() -> None:
    plan = replace(plan_of(LOADS.replace("repeats: 1", "repeats: 3")), replace_after_mm=1.2)
    results = Wearing()
    walk(plan, results, worn_mm=0.6)
    assert [repeat for repeat, _ in results.begun] == [1, 2, 3] * 3


def test_an_unforeseen_wheel_has_a_number_of_its_own() -> None:
    text = LOADS.replace('  - compound: "1#"\n', '  - compound: "1#"\n  - compound: "2#"\n')
    plan = replace(plan_of(text), replace_after_mm=1.2)
    _, bench = walk(plan, Wearing(), worn_mm=0.5)
    wheels = [values[0] for values in bench.notes.written("INSERT OR REPLACE INTO piece")]
    assert wheels == [1, 3, 2, 4]


def test_a_condition_that_wears_more_than_a_wheel_has_is_measured_on_a_new_one_all_the_same() -> None:
    plan = replace(plan_of(LOADS), replace_after_mm=1.0)
    executor, bench = walk(plan, Wearing(loss_mm=5.0), worn_mm=0.5)
    assert executor.finished and steps_of(bench).count("install") == 3


def test_a_person_looks_at_the_wheel_before_each_condition_which_is_then_warmed_again() -> None:
    plan = plan_of(LOADS.replace("repeats: 1", "repeats: 1\n  wear_check: prompt"))
    _, bench = walk(plan, Results())
    assert steps_of(bench) == ["install", "heat"] + ["check", "heat", "1#,"] * 3 + ["check"]


def test_a_recipes_prompt_before_a_condition_is_followed_by_heating() -> None:
    plan = plan_of(LOADS + "steps:\n  - {prompt: clean debris, every: condition}\n")
    _, bench = walk(plan, Results())
    assert steps_of(bench) == ["install", "heat"] + ["clean", "heat", "1#,"] * 3


def test_a_prompt_before_heating_needs_no_other() -> None:
    plan = plan_of(LOADS + "steps:\n  - {prompt: clean debris, every: temperature}\n")
    _, bench = walk(plan, Results())
    assert steps_of(bench) == ["install", "clean", "heat", "1#,", "1#,", "1#,"]


@pytest.mark.parametrize(
    "asked, contacts",
    [("  wear_check: prompt\n", 4), ("steps:\n  - {prompt: clean debris, every: condition}\n", 4)],
    ids=["check by hand", "prompt"],
)
def test_the_contact_is_shown_again_after_a_person_was_at_the_wheel(asked: str, contacts: int) -> None:
    text = LOADS + asked if asked.startswith("steps") else LOADS.replace("repeats: 1\n", f"repeats: 1\n{asked}")
    executor, bench = walk(plan_of(text), Results())
    assert executor.finished and not executor.failed
    # The wheel's own, and one before each of three conditions; a contact sweeps at two speeds.
    assert len(bench.notes.texts("first contact")) == 2 * contacts


def test_a_belt_that_a_person_left_running_the_wrong_way_ends_the_run_before_the_condition() -> None:
    bench, results = make_bench(), Results()
    plan = plan_of(LOADS + "steps:\n  - {prompt: new belt, every: condition}\n")
    executor = executor_of(plan, results)

    class Exchanged:
        def step(self, ctx: object) -> bool:
            bench.surface_c = 39.0 if isfinite(bench.ctx.demand.surface_c) else 20.0
            executor.step(bench.ctx)
            if len(bench.ctx.prompts.asked) > 1:  # the wheel was the first
                bench.mu = -0.7
            return executor.finished

    bench.run(Exchanged(), 20_000.0, dt=0.02)
    assert OFF in executor.failed and executor.failed.startswith("new belt: ") and not results.begun


@pytest.mark.parametrize(
    "step, text",
    [
        (Install(1, 1, 2, "1#"), "install wheel 2 (1#)"),
        (PreGrind(1, 0.8, 0.6, 200.0, 240.0), "pre-grind 4 min at 200 N"),
        (Rest(1, 1200.0, 25.0, 2.0, 5400.0), "rest 20 min"),
        (Heat(1, 40.0), "heat to 40 degC"),
        (Cool(1), "cool the hub to 45 degC"),
        (PromptStep(1, "clean debris"), "clean debris"),
        (condition_of(SHORT), "1#, 300 mm/s, 200 N, 25 degC"),
        (condition_of(SHORT + "    sideslip: 20 deg\n"), "1#, 300 mm/s, 200 N, sideslip 20 deg, 25 degC"),
    ],
)
def test_a_title_describes_its_step(step: Install | PreGrind | Rest | Heat | Cool | PromptStep, text: str) -> None:
    assert step.title == text


def test_a_condition_continues_on_a_new_wheel_when_a_repeat_has_worn_out_the_old_one() -> None:
    """The least diameter is 12 mm below the new one; a repeat costs 4 mm here."""
    plan = replace(plan_of(LOADS.replace("repeats: 1", "repeats: 3")), replace_after_mm=20.0)
    plan = replace(plan, steps=tuple(step for step in plan.steps if getattr(step, "condition", 1) == 1))
    bench = make_bench()

    class Rubs(Wearing):
        def repeats_kept(self, step: WheelCondition) -> int:
            return len(self.finished)

        def begin_repeat(self, ctx: Context, step: WheelCondition, repeat: int, attempt: int) -> int:
            bench.ctx.wheel.followed = True
            bench.ctx.wheel.rate_mm3_per_n_m = 4.0 / (100.0 * loss_per_n_m(85.0, 30.0))
            bench.ctx.wheel.exposure_n_m += 100.0
            return super().begin_repeat(ctx, step, repeat, attempt)

    results = Rubs(loss_mm=0.1)
    walk(plan, results, bench, worn_mm=4.0)
    assert [repeat for repeat, _ in results.begun] == [1, 2, 3]
    assert steps_of(bench).count("install") == 2 and "a new wheel instead of wheel 1" in bench.notes.texts("wear")[0]


def test_a_wheel_whose_touches_disagree_with_its_wear_is_changed() -> None:
    bench = make_bench()

    class Disagrees(Wearing):
        def begin_repeat(self, ctx: Context, step: WheelCondition, repeat: int, attempt: int) -> int:
            if not self.begun:
                bench.ctx.wheel.estimate.disagreed = DISAGREEMENTS
            return super().begin_repeat(ctx, step, repeat, attempt)

    results = Disagrees()
    walk(plan_of(LOADS), results, bench)
    assert steps_of(bench).count("install") == 2
    assert "its touches and the learnt wear disagree" in bench.notes.texts("wear")[0]


def test_the_press_reaches_a_wheel_that_is_worn_to_its_least_diameter() -> None:
    ctx = make_bench().ctx
    ctx.wheel.loss_mm = 3.0
    assert ctx.most_loss_mm(400.0) == 12.0
    ctx.contact.contact_mm = 17.5
    deep_mm = 1.3 * depth_mm(400.0, ctx.rig.loops.load.stiffness_n_per_mm)
    assert ctx.most_loss_mm(400.0) == pytest.approx(3.0 + 2.0 * (20.0 - 17.5 - deep_mm))
