"""PDO maps: bytes, parameters, objects that cannot be mapped."""

from __future__ import annotations

import copy

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.canopen import pdo
from drivers.canopen.pdo import PdoMap, PdoMapError


def test_rpdo1_is_controlword_and_target_velocity_little_endian() -> None:
    assert pdo.RPDO1_VELOCITY.pack(0x000F, -2) == bytes.fromhex("0F00 FEFFFFFF")


def test_tpdo1_is_statusword_velocity_and_torque() -> None:
    assert pdo.TPDO1_VELOCITY.unpack(bytes.fromhex("3716 10270000 9CFF")) == (0x1637, 10_000, -100)


@pytest.mark.parametrize(("mapped", "parameters"), [
    (pdo.RPDO1_VELOCITY, (0x60400010, 0x60FF0020)),
    (pdo.RPDO1_POSITION, (0x60400010, 0x607A0020)),
    (pdo.TPDO1_VELOCITY, (0x60410010, 0x606C0020, 0x60770010)),
    (pdo.TPDO1_POSITION, (0x60410010, 0x60640020, 0x60770010)),
    (pdo.RPDO2_OUTPUTS, (0x60FE0120,)),
    (pdo.TPDO2_INPUTS, (0x60FD0020,)),
])
def test_the_standard_maps_have_the_agreed_parameters(mapped: PdoMap, parameters: tuple[int, ...]) -> None:
    assert mapped.parameters() == parameters
    assert PdoMap.from_parameters(parameters) == mapped


def test_an_object_that_may_not_be_mapped_has_the_abort_of_the_standard() -> None:
    with pytest.raises(PdoMapError, match="0x1018:01") as caught:
        PdoMap.from_parameters([0x10180120])
    assert caught.value.abort_code == 0x06040041


def test_a_width_that_is_not_the_objects_is_refused() -> None:
    with pytest.raises(PdoMapError):
        PdoMap.from_parameters([0x60410020])


def test_more_than_eight_bytes_are_refused() -> None:
    with pytest.raises(PdoMapError) as caught:
        PdoMap.from_parameters([0x60640020, 0x606C0020, 0x60410010])
    assert caught.value.abort_code == 0x06040042


def test_a_deep_copy_of_a_map_is_the_map() -> None:
    assert copy.deepcopy([pdo.TPDO1_VELOCITY])[0] is pdo.TPDO1_VELOCITY


@given(st.integers(0, 0xFFFF), st.integers(-2**31, 2**31 - 1), st.integers(-2**15, 2**15 - 1))
def test_what_is_packed_is_unpacked(statusword: int, velocity: int, torque: int) -> None:
    mapped = pdo.TPDO1_VELOCITY
    assert mapped.unpack(mapped.pack(statusword, velocity, torque)) == (statusword, velocity, torque)
    assert mapped.size == len(mapped.pack(statusword, velocity, torque)) == 8
