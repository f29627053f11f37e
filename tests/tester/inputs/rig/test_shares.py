"""Shared failures: each member is the rig's, and a single member shares nothing."""

from __future__ import annotations

import pytest

from tester.base.source import InvalidSource
from tester.inputs.rig.further_sensors import shares_of
from tester.kinds import load_rig


@pytest.mark.parametrize("name", ["sim", "grosch", "pin-on-disc"])
def test_every_packaged_rig_states_its_shared_failures(name: str) -> None:
    rig = load_rig(name)
    assert {share.shared for share in rig.shares.values()} >= {"supply", "ground", "adapter", "temperature"}


def test_the_devices_of_one_line_are_a_share_that_no_file_lists() -> None:
    found = shares_of(load_rig("sim"))
    assert found["heat_line"].members == ("jacket", "ir_thermometer") and "load_cell_line" not in found


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("members", "[load_cel, press]", "load_cel is no device and no axis with a drive, did you mean load_cell?"),
        ("members", "[press]", "expected two different members at least"),
        ("members", "[press, press]", "expected two different members at least"),
        ("shared", "water", "shares.force_supply.shared"),
    ],
)
def test_a_wrong_share_is_refused(key: str, value: str, message: str) -> None:
    with pytest.raises(InvalidSource) as refused:
        load_rig("sim", [f"shares.force_supply.{key}={value}"])
    assert message in str(refused.value)
