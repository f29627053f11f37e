"""Both directions on a bench: the direction of each repeat, and sliding before it counts."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tester.analysis.blocks import blocks_from_samples
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.procedures.burst_state import run_in_m, slides_reversed
from tester.kinds.wheel_on_belt.procedures.bursts import MeasureRepeat
from tester.machine.measured import Ending
from tests.tester.kinds.wheel_on_belt.bench import COLUMN, SHORT, Bench, condition_of, make_bench

STEP = replace(condition_of(SHORT.replace("25 degC", "40 degC")), repeats=3)
BOTH = replace(STEP, both_directions=True, run_in_m=2.0)


@pytest.fixture
def bench() -> Bench:
    made = make_bench()
    made.surface_c = 39.0
    return made


def measure(bench: Bench, repeat: int) -> MeasureRepeat:
    made = MeasureRepeat(BOTH, [], 1.0, reversed_slip=slides_reversed(BOTH, repeat), run_in_m=run_in_m(BOTH, repeat))
    bench.run(made, 4000.0)
    return made


def test_repeats_slide_as_asked_and_reversed_in_turns_in_both_directions_only() -> None:
    assert [slides_reversed(BOTH, repeat) for repeat in range(1, 7)] == [False, True, True, False, False, True]
    assert not any(slides_reversed(STEP, repeat) for repeat in range(1, 7))


def test_the_first_repeat_and_those_that_turn_round_run_in() -> None:
    assert [run_in_m(BOTH, repeat) for repeat in range(1, 7)] == [2.0, 2.0, 0.0, 2.0, 0.0, 2.0]
    assert run_in_m(replace(BOTH, both_directions=False), 1) == 0.0


@pytest.mark.parametrize(("repeat", "belt_m_s"), [(1, 0.5), (2, 1.1), (3, 1.1), (4, 0.5)])
def test_a_repeat_is_counted_at_the_belt_s_speed_of_its_direction(bench: Bench, repeat: int, belt_m_s: float) -> None:
    made = measure(bench, repeat)
    assert made.ending is Ending.COMPLETE and made.revolutions >= 21
    assert {round(one.means["belt_speed_m_s"], 9) for one in made.counter.blocks} == {belt_m_s}
    assert {round(one.means["slip_m_s"], 9) for one in made.counter.blocks} == {0.3}


def test_nothing_counts_before_the_run_in_has_been_slid(bench: Bench) -> None:
    made = measure(bench, 2)
    first = made.counter.blocks[0].started_s
    slid = [row for row in bench.notes.rows if row[0] < first and row[COLUMN["force_z_n"]] > 100.0]
    slid_m = sum(0.01 * row[COLUMN["slip_m_s"]] for row in slid if row[COLUMN["burst"]] == 0.0)
    assert 2.0 <= slid_m < 2.5


def test_the_samples_give_the_blocks_that_were_counted_without_the_run_in(bench: Bench) -> None:
    import numpy as np

    made = measure(bench, 2)
    columns = dict(zip(QUANTITIES.names, np.array(bench.notes.rows).T, strict=True))
    again = blocks_from_samples(columns, QUANTITIES)
    assert [one.started_s for one in again] == [one.started_s for one in made.counter.blocks]


def test_a_run_in_that_warms_through_the_band_continues_in_further_pulses(bench: Bench) -> None:
    bench.warming_k_s, bench.returning_k_s = 1.0, 0.5
    made = measure(bench, 2)
    assert made.run_in.pulses > 1 and made.run_in.left_m <= 0.0


def test_a_run_in_that_gets_nowhere_ends_the_condition(bench: Bench) -> None:
    bench.warming_k_s, bench.returning_k_s = 20.0, 5.0
    step = replace(BOTH, run_in_m=100.0, max_bursts=4)
    made = MeasureRepeat(step, [], 1.0, reversed_slip=True, run_in_m=100.0)
    bench.run(made, 4000.0)
    assert made.ending is Ending.CANNOT_HOLD and "of run-in left after 4 pulses" in made.detail
