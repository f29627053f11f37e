"""The unit of an interlock's parameter."""

from __future__ import annotations

import pytest

from tester.base.units import UnitError
from tester.inputs.rig.parameter import Parameter


def test_a_unit_that_the_table_lacks_is_refused_where_the_parameter_is_declared() -> None:
    told = r'interlock parameter tilt_rate: the unit "deg/min" is not in the table.*add_kind'
    with pytest.raises(UnitError, match=told):
        Parameter("tilt_rate", "deg/min", "5 deg/min", "how fast it may tilt [A]")


def test_a_unit_with_a_point_is_the_one_with_a_space() -> None:
    assert Parameter("torque_nm", "N.m", "5 N m", "the torque").unit == "N.m"
