"""The zero of a load cell: the averaged readings, and the time-out."""

from __future__ import annotations

from math import nan
from types import SimpleNamespace
from typing import Any

import pytest

from tester.machine.motions import LEAST, SILENT_S, ZeroOfCell

STEP_S = 0.05


def averaged(zero: ZeroOfCell, seconds: float, *, valid: bool = True, new: bool = True) -> tuple[bool, float]:
    """Step it until it is averaged or time is up; return whether it is, and when."""
    ctx: Any = SimpleNamespace(now=100.0, moving=False)
    at_s = ctx.now
    while ctx.now - 100.0 <= seconds:
        at_s = ctx.now if new else at_s
        if zero.averaged(ctx, at_s, (2.0, -1.0) if valid else (nan, nan), valid=valid):
            return True, ctx.now - 100.0
        ctx.now += STEP_S
    return False, ctx.now - 100.0


def test_it_averages_for_its_time_and_puts_the_tare_in_use_back() -> None:
    zero = ZeroOfCell(1.0)
    done, after_s = averaged(zero, 3.0)
    assert done and after_s == pytest.approx(1.0, abs=STEP_S)
    assert zero.zero((0.5, 0.25)) == pytest.approx((2.5, -0.75))


def test_a_short_time_is_stretched_until_there_are_enough_readings() -> None:
    zero = ZeroOfCell(0.1)
    done, after_s = averaged(zero, 3.0)
    assert done and zero.count == LEAST and after_s >= LEAST * STEP_S - 1e-9


@pytest.mark.parametrize(("valid", "new"), [(False, True), (True, False)])
def test_without_valid_new_readings_it_is_given_up(valid: bool, new: bool) -> None:
    zero = ZeroOfCell(1.0)
    done, _ = averaged(zero, 1.0 + SILENT_S + 2.0 * STEP_S, valid=valid, new=new)
    assert not done and zero.failed == "the load cell gave 0 valid readings in 6 s"
