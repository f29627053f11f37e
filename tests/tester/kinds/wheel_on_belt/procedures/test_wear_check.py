"""Checks of the wheel's diameter: by rolling, by a person, and their times."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tester.inputs.recipe.plan import Plan
from tester.kinds.wheel_on_belt.procedures.operator_access import AskAtRest
from tester.kinds.wheel_on_belt.procedures.wear_check import CheckByPerson, CheckByRolling
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Bench, make_bench, plan_of
from tests.tester.kinds.wheel_on_belt.procedures.test_condition import Results
from tests.tester.kinds.wheel_on_belt.procedures.test_steps import LOADS, Wearing, steps_of, walk

COLUMNS = (
    "wheel", "method", "t_s", "reference_s", "before", "after", "diameter_mm", "u_mm", "rubber_c", "u_growth_mm_k",
    "press_mm", "load_n", "sliding_m", "exposure_n_m", "width_mm", "u_rate_percent", "used", "expected_mm",
)  # fmt: skip
CHECKED = LOADS.replace("repeats: 1", "repeats: 1\n  wear_check: each_condition")
ASKED = LOADS.replace("repeats: 1", "repeats: 1\n  wear_check: prompt")


@pytest.fixture
def bench() -> Bench:
    made = make_bench()
    made.surface_c = 39.0
    return made


def checks(bench: Bench) -> list[dict[str, object]]:
    """Return the checks on record, by column."""
    found = [values for sql, values in bench.notes.statements if sql.startswith("INSERT INTO wear_check")]
    return [dict(zip((*COLUMNS,), (*values[: len(COLUMNS)],), strict=True)) for values in found]


def number(check: dict[str, object], name: str) -> float:
    value = check[name]
    assert isinstance(value, float | int)
    return value


def roll(bench: Bench, before: int = 0) -> None:
    bench.run(CheckByRolling(0.8, [0.0, 0.0, 0.0, 0.0], before))


@pytest.fixture
def rolled(bench: Bench) -> Bench:
    """A wheel whose first check is made."""
    bench.ctx.wheel.loss_mm = 0.2
    roll(bench)
    return bench


def test_the_first_roll_check_is_the_wheel_s_reference(rolled: Bench) -> None:
    assert rolled.ctx.wheel.reference is not None
    assert rolled.ctx.wheel.loss_mm == pytest.approx(0.2)
    assert number(checks(rolled)[0], "diameter_mm") == pytest.approx(89.8)


def test_a_deeper_press_position_gives_the_loss_of_diameter(rolled: Bench) -> None:
    rolled.pressed_mm += 0.1
    roll(rolled)
    assert rolled.ctx.wheel.loss_mm == pytest.approx(0.4)
    assert checks(rolled)[1]["reference_s"] == checks(rolled)[0]["t_s"]


def test_a_check_keeps_the_diameter_that_was_reckoned_with_until_then(rolled: Bench) -> None:
    rolled.ctx.wheel.loss_mm = 0.3
    rolled.pressed_mm += 0.1
    roll(rolled)
    assert number(checks(rolled)[1], "expected_mm") == pytest.approx(89.7)
    assert number(checks(rolled)[1], "diameter_mm") == pytest.approx(89.6)


def test_a_load_off_its_nominal_value_is_corrected_by_the_contact_s_stiffness(rolled: Bench) -> None:
    rolled.off_n = 0.9
    rolled.pressed_mm += 0.9 / 105.4  # 145 N/mm at 200 N, with the load to the power 0.23
    roll(rolled)
    assert rolled.ctx.wheel.loss_mm == pytest.approx(0.2, abs=2e-4)


def test_rubber_that_has_grown_by_heat_hides_no_wear(rolled: Bench) -> None:
    growth = rolled.ctx.rig.wear.growth_mm_per_k
    rolled.surface_c += 10.0
    rolled.pressed_mm += 0.05 - 0.5 * 10.0 * growth
    roll(rolled)
    assert rolled.ctx.wheel.loss_mm == pytest.approx(0.3)


def test_the_uncertainty_holds_press_load_and_temperature(rolled: Bench) -> None:
    wear = rolled.ctx.rig.wear
    parts = (2.0 * wear.check_press_mm, 2.0 * wear.check_load_n / 105.4, wear.growth_mm_per_k * wear.check_rubber_k)
    assert number(checks(rolled)[0], "u_mm") == pytest.approx(sum(p * p for p in parts) ** 0.5, rel=0.01)


def test_a_wheel_that_measures_larger_than_before_is_not_believed(rolled: Bench) -> None:
    rolled.pressed_mm -= 0.1
    roll(rolled)
    assert [one["used"] for one in checks(rolled)] == [1, 0]
    assert rolled.ctx.wheel.loss_mm == pytest.approx(0.2)
    assert "larger than at the check before" in rolled.notes.texts("wear")[-1]


def test_a_wheel_that_measures_larger_within_the_uncertainty_is(rolled: Bench) -> None:
    rolled.pressed_mm -= 0.005
    roll(rolled)
    assert [one["used"] for one in checks(rolled)] == [1, 1]
    assert rolled.ctx.wheel.loss_mm == pytest.approx(0.19)


def test_more_than_the_whole_rubber_is_not_believed(rolled: Bench) -> None:
    rolled.pressed_mm += 9.0
    roll(rolled)
    assert checks(rolled)[1]["used"] == 0 and rolled.ctx.wheel.loss_mm == pytest.approx(0.2)


def test_a_silent_press_leaves_no_check(bench: Bench) -> None:
    bench.pressed_mm = float("nan")
    roll(bench)
    assert not checks(bench) and "a reading was missing" in bench.notes.texts("wear")[0]


def test_a_check_takes_its_tare_first(bench: Bench) -> None:
    bench.zero_n = 0.5
    roll(bench)
    assert bench.cell.tare[2] == pytest.approx(0.5)


def test_a_check_that_was_held_begins_anew(bench: Bench) -> None:
    check = CheckByRolling(0.8, [0.0, 0.0, 0.0, 0.0])
    bench.hold(check, 2.0)
    check.resume(bench.ctx)
    assert bench.run(check) > 3.0 and len(checks(bench)) == 1


def test_a_wheel_s_own_rate_is_reckoned_with_once_checks_have_shown_it(rolled: Bench) -> None:
    wheel = rolled.ctx.wheel
    wheel.exposure_n_m += 9000.0
    rolled.pressed_mm += 0.25
    roll(rolled)
    volume = 0.25 * 3.141592653589793 * wheel.width_mm * (89.8**2 - 89.3**2)
    assert wheel.rate_mm3_per_n_m == pytest.approx(volume / 9000.0, rel=1e-3)
    before = wheel.loss_mm
    wheel.slide(200.0, 0.3, 10.0, 0.08)
    expected = 2.0 * wheel.rate_mm3_per_n_m * 600.0 / (3.14159 * 89.3 * 30.0)
    assert wheel.loss_mm - before == pytest.approx(expected, rel=1e-3)


def test_a_loss_below_the_resolution_teaches_no_rate(rolled: Bench) -> None:
    rolled.ctx.wheel.exposure_n_m += 100.0
    rolled.pressed_mm += 0.01
    roll(rolled)
    assert rolled.ctx.wheel.rate_mm3_per_n_m == 0.0


# -- by a person ----------------------------------------------------------------------------------------------


def answered(bench: Bench, *answers: str) -> CheckByPerson:
    """Answer a person's check, and once more where it is asked again."""
    bench.ctx.prompts.automatic = False
    check = CheckByPerson(3)
    for answer in answers:
        count = len(bench.ctx.prompts.asked)
        bench.until(check, lambda count=count: len(bench.ctx.prompts.asked) > count)
        assert not bench.ctx.prompts.asked[-1].reply(answer)
    bench.run(check)
    return check


def test_a_person_s_number_is_on_record_with_the_gauge_s_uncertainty(bench: Bench) -> None:
    answered(bench, "89.50 mm")
    (check,) = checks(bench)
    assert (check["method"], check["before"]) == ("person", 3)
    assert number(check, "u_mm") == pytest.approx(0.05, rel=0.02)


def test_a_person_s_number_is_brought_back_to_the_reference_temperature(bench: Bench) -> None:
    answered(bench, "89.50 mm")  # at 39 degC: 16 K above it
    warm_mm = 16.0 * bench.ctx.rig.wear.growth_mm_per_k
    assert number(checks(bench)[0], "diameter_mm") == pytest.approx(89.5 - warm_mm)
    assert bench.ctx.wheel.loss_mm == pytest.approx(0.5 + warm_mm)


@pytest.mark.parametrize(("answer", "told"), [("90.2 mm", False), ("89.5 mm", True)])
def test_a_number_beyond_the_uncertainty_of_the_believed_diameter_is_a_warning(
    bench: Bench, answer: str, told: bool
) -> None:
    answered(bench, answer)
    texts = [text for text in bench.notes.texts("wear") if "believed" in text and "uncertainty" in text]
    assert bool(texts) is told


def test_an_answer_without_number_leaves_no_check(bench: Bench) -> None:
    answered(bench, "yes")
    assert not checks(bench) and bench.notes.texts("wear") == ['no diameter measured: "yes"']


def test_a_number_that_cannot_be_the_wheel_s_is_asked_for_again(bench: Bench) -> None:
    answered(bench, "45", "89.7")
    assert "cannot be the wheel's diameter (expected 74 to 92 mm)" in bench.ctx.prompts.asked[1].text
    assert [number(one, "diameter_mm") for one in checks(bench)] == [pytest.approx(89.7, abs=0.2)]


def test_the_question_is_put_at_rest() -> None:
    assert isinstance(CheckByPerson().ask, AskAtRest)


# -- when they are made -----------------------------------------------------------------------------------------


def between(plan: Plan, results: Results | None = None, worn_mm: float = 0.0) -> tuple[list[tuple[object, ...]], Bench]:
    """Return the wheel of each check, and the conditions before and after it."""
    _, bench = walk(plan, results or Results(), worn_mm=worn_mm)
    return [(one["wheel"], one["after"], one["before"]) for one in checks(bench)], bench


def test_a_wheel_is_checked_before_every_condition_and_after_its_last() -> None:
    made, bench = between(plan_of(CHECKED))
    assert made == [(1, 0, 0), (1, 0, 1), (1, 1, 2), (1, 2, 3), (1, 3, 0)]
    assert steps_of(bench) == ["install", "check", "heat", "1#,", "1#,", "1#,", "check"]


def test_a_worn_wheel_is_checked_before_it_is_changed() -> None:
    made, _ = between(replace(plan_of(CHECKED), replace_after_mm=1.2), Wearing(), worn_mm=0.5)
    assert made == [(1, 0, 0), (1, 0, 1), (1, 1, 2), (1, 2, 0), (2, 0, 0), (2, 0, 3), (2, 3, 0)]


def test_a_wheel_that_the_plan_changes_is_checked_before() -> None:
    text = CHECKED.replace('  - compound: "1#"\n', '  - compound: "1#"\n  - compound: "2#"\n')
    made, _ = between(plan_of(text))
    assert [one for one in made if one[1] and one[2] == 0] == [(1, 3, 0), (2, 6, 0)]


def test_a_grid_without_checks_leaves_the_wheel_unchecked() -> None:
    assert between(plan_of(LOADS))[0] == []


def test_a_condition_without_a_check_does_not_take_that_of_the_one_before() -> None:
    short = SHORT.replace("25 degC", "40 degC")
    grid = short[short.index("  - name: one") :].replace("one", "two").replace("200 N", "300 N")
    text = short.replace("repeats: 1", "repeats: 1\n  wear_check: each_condition") + grid + "    wear_check: never\n"
    assert between(plan_of(text))[0] == [(1, 0, 0), (1, 0, 1), (1, 1, 0)]


def test_a_person_is_also_asked_after_the_last_condition() -> None:
    _, bench = between(plan_of(ASKED))
    assert steps_of(bench) == ["install", "heat"] + ["check", "heat", "1#,"] * 3 + ["check"]
