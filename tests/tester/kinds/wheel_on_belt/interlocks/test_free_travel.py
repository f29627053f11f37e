"""The press's torque in free travel, both ways, against its lifting spring's."""

from __future__ import annotations

import math

import pytest

from tester.base.source import InvalidSource
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.image.process_image import Readings
from tester.kinds.wheel_on_belt.interlocks.monitors import LEAST_READINGS, UNDER_WAY_MM, FreeTravel

SPRING_NM = 0.0318
DIGIT_NM = 1e-3


class Travel:
    """A press that moves to and fro, 0.1 mm a reading."""

    def __init__(
        self, gain: float = 1.0, drag_nm: float = 0.015, efficiency: float = 0.9, rate: float = 0.0,
        believed_rate: float = 0.0,
    ) -> None:  # fmt: skip
        self.free = FreeTravel(SPRING_NM, believed_rate, DIGIT_NM)
        self.rate = rate
        self.gain, self.drag_nm, self.excess = gain, drag_nm, 1.0 / efficiency - 1.0
        self.now_s, self.press_mm = 0.0, 5.0

    def go(self, way_mm: float, clear: bool = True) -> float:
        """Move by this distance; return the error of the torque."""
        way = math.copysign(1.0, way_mm)
        for _ in range(round(abs(way_mm) / 0.1)):
            self.now_s += 0.05
            self.press_mm += 0.1 * way
            spring_nm = SPRING_NM + self.rate * self.press_mm
            torque_nm = spring_nm * (1.0 + way * self.excess) + way * self.drag_nm
            readings = Readings(press_at_s=self.now_s, press_mm=self.press_mm, press_torque_nm=self.gain * torque_nm)
            self.free.update(readings, clear)
        return self.free.off_share


@pytest.mark.parametrize("drag_nm", [0.01, 0.02])
@pytest.mark.parametrize("efficiency", [0.87, 0.93])
def test_friction_cancels_whatever_it_is(drag_nm: float, efficiency: float) -> None:
    travel = Travel(drag_nm=drag_nm, efficiency=efficiency)
    assert travel.go(2.0) == 0.0 and travel.go(-2.0) == 0.0
    assert 0.5 * (travel.free.down_nm + travel.free.up_nm) == pytest.approx(SPRING_NM)


def test_a_spring_whose_force_grows_is_that_of_its_place() -> None:
    travel = Travel(rate=8e-4, believed_rate=8e-4)
    travel.go(2.0)
    assert travel.go(-2.0) == 0.0
    travel = Travel(rate=8e-4)
    travel.go(2.0)
    assert travel.go(-2.0) == pytest.approx((8e-4 * 6.0 - DIGIT_NM) / SPRING_NM, rel=0.1)


@pytest.mark.parametrize("gain", [0.9, 1.1])
def test_a_gain_shows_with_a_spring_whose_force_grows(gain: float) -> None:
    travel = Travel(gain, rate=8e-4, believed_rate=8e-4)
    travel.go(2.0)
    assert travel.go(-2.0) == pytest.approx(0.1 - DIGIT_NM / (SPRING_NM + 8e-4 * 6.0), abs=0.005)


@pytest.mark.parametrize(("gain", "off"), [(0.9, 0.1), (1.1, 0.1), (0.98, 0.0)])
def test_a_gain_shows_beyond_half_a_digit(gain: float, off: float) -> None:
    travel = Travel(gain)
    travel.go(1.0)
    assert travel.go(-1.0) == pytest.approx(max(0.0, off - DIGIT_NM / SPRING_NM))


def test_a_gain_that_comes_between_two_ways_shows_in_the_next() -> None:
    travel = Travel()
    travel.go(1.0)
    travel.go(-1.0)
    travel.gain = 0.87
    assert travel.go(1.0) > 0.05


def test_one_way_alone_a_short_way_and_a_way_in_contact_give_no_result() -> None:
    travel = Travel(0.5)
    assert travel.go(2.0) == 0.0
    travel.go(-UNDER_WAY_MM - 0.1 * (LEAST_READINGS - 2))
    travel.go(0.2)
    travel.go(-3.0, clear=False)
    assert math.isnan(travel.free.up_nm)


def test_a_torque_that_is_not_known_is_beyond_every_limit() -> None:
    travel = Travel()
    travel.go(1.0)
    travel.gain = math.nan
    assert not travel.go(-1.0) <= 0.05


def test_a_spring_without_force_within_the_travel_is_refused() -> None:
    with pytest.raises(InvalidSource) as error:
        load_rig("sim", overrides=("axes.press.screw.spring_rate=40 N/mm",))
    assert "leaves the spring without force at -1 mm" in str(error.value)
