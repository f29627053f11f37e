"""A weight is read when it hangs still, not earlier."""

from __future__ import annotations

from math import exp, sin
from types import SimpleNamespace

import pytest

from sim.noise import NormalStream
from tester.machine.commission.commission_step import StepRefused
from tester.machine.commission.hung_weights import settled_cell

WEIGHT_N, SWING_N, NOISE_N = 100.0, 5.0, 0.25


def read(decay_s: float, seed: int = 0) -> tuple[list[float], float]:
    """Read a weight that swings at 1.3 Hz and comes to rest within ``decay_s``; return the means, and when."""
    noise = NormalStream(seed, "swinging")
    cell = SimpleNamespace(valid=True, stamp_s=0.0, raw=[0.0, 0.0, 0.0])
    seat = SimpleNamespace(cell=cell)
    settled = settled_cell(seat)  # type: ignore[arg-type]
    until = next(settled)
    for number in range(4000):
        now_s = 0.01 * number
        swing = SWING_N * exp(-now_s / decay_s) * sin(8.2 * now_s) if decay_s > 0.0 else 0.0
        cell.stamp_s = now_s
        cell.raw = [NOISE_N * noise.next(), NOISE_N * noise.next(), WEIGHT_N + swing + NOISE_N * noise.next()]
        if until(now_s):  # type: ignore[operator]
            try:
                settled.send("")
            except StopIteration as ended:
                return ended.value, now_s
    raise AssertionError("never settled")


@pytest.mark.parametrize("seed", range(10))
def test_a_weight_that_hangs_still_takes_about_a_second(seed: int) -> None:
    (_, _, fz), after_s = read(0.0, seed)
    assert after_s < 2.0
    assert fz == pytest.approx(WEIGHT_N, abs=0.1)


@pytest.mark.parametrize("seed", range(10))
def test_a_weight_that_swings_is_waited_for(seed: int) -> None:
    (_, _, fz), after_s = read(3.0, seed)
    assert after_s > 2.0
    assert fz == pytest.approx(WEIGHT_N, abs=0.5)


def test_a_weight_that_swings_on_is_refused() -> None:
    with pytest.raises(StepRefused, match="have not settled within"):
        read(1e9)
