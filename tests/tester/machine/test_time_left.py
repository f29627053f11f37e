"""Progress and remaining time of a run, with a played clock and played steps."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tester.inputs.recipe.plan import Plan
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.machine.context import Progress
from tester.machine.time_left import PRIOR_S, Doing, Earlier, PartTime, TimeLeft, share_of_repeat
from tests.tester.inputs.recipe.texts import PREPARED, load_recipe

WORKING, WAITING, GIVEN_UP = Doing.WORKING, Doing.WAITING, Doing.GIVEN_UP


class Played:
    """A plan with every step estimated at 100 s, and a run at the step that the test sets."""

    def __init__(self, earlier: Earlier | None = None) -> None:
        rig = load_rig("sim")
        self.plan: Plan = expand(load_recipe(PREPARED, PART).recipe, rig)
        self.left = TimeLeft([PartTime(self.plan, (100.0,) * len(self.plan.steps), 0.0)], earlier)
        self.left.begin_part(self.plan)
        self.progress = Progress()

    @property
    def steps(self) -> int:
        return len(self.plan.steps)

    @property
    def first_condition(self) -> int:
        return next(place for place, step in enumerate(self.plan.steps) if step.kind == "condition")

    def at(self, now: float, place: int, state: Doing = WORKING, *, measuring: bool = False) -> float | None:
        """Go to a step, by its index in the plan, at a rig time; return the time left."""
        self.progress.step = place + 1
        self.left.update(now, self.progress, self.plan.steps[place + 1 :], state, measuring=measuring)
        return self.left.standing().left_s


@pytest.fixture
def played() -> Played:
    return Played()


def test_a_run_as_estimated_has_the_estimated_time_left(played: Played) -> None:
    total = 100.0 * played.steps
    for place in range(played.steps):
        assert played.at(100.0 * place, place) == pytest.approx(total - 100.0 * place)
        assert played.left.standing().share == pytest.approx(place / played.steps)


def test_a_hold_moves_neither_the_share_nor_the_time_left(played: Played) -> None:
    played.at(0.0, 0)
    before = played.at(50.0, 0), played.left.standing().share
    assert (played.at(5000.0, 0, WAITING), played.left.standing().share) == before
    assert played.at(5025.0, 0) == pytest.approx((before[0] or 0.0) - 25.0)


def test_a_run_that_is_given_up_has_no_time_left_and_keeps_its_share(played: Played) -> None:
    played.at(0.0, 0)
    played.at(90.0, 0)
    share = played.left.standing().share
    assert played.at(4000.0, 0, GIVEN_UP) is None
    assert played.left.standing().share == pytest.approx(share, abs=1e-9) and share < 0.2


def test_conditions_that_take_thrice_as_long_are_expected_to_continue_so(played: Played) -> None:
    first = played.first_condition
    for place in range(first + 1):
        played.at(100.0 * place, place)
    planned = 100.0 * (played.steps - first - 1)
    conditions = [step.kind for step in played.plan.steps[first + 1 :]].count("condition")
    left = played.at(100.0 * first + 300.0, first + 1) or 0.0
    assert left == pytest.approx(planned + 100.0 * conditions * 200.0 / (100.0 + PRIOR_S), rel=0.1) and left > planned


def test_times_of_other_kinds_of_steps_do_not_affect_conditions() -> None:
    quick, slow = Played(), Played()
    for one, each in ((quick, 100.0), (slow, 1000.0)):
        for place in range(one.first_condition + 1):
            one.at(each * place, place)
    assert [step.kind for step in quick.plan.steps[quick.first_condition :]].count("heat") == 1
    # Only the heating that is still to come is expected to take longer.
    longer = 100.0 * ((1000.0 + PRIOR_S) / (100.0 + PRIOR_S) - 1.0)
    assert (slow.left.standing().left_s or 0.0) - (quick.left.standing().left_s or 0.0) == pytest.approx(longer)


def test_a_condition_s_repeats_predict_its_duration_once_one_is_done(played: Played) -> None:
    second = played.first_condition + 1
    for place in range(second + 1):
        played.at(100.0 * place, place)
    began = 100.0 * second
    p = played.progress
    p.repeats, p.repeat, p.burst, p.revolutions_wanted, p.revolutions = 4, 1, 1, 30.0, 0.0
    played.at(began + 50.0, second, measuring=True)
    p.repeat = 2
    left = played.at(began + 250.0, second, measuring=True) or 0.0  # one of four took 200 s: 600 s to go
    behind = played.steps - second - 1
    assert left >= 600.0 + 100.0 * behind


def test_a_step_that_overruns_always_has_time_left(played: Played) -> None:
    played.at(0.0, played.steps - 1)
    assert (played.at(1000.0, played.steps - 1) or 0.0) >= 100.0


@pytest.mark.parametrize(
    ("burst", "revolutions", "share"), [(0, 15.0, 0.0), (1, 0.0, 0.0), (1, 15.0, 0.5), (2, 45.0, 1.0)]
)
def test_the_share_of_a_repeat(burst: int, revolutions: float, share: float) -> None:
    progress = Progress(repeats=3, repeat=1, burst=burst, revolutions=revolutions, revolutions_wanted=30.0)
    assert share_of_repeat(progress) == pytest.approx(share)


def test_the_first_repeat_on_a_piece_runs_in_and_predicts_no_others(played: Played) -> None:
    first = played.first_condition
    for place in range(first + 1):
        played.at(100.0 * place, place)
    p = played.progress
    p.repeats, p.repeat, p.burst, p.revolutions_wanted, p.revolutions = 3, 1, 1, 30.0, 40.0
    played.at(100.0 * first + 5.0, first, measuring=True)
    played.at(100.0 * first + 80.0, first, measuring=True)
    assert played.left.standing().step_left_s == pytest.approx(20.0, abs=1.0)
    p.repeat, p.revolutions = 2, 0.0
    played.at(100.0 * first + 85.0, first, measuring=True)
    p.repeat = 3
    played.at(100.0 * first + 91.0, first, measuring=True)
    assert played.left.standing().step_left_s == pytest.approx(6.0, abs=1.0)


def test_conditions_are_over_when_their_step_is(played: Played) -> None:
    first = played.first_condition
    counts: list[int] = []
    for place in range(played.steps):
        played.at(100.0 * place, place)
        counts.append(played.left.standing().over)
    conditions = [step.kind == "condition" for step in played.plan.steps]
    assert counts == [sum(conditions[:place]) for place in range(played.steps)]
    assert counts[first] == 0 and played.left.standing().conditions == sum(conditions)
    played.left.update(1e4, played.progress, (), WORKING, finished=True)
    assert played.left.standing().over == sum(conditions)


def test_conditions_of_earlier_stretches_count() -> None:
    gone = Played(Earlier(500.0, frozenset({90, 91}), {1: 2}))
    at = gone.left.standing()
    assert (at.over, at.conditions) == (2, 2 + sum(1 for _ in gone.plan.conditions()))
    assert at.share == pytest.approx(500.0 / (500.0 + (at.left_s or 0.0)))


def test_repeats_that_are_committed_already_take_no_time() -> None:
    whole, begun = Played(), Played(Earlier(repeats={1: 1}))
    first = whole.first_condition
    repeats = next(whole.plan.conditions()).repeats
    assert whole.left.estimated[first] == 100.0
    assert begun.left.estimated[first] == pytest.approx(100.0 * (1.0 - 1.0 / repeats))


def test_the_steps_to_come_add_up_to_the_time_left(played: Played) -> None:
    for place in range(played.steps):
        played.at(131.3 * place, place)
        at = played.left.standing()
        assert at.left_s == at.step_left_s + sum(played.left.ahead[place + 1 :]) and float(at.left_s).is_integer()


def test_the_list_stays_as_it_was_shown_until_its_revision_counts_on(played: Played) -> None:
    played.at(0.0, 0)
    before, revision = played.left.ahead.tolist(), played.left.revision
    played.at(77.0, 0)
    assert (played.left.ahead.tolist(), played.left.revision) == (before, revision)
    played.at(90.0, 1)
    assert played.left.revision > revision


def test_each_part_ends_with_its_way_to_standstill() -> None:
    plan = Played().plan
    half = len(plan.steps) // 2
    parts = [replace(plan, steps=plan.steps[:half]), replace(plan, steps=plan.steps[half:])]
    left = TimeLeft([PartTime(one, (10.0,) * len(one.steps), 40.0) for one in parts])
    left.begin_part(parts[0])
    left.update(0.0, Progress(step=1), parts[0].steps[1:], WORKING)
    left.update(95.0, Progress(step=half), (), WORKING, finished=True)
    assert left.standing().step == half + 1 and left.standing().step_left_s >= 40.0
    left.begin_part(parts[1])
    left.update(0.0, Progress(step=1), parts[1].steps[1:], WORKING)
    assert (left.standing().step, left.standing().part) == (half + 2, 2)
    assert left.standing().steps == len(plan.steps) + 2
