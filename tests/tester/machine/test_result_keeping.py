"""From a measured repeat to rows of the store: status, flags, bursts, and the line for people."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tester.analysis.blocks import Block
from tester.analysis.results import ConditionStatus, RepeatStatus
from tester.inputs.recipe.plan import ConditionStep
from tester.kinds.wheel_on_belt.procedures.bursts import MeasureRepeat
from tester.kinds.wheel_on_belt.procedures.on_record import WheelResults
from tester.machine.measured import ConditionEnd, Ending
from tester.machine.result_keeping import condition_records
from tester.store.resumable import ConditionSoFar
from tests.tester.analysis.series import means_of
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Bench, condition_of, make_bench, plan_of

STEP = replace(condition_of(), repeats=3, at_most=6, min_valid=2)


class Door:
    """Results on a bench, and their rows."""

    def __init__(self) -> None:
        self.bench: Bench = make_bench()
        self.results = WheelResults(self.bench.notes)

    def repeat(
        self,
        number: int,
        ending: Ending,
        *,
        mu: float = 0.7,
        blocks: int = 21,
        detail: str = "",
        drift: float = 0.0,
        step: ConditionStep = STEP,
    ) -> RepeatStatus:
        """Do one repeat with so many turns of one coefficient, constant or drifting, as a share per window."""
        ctx = self.bench.ctx
        key = self.results.begin_repeat(ctx, step, number, 1)
        measured = MeasureRepeat(step, [], 1.0)
        measured.ending, measured.detail = ending, detail
        measured.counter.blocks.extend(block(i, mu * (1.0 + drift * (i - 10) / 14.0)) for i in range(blocks))
        outcome = self.results.finish_repeat(ctx, step, key, number, measured)
        assert outcome.ticket.done
        return outcome.status

    def end(self, end: ConditionEnd | None = None) -> tuple[str, tuple[object, ...]]:
        """Close the condition; return the line and the written rows."""
        line = self.results.finish_condition(self.bench.ctx, STEP, end or ConditionEnd())
        written = self.bench.notes.written("UPDATE condition SET status")
        return line, written[-1]


def block(i: int, mu: float) -> Block:
    """Return a turn of a steady repeat, with a little noise that is the same every time."""
    noisy = mu * (1.0 + 0.001 * ((i * 7) % 5 - 2))
    means = means_of(force_x_n=200.0 * noisy, force_y_n=0.0, force_z_n=200.0, slip_m_s=0.3, surface_c=0.0)
    return Block(1, 35, 0.353 * i, 0.353 * (i + 1), float(i), noisy, means)


@pytest.fixture
def door() -> Door:
    return Door()


def test_a_complete_repeat_is_reduced_and_committed(door: Door) -> None:
    assert door.repeat(1, Ending.COMPLETE) is RepeatStatus.VALID
    (stored,) = door.bench.notes.fields("UPDATE repeat SET")
    assert stored["status"] == "valid" and stored["mu_resultant"] == pytest.approx(0.7, rel=1e-3)


def test_the_bursts_of_a_repeat_are_stored_with_it(door: Door) -> None:
    door.repeat(1, Ending.COMPLETE)
    assert len(door.bench.notes.written("INSERT INTO burst")) == 1


@pytest.mark.parametrize(
    "ending, status",
    [
        (Ending.CANNOT_HOLD, RepeatStatus.CANNOT_HOLD),
        (Ending.NOT_REACHED, RepeatStatus.NOT_REACHED),
        (Ending.ZERO_DRIFT, RepeatStatus.VOID),
    ],
)
def test_an_ending_without_a_value_leaves_none_whatever_was_collected(
    door: Door, ending: Ending, status: RepeatStatus
) -> None:
    assert door.repeat(1, ending, detail="why") is status
    (stored,) = door.bench.notes.fields("UPDATE repeat SET")
    assert stored["reason"] == "why" and stored["mu_resultant"] != stored["mu_resultant"]


def test_an_incomplete_repeat_is_for_the_reduction_to_judge(door: Door) -> None:
    assert door.repeat(1, Ending.INCOMPLETE, blocks=7) is RepeatStatus.TOO_FEW


def test_a_repeat_without_a_whole_turn_has_no_value(door: Door) -> None:
    assert door.repeat(1, Ending.INCOMPLETE, blocks=0) is RepeatStatus.TOO_FEW


def test_the_wheel_s_state_is_stored_with_every_repeat(door: Door) -> None:
    door.bench.ctx.wheel.loss_mm = 0.25
    door.repeat(1, Ending.COMPLETE)
    (values,) = door.bench.notes.written("UPDATE piece")
    assert values[0] == pytest.approx(89.75)


def test_enough_valid_repeats_make_a_value(door: Door) -> None:
    for number in (1, 2, 3):
        door.repeat(number, Ending.COMPLETE)
    line, written = door.end()
    assert written[0] == ConditionStatus.OK.value
    assert line.startswith("condition 1 (1#, 300 mm/s, 200 N, 25 degC): mu as measured 0.700,")
    assert "3 of 3" in line


def test_too_few_valid_repeats_make_a_flagged_value(door: Door) -> None:
    for number in (1, 2, 3):
        door.repeat(number, Ending.COMPLETE if number == 1 else Ending.INCOMPLETE, blocks=21 if number == 1 else 7)
    line, written = door.end()
    assert written[0] == ConditionStatus.OK.value
    assert "1 of 3 (short" in line


def test_no_valid_repeat_makes_no_value(door: Door) -> None:
    for number in (1, 2, 3):
        door.repeat(number, Ending.INCOMPLETE, blocks=7)
    line, written = door.end()
    assert written[0] == ConditionStatus.INSUFFICIENT.value
    assert "insufficient: none of 3 repeats is valid" in line


def test_a_condition_that_cannot_be_held_is_reported_with_rate_and_band(door: Door) -> None:
    door.repeat(1, Ending.CANNOT_HOLD, detail="surface warms by 9 K/s")
    line, written = door.end(ConditionEnd(Ending.CANNOT_HOLD, "surface warms by 9 K/s", 9.0, 3.3))
    assert written[0] == ConditionStatus.CANNOT_HOLD.value
    assert (written[3], written[4]) == (9.0, 3.3)
    assert line.endswith("temperature cannot be held: surface warms by 9 K/s")


def test_a_condition_that_was_left_before_its_first_repeat_is_stored(door: Door) -> None:
    _, written = door.end(ConditionEnd(Ending.NOT_REACHED, "surface at 31 degC"))
    assert written[:2] == (ConditionStatus.NOT_REACHED.value, "surface at 31 degC")


def test_enough_valid_repeats_outweigh_an_unreached_one(door: Door) -> None:
    for number in (1, 2):
        door.repeat(number, Ending.COMPLETE)
    door.repeat(3, Ending.NOT_REACHED, detail="surface at 43 degC")
    line, written = door.end(ConditionEnd(Ending.NOT_REACHED, "surface at 43 degC"))
    assert written[0] == ConditionStatus.OK.value and "2 of 3" in line


def test_a_condition_does_not_inherit_the_repeats_of_the_one_before(door: Door) -> None:
    door.repeat(1, Ending.COMPLETE)
    door.end(ConditionEnd(Ending.NOT_REACHED, "x"))
    _, written = door.end(ConditionEnd(Ending.NOT_REACHED, "y"))
    assert written[0] == ConditionStatus.NOT_REACHED.value


def test_a_plan_s_conditions_are_stored_as_in_the_recipe() -> None:
    records = list(condition_records(plan_of(SHORT.replace("load: 200 N", "load: [100 N, 200 N]"))))
    assert [(r.condition, r.row, r.setpoint.value("load"), r.compound) for r in records] == [
        (1, 1, 100.0, "1#"),
        (2, 2, 200.0, "1#"),
    ]
    assert records[0].window_revolutions == 14.0 and records[0].min_valid == 1


def test_no_further_repeat_is_made_of_a_steady_condition(door: Door) -> None:
    wanted = []
    for number in (1, 2, 3):
        door.repeat(number, Ending.COMPLETE)
        wanted.append(door.results.another(STEP))
    assert wanted == [True, True, False]


def test_a_repeat_that_drifts_is_refused_stored_so_and_made_up_for(door: Door) -> None:
    for number in (1, 2, 3):
        door.repeat(number, Ending.COMPLETE, drift=0.05 if number == 2 else 0.0)
    assert door.results.another(STEP)
    judged = door.bench.notes.fields("UPDATE repeat SET")[-3:]
    assert [row["status"] for row in judged] == ["valid", "refused", "valid"]
    door.repeat(4, Ending.COMPLETE)
    assert not door.results.another(STEP)
    line, written = door.end()
    assert written[0] == ConditionStatus.OK.value and "3 of 3" in line


def test_no_more_repeats_are_made_than_at_most(door: Door) -> None:
    for number in range(1, 7):
        assert door.results.another(STEP) or number == 1
        door.repeat(number, Ending.COMPLETE, drift=0.05)
    assert not door.results.another(STEP)
    line, written = door.end()
    assert written[0] == ConditionStatus.OK.value and "carry-over" in line and "drift not shown" in line


def test_a_repeat_without_revolutions_is_not_retried_for_ever(door: Door) -> None:
    for number in (1, 2, 3):
        door.repeat(number, Ending.INCOMPLETE, blocks=7)
    assert not door.results.another(STEP)


def test_repeated_until_the_repeatability_is_reached(door: Door) -> None:
    step = replace(STEP, until_percent=2.0, at_most=10)
    made = 0
    door.results._turn_to(step)  # pyright: ignore[reportPrivateUsage]
    while door.results.another(step):
        made += 1
        door.repeat(made, Ending.COMPLETE, mu=0.7 * (1.0 + 0.015 * (-1.0) ** made), step=step)
    # s = 1.55 to 1.73 %: t(0.975, n - 1) s / sqrt(n) is 2.75 % with four repeats and below 2 % with six.
    assert made == 6


def test_at_least_four_repeats_give_a_repeatability(door: Door) -> None:
    step = replace(STEP, until_percent=2.0)
    for number in (1, 2, 3):
        door.repeat(number, Ending.COMPLETE, step=step)
    assert door.results.another(step)
    door.repeat(4, Ending.COMPLETE, step=step)
    assert not door.results.another(step)


def test_a_precision_that_was_not_reached_is_a_flag(door: Door) -> None:
    step = replace(STEP, until_percent=0.5, at_most=4)
    for number in range(1, 5):
        door.repeat(number, Ending.COMPLETE, mu=0.7 * (1.0 + 0.02 * (-1.0) ** number), step=step)
    line = door.results.finish_condition(door.bench.ctx, step, ConditionEnd())
    assert "precision not reached" in line


def test_a_resumed_condition_is_judged_as_if_it_had_not_been_interrupted(door: Door) -> None:
    drifts = (0.0, 0.05, 0.0, 0.0)
    for number, drift in enumerate(drifts[:3], start=1):
        door.repeat(number, Ending.COMPLETE, drift=drift)
    before = door.results
    blocks = tuple(tuple(one) for one in before.blocks)
    so_far = ConditionSoFar(tuple(before.repeats), {1: 1, 2: 1, 3: 1}, keys=tuple(before.keys), blocks=blocks,
                          judged=before.judgement)  # fmt: skip
    after = WheelResults(door.bench.notes)
    after.earlier = {STEP.condition: so_far}
    assert after.over(STEP) is None
    assert (after.repeats, after.judgement) == (before.repeats, before.judgement)
    door.repeat(4, Ending.COMPLETE)
    uninterrupted = door.end()[0]
    door.results = after
    door.repeat(4, Ending.COMPLETE)
    assert door.end()[0] == uninterrupted
