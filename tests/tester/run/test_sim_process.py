"""The rig file that reaches a simulated rig over TCP."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.rig import RigConfig
from tests.tester.run.reached import reached_over_tcp


@pytest.fixture
def reached(tmp_path: Path) -> RigConfig:
    """Write a file and read it back."""
    rig = load_rig("sim", ("sim.ambient=31 degC",))
    addresses = {name: ("127.0.0.1", 1000 + number) for number, name in enumerate(rig.lines)}
    path = tmp_path / "rig.yaml"
    path.write_text(reached_over_tcp(rig, ("127.0.0.1", 29536), addresses).text, encoding="utf-8")
    return load_rig(path)


def test_it_is_a_machine_reached_by_socketcand_and_modbus_tcp(reached: RigConfig) -> None:
    assert not reached.simulated
    assert (reached.can.interface, reached.can.channel) == ("socketcand", "vcan0@127.0.0.1:29536")
    assert [(line.port, line.framing) for line in reached.lines.values()] == [
        ("127.0.0.1:1000", "socket"), ("127.0.0.1:1001", "socket"),
    ]  # fmt: skip


def test_the_air_around_it_is_that_of_the_simulated_rig(reached: RigConfig) -> None:
    assert reached.ambient_c == 31.0


def test_every_number_of_the_machine_is_the_same(reached: RigConfig) -> None:
    rig = load_rig("sim")
    assert (reached.axes, reached.limits, reached.interlocks, reached.devices, reached.scan) == (
        rig.axes, rig.limits, rig.interlocks, rig.devices, rig.scan,
    )  # fmt: skip
