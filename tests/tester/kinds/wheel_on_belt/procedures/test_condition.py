"""A condition: soak, repeats one after the other, each committed and lifted before the next, and its end."""

from __future__ import annotations

from dataclasses import dataclass, replace

import pytest

from tester.analysis.results import RepeatStatus
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.procedures.bursts import MeasureRepeat
from tester.kinds.wheel_on_belt.procedures.condition import MeasureWheelCondition
from tester.kinds.wheel_on_belt.procedures.on_record import WheelResults
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.measured import ConditionEnd, Ending, RepeatOutcome
from tester.store.recorder import NullRecorder
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Bench, Simulation, condition_of, make_bench

STEP = replace(condition_of(SHORT.replace("25 degC", "40 degC")), repeats=3)


@dataclass
class Ticket:
    done: bool = True


class Results(WheelResults):
    """Takes repeats and conditions; commits at once, or on command."""

    def __init__(self, *, committed: bool = True) -> None:
        super().__init__(NullRecorder())
        self.tickets: list[Ticket] = []
        self.committed = committed
        self.begun: list[tuple[int, float]] = []
        self.finished: list[MeasureRepeat] = []
        self.ends: list[ConditionEnd] = []

    def repeats_done(self, step: WheelCondition) -> int:
        return 0

    def over(self, step: WheelCondition) -> ConditionEnd | None:
        return None

    def another(self, step: WheelCondition) -> bool:
        return sum(one.condition.condition == step.condition for one in self.finished) < step.repeats

    def attempt(self, step: WheelCondition, repeat: int) -> int:
        return 1

    def begin_repeat(self, ctx: Context, step: WheelCondition, repeat: int, attempt: int) -> int:
        self.begun.append((repeat, ctx.now))
        return 100 + repeat

    def finish_repeat(
        self, ctx: Context, step: WheelCondition, key: int, repeat: int, measured: MeasureRepeat
    ) -> RepeatOutcome:
        assert key == 100 + repeat
        self.finished.append(measured)
        self.tickets.append(Ticket(self.committed))
        return RepeatOutcome(RepeatStatus.VALID, "fine", self.tickets[-1])

    def finish_condition(self, ctx: Context, step: WheelCondition, end: ConditionEnd) -> str:
        self.ends.append(end)
        return "summed up"

    def predicted_loss_mm(self, step: WheelCondition, rig: RigConfig) -> float:
        return 0.0


@pytest.fixture
def bench() -> Bench:
    made = make_bench()
    made.surface_c = 39.0
    return made


def measure(bench: Bench, step: WheelCondition = STEP) -> tuple[MeasureWheelCondition, Results]:
    results = Results()
    condition = MeasureWheelCondition(step, results, [])
    bench.run(condition, 4000.0)
    return condition, results


def test_every_repeat_is_made_and_committed_in_order(bench: Bench) -> None:
    _, results = measure(bench)
    assert [repeat for repeat, _ in results.begun] == [1, 2, 3]
    assert len(results.finished) == 3 and results.ends == [ConditionEnd()]


def test_the_next_repeat_waits_lifted_for_the_commit(bench: Bench) -> None:
    results = Results(committed=False)
    condition = MeasureWheelCondition(STEP, results, [])
    bench.until(condition, lambda: bool(results.tickets))
    bench.hold(condition, 20.0)
    assert len(results.begun) == 1 and bench.ctx.demand.press is Press.LIFT
    results.tickets[0].done = True
    bench.hold(condition, 0.1)
    assert len(results.begun) == 2


def test_the_last_repeat_is_committed_before_the_condition_is(bench: Bench) -> None:
    results = Results(committed=False)
    condition = MeasureWheelCondition(replace(STEP, repeats=1), results, [])
    bench.until(condition, lambda: bool(results.tickets))
    bench.hold(condition, 5.0)
    assert results.ends == []
    results.tickets[0].done = True
    bench.run(condition)
    assert len(results.ends) == 1


def test_samples_carry_the_repeat_s_key_only_during_it(bench: Bench) -> None:
    measure(bench)
    keys = [row[20] for row in bench.notes.rows]
    assert set(keys) == {0.0, 101.0, 102.0, 103.0}
    assert bench.ctx.repeat_key == 0 and bench.ctx.burst == 0


def test_the_soak_is_in_rolling_contact_below_the_setpoint(bench: Bench) -> None:
    condition = MeasureWheelCondition(replace(STEP, soak=replace(STEP.soak, for_s=30.0)), Results(), [])
    bench.hold(condition, 20.0)
    demand = bench.ctx.demand
    assert demand.press is Press.LOAD and demand.load_n == 200.0 and demand.surface_c == 39.0
    assert demand.wheel_speed_m_s == demand.belt_speed_m_s == 0.8


def test_without_slip_the_soak_is_at_the_setpoint(bench: Bench) -> None:
    step = condition_of(SHORT.replace("25 degC", "40 degC").replace("300 mm/s", "0 mm/s"))
    bench.scan(MeasureWheelCondition(step, Results(), []))
    assert bench.ctx.demand.surface_c == 40.0


def test_a_soak_that_is_not_reached_ends_the_condition_without_a_repeat(bench: Bench) -> None:
    bench.surface_c = 30.0
    _, results = measure(bench, replace(STEP, soak=replace(STEP.soak, at_most_s=60.0)))
    (end,) = results.ends
    assert end.ending is Ending.NOT_REACHED and end.detail == "surface at 30.0 degC after 1 min of soak"
    assert results.begun == []


def test_a_temperature_that_cannot_be_held_ends_the_condition_with_rate_and_band(bench: Bench) -> None:
    bench.warming_k_s, bench.returning_k_s = 20.0, 2.0
    _, results = measure(bench)
    (end,) = results.ends
    assert end.ending is Ending.CANNOT_HOLD and len(results.finished) == 1
    assert end.warming_k_s > 10.0 and end.holdable_band_k > 2.0


def test_a_drifted_zero_fails_the_run(bench: Bench) -> None:
    bench.zero_n = 25.0
    condition = MeasureWheelCondition(STEP, Results(), [0.0, 0.0, 0.0, 0.0])
    bench.run(condition)
    assert "drifted by 25.0 N" in condition.failed


def test_each_repeat_begins_with_the_values_learned_by_the_one_before(bench: Bench) -> None:
    bench.warming_k_s, bench.returning_k_s = 6.0, 2.0
    _, results = measure(bench, replace(STEP, max_bursts=3, repeats=2))
    first, second = results.finished
    assert first.offset_k > 1.0 and second.offset_k >= first.offset_k


def test_a_wear_check_comes_before_the_soak(bench: Bench) -> None:
    condition = MeasureWheelCondition(replace(STEP, wear_check="each_condition"), Results(), [])
    bench.run(condition, 4000.0)
    loads = [demand.load_n for demand in bench.demands if demand.press is Press.LOAD]
    assert loads[0] == 50.0 and loads[-1] == 200.0
    assert len(bench.notes.texts("wear")) == 1


def test_on_a_rig_the_wheel_is_lifted_when_the_next_repeat_begins(noisy_run: Simulation) -> None:
    keys = noisy_run.column("repeat_key")
    forces = noisy_run.column("force_z_n")
    begun = [i for i in range(1, len(keys)) if keys[i] > 0.0 and keys[i - 1] != keys[i]]
    assert len(begun) == 2 and abs(forces[begun[1]]) < 5.0
