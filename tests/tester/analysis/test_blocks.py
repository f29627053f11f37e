"""Whole-revolution blocks: live and from arrays."""

from __future__ import annotations

from math import pi, sin
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tester.analysis.blocks import Block, BlockCounter, blocks_from_samples, resultant
from tester.analysis.trace import Trace
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.procedures.gates import GATES
from tests.tester.analysis.series import sample

Sample = tuple[float, ...]


def live(samples: list[Sample]) -> list[Block]:
    counter = BlockCounter(QUANTITIES)
    for row in samples:
        counter.add(row)
    return counter.blocks


def stored(samples: list[Sample]) -> list[Block]:
    table = np.array(samples, dtype=np.float64).reshape(-1, len(QUANTITIES.names))
    return blocks_from_samples({name: table[:, i] for i, name in enumerate(QUANTITIES.names)}, QUANTITIES)


def turning(n: int, step_rev: float = 0.0283, start_rev: float = 7.3, **values: float) -> list[Sample]:
    return [sample(time_s=100.0 + 0.01 * i, wheel_angle_rev=start_rev + step_rev * i, **values) for i in range(n)]


def figures(block: Block) -> tuple[float, ...]:
    said = (block.burst, block.samples, block.started_s, block.ended_s, block.position, block.mu)
    return (*said, *block.means.values())


def assert_same(a: list[Block], b: list[Block]) -> None:
    assert len(a) == len(b)
    for one, other in zip(a, b, strict=True):
        assert figures(one) == pytest.approx(figures(other), rel=1e-12, abs=1e-12)


def test_a_revolution_is_complete_with_the_first_sample_beyond_it() -> None:
    counter = BlockCounter(QUANTITIES)
    made = [counter.add(row) for row in turning(37)]
    assert [i for i, block in enumerate(made) if block is not None] == [36]  # 36 * 0.0283 = 1.019


def test_blocks_are_anchored_so_that_thirty_revolutions_are_thirty_blocks() -> None:
    assert len(live(turning(round(30.5 / 0.0283)))) == 30


def test_the_remainder_of_a_stretch_is_not_counted() -> None:
    assert len(live(turning(35))) == 0


def test_a_gated_sample_ends_the_stretch() -> None:
    samples = turning(60)
    samples[20] = sample(time_s=100.2, wheel_angle_rev=7.3 + 0.0283 * 20, gate=GATES["load"])
    assert [block.samples for block in live(samples)] == [36]
    assert live(samples)[0].started_s == pytest.approx(100.21)


def test_samples_outside_a_burst_do_not_count() -> None:
    assert live(turning(100, burst=0.0)) == []


def test_a_new_burst_begins_a_new_stretch() -> None:
    samples = turning(30) + [
        sample(time_s=101.0 + 0.01 * i, wheel_angle_rev=8.149 + 0.0283 * i, burst=2.0) for i in range(30)
    ]
    assert live(samples) == []


def test_a_new_repeat_begins_a_new_stretch() -> None:
    samples = turning(30) + [
        sample(time_s=101.0 + 0.01 * i, wheel_angle_rev=8.149 + 0.0283 * i, repeat_key=2.0) for i in range(30)
    ]
    assert live(samples) == []


def test_a_gap_in_the_wheel_angle_ends_the_stretch() -> None:
    samples = turning(30) + turning(30, start_rev=7.3 + 0.0283 * 30 + 0.3)
    assert live(samples) == []


def test_a_wheel_that_turns_backwards_also_counts() -> None:
    assert len(live(turning(80, step_rev=-0.0283))) == 2


def test_a_wheel_at_rest_gives_no_blocks() -> None:
    assert live(turning(500, step_rev=0.0)) == []


def test_a_reading_that_steps_back_over_the_boundary_does_not_reopen_the_block() -> None:
    samples = turning(80)
    samples[37] = sample(time_s=100.37, wheel_angle_rev=7.3 + 0.99)
    assert len(live(samples)) == 2
    assert_same(live(samples), stored(samples))


def test_runout_does_not_reach_the_means() -> None:
    samples = [
        sample(
            time_s=0.01 * i,
            wheel_angle_rev=0.0283 * i,
            force_z_n=200.0 + 10.0 * sin(2 * pi * 0.0283 * i),
            force_x_n=0.73 * (200.0 + 10.0 * sin(2 * pi * 0.0283 * i)),
        )
        for i in range(1100)
    ]
    made = live(samples)
    assert len(made) == 31
    assert sum(block.means.normal for block in made) / 31 == pytest.approx(200.0, abs=0.05)
    assert all(block.mu == pytest.approx(0.73, rel=1e-12) for block in made)


def test_accepted_seconds_are_those_of_the_blocks() -> None:
    counter = BlockCounter(QUANTITIES)
    for row in turning(100):
        counter.add(row)
    assert counter.seconds == pytest.approx(counter.blocks[-1].ended_s - counter.blocks[0].started_s)


def test_a_block_carries_the_means_of_its_samples() -> None:
    samples = [
        sample(time_s=0.01 * i, wheel_angle_rev=0.1 * i, surface_c=20.0 + i, moment_z_nm=0.1 * i, hub_c=2.0 * i)
        for i in range(12)
    ]
    (block,) = live(samples)
    assert (block.samples, block.started_s, block.ended_s) == (10, 0.0, 0.1)
    found = tuple(block.means[name] for name in ("surface_c", "moment_z_nm", "hub_c"))
    assert found == pytest.approx((24.5, 0.45, 9.0))


def test_resultant_without_load_has_no_value() -> None:
    assert resultant(1.0, 1.0, 0.0) != resultant(1.0, 1.0, 0.0)


def random_session(seed: int) -> list[Sample]:
    """Return samples with gates, bursts, repeats, lost scans and both scan rates, as in real runs."""
    random = Random(seed)
    angle, t, burst, key = 0.0, 0.0, 1, 1
    samples: list[Sample] = []
    step = 0.0283
    for _ in range(2000):
        event = random.random()
        if event < 0.004:
            burst += 1
        elif event < 0.006:
            burst, key = 1, key + 1
        elif event < 0.008:
            angle += random.uniform(0.1, 0.4)
        elif event < 0.012:
            step = random.choice((0.0283, 0.1417, 0.2, -0.0283))
        t += 0.01
        angle += step * random.uniform(0.95, 1.05)
        samples.append(
            sample(
                time_s=t,
                wheel_angle_rev=angle,
                force_x_n=random.gauss(146, 5),
                force_y_n=random.gauss(0, 5),
                force_z_n=random.gauss(200, 5),
                surface_c=random.gauss(25, 1),
                gate=random.choices((0.0, GATES["temperature"]), (0.99, 0.01))[0],
                burst=burst if random.random() > 0.001 else 0.0,
                repeat_key=key,
            )
        )
    return samples


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32))
def test_live_and_stored_samples_give_the_same_blocks(seed: int) -> None:
    samples = random_session(seed)
    assert_same(live(samples), stored(samples))


def test_no_samples_give_no_blocks() -> None:
    assert stored([]) == []


def test_an_angle_without_a_value_ends_the_stretch_in_both() -> None:
    samples = turning(120)
    samples[50] = sample(time_s=100.5, wheel_angle_rev=float("nan"))
    assert len(live(samples)) == 2
    assert_same(live(samples), stored(samples))


def test_live_and_stored_samples_give_the_same_trace() -> None:
    rows = [*turning(100), *turning(120, start_rev=40.0, burst=2.0)]
    counter, table = BlockCounter(QUANTITIES), np.array(rows, dtype=np.float64)
    for row in rows:
        counter.add(row)
    again = Trace(QUANTITIES)
    blocks_from_samples({name: table[:, i] for i, name in enumerate(QUANTITIES.names)}, QUANTITIES, again)
    assert counter.trace.starts == again.starts == [0, 71]
    assert counter.trace.turns and len(again) == sum(block.samples for block in counter.blocks)
    for name in ("time_s", "position", "along", "across", "normal"):
        assert getattr(counter.trace, name) == getattr(again, name)
