"""The counted part of a repeat: truncation of its transient, and its length."""

from __future__ import annotations

from math import exp
from random import Random

from tester.analysis.stability import Window, enough, filled, left_out, truncation
from tests.tester.analysis.series import REVOLUTION_S, blocks, counter_of

MU = 0.7


def settling(n: int, size: float = 0.2, revolutions: float = 2.0) -> list[float]:
    """Return coefficients with a transient of a share of them, and a little noise that is always the same."""
    random = Random(1)
    return [MU * (1.0 + size * exp(-i / revolutions) + random.gauss(0.0, 0.004)) for i in range(n)]


def test_truncation_leaves_out_a_transient() -> None:
    values = [0.9, 0.85, 0.75] + [0.70, 0.71] * 10
    assert truncation(values) == 3


def test_truncation_of_equal_values_keeps_all() -> None:
    assert truncation([0.7] * 20) == 0


def test_truncation_of_a_steady_slope_finds_no_minimum() -> None:
    assert truncation([0.7 + 0.01 * i for i in range(20)]) is None


def test_a_transient_is_left_out() -> None:
    assert 4 <= left_out(blocks(settling(45)), Window(30)) <= 15


def test_a_slope_is_no_transient() -> None:
    assert left_out(blocks([MU * (1.0 + 0.03 * i / 30) for i in range(45)]), Window(30)) == 0


def test_a_truncation_that_does_not_matter_is_not_made() -> None:
    random = Random(5)
    values = [MU * (1.0 + (0.0005 if i < 2 else 0.0) + random.gauss(0.0, 1e-5)) for i in range(45)]
    assert left_out(blocks(values), Window(30)) == 0


def test_a_sawtooth_of_temperature_is_no_transient() -> None:
    surface = [23.5 + 3.0 * j / 9.0 for j in range(10)]
    random = Random(3)
    values = [MU * (1.0 + 0.02 * (surface[i % 10] - 25.0) + random.gauss(0.0, 0.001)) for i in range(45)]
    assert left_out(blocks(values, per_burst=10, surface=surface), Window(30)) == 0


def test_later_blocks_do_not_change_the_transient() -> None:
    values = settling(70)
    assert left_out(blocks(values[:45]), Window(30)) == left_out(blocks(values), Window(30))
    seconds = 30 * REVOLUTION_S
    assert left_out(blocks(values[:45]), Window(None, seconds)) == left_out(blocks(values), Window(None, seconds)) > 0


def test_a_repeat_collects_one_and_a_half_windows() -> None:
    made = blocks([MU] * 50)
    assert [filled(counter_of(made[:n]), Window(30)) for n in (30, 44, 45)] == [False, False, True]
    seconds = 10 * REVOLUTION_S
    assert [filled(counter_of(made[:n]), Window(None, seconds - 0.01)) for n in (10, 14, 15)] == [False, False, True]


def test_a_transient_does_not_count_towards_it() -> None:
    made = blocks(settling(70))
    transient = left_out(made[:45], Window(30))
    assert transient > 0
    counts = (45, 44 + transient, 45 + transient)
    assert [filled(counter_of(made[:n]), Window(30)) for n in counts] == [False, False, True]


def test_a_repeat_finds_its_transient_once() -> None:
    made = blocks(settling(70))
    counter = counter_of(made[:45])
    answers = [filled(counter, Window(30))]
    for block in made[45:]:
        counter.blocks.append(block)
        answers.append(filled(counter, Window(30)))
    assert answers == [filled(counter_of(made[:n]), Window(30)) for n in range(45, 71)]
    assert counter.transient == left_out(made, Window(30))


def test_coefficients_without_a_value_have_no_transient() -> None:
    assert left_out(blocks([MU] * 20 + [float("nan")] * 20), Window(30)) == 0
    assert left_out(blocks([0.0] * 40), Window(30)) == 0
    assert left_out(blocks([0.9, 0.8, 0.7, 0.7, 0.7]), Window(30)) == 0


def test_a_window_in_seconds_is_filled_by_accepted_seconds() -> None:
    made = blocks([MU] * 10, per_burst=2)
    assert enough(made, Window(None, 10 * REVOLUTION_S - 0.01))
    assert not enough(made, Window(None, 10 * REVOLUTION_S + 0.01))


def test_a_window_in_revolutions_is_filled_by_blocks() -> None:
    assert enough(blocks([MU] * 10), Window(10.0))
    assert not enough(blocks([MU] * 10), Window(10.5))
