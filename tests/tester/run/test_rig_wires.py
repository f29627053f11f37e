"""A run's wires to a machine: opened on one clock, connected, released."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from threading import Event, Thread

import pytest

from drivers.ports import BusLost
from sim.machines.wheel_on_belt.rig import WheelRig
from sim.servers.server import RigServer
from tester.base import clock
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.image.devices import Devices
from tester.kinds.wheel_on_belt.procedures.arming import WheelArming
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.connect import Connector, Stage
from tester.machine.tickers import TickStatistics, run_real_time
from tester.run.bus_log import BusLog
from tester.run.rig_wires import hardware_ports
from tester.run.simulated import simulated_ports
from tests.sim.servers.addresses import can_address, line_addresses
from tests.tester.run.reached import reached_over_tcp


class Connecting:
    """A connector as the ticker drives it."""

    waiting = False

    def __init__(self, connector: Connector) -> None:
        self.connector = connector

    @property
    def finished(self) -> bool:
        return self.connector.finished

    def tick(self, now: float) -> float:
        return self.connector.tick(now)


class Machine:
    """A rig alive behind sockets in a thread of its own."""

    def __init__(self) -> None:
        config = load_rig("sim")
        _, rig, _ = simulated_ports(config, 1, None)
        assert isinstance(rig, WheelRig)
        self.server = RigServer(rig, "127.0.0.1", 0)
        self.config = reached_over_tcp(config, can_address(self.server), line_addresses(self.server))
        self._stop, origin = Event(), clock.monotonic()
        self._thread = Thread(target=self.server.serve, args=(lambda: clock.monotonic() - origin, self._stop.is_set))
        self._thread.start()

    def off(self) -> None:
        """Switch it off; its clients see the end of their connections."""
        self._stop.set()
        self._thread.join()
        self.server.close()


@pytest.fixture
def machine() -> Iterator[Machine]:
    machine = Machine()
    yield machine
    machine.off()


def connect(config: RigConfig, log: BusLog) -> Connector:
    """Connect to every device of a machine and release the wires."""
    ports = hardware_ports(config, log)
    devices = Devices(config, ports)
    connector = Connector(devices, config, WheelArming(devices, config), config.arming.listen_s)
    run_real_time(
        Connecting(connector), None, poll=lambda _: None, statistics=TickStatistics(), pace=ports.pace
    )
    ports.close()
    return connector


def test_every_device_of_a_machine_is_connected_and_proved(machine: Machine, tmp_path: Path) -> None:
    log = BusLog(tmp_path, machine.config)
    connector = connect(machine.config, log)
    log.close()
    assert (connector.stage, connector.failure) == (Stage.READY, "")
    assert "77F#05" in (tmp_path / "can.log").read_text(encoding="utf-8")


def test_arrivals_are_stamped_by_the_clock_that_the_ticks_come_from(machine: Machine) -> None:
    ports = hardware_ports(machine.config, None)
    assert ports.pace is not None
    stamps: list[float] = []
    while not stamps:
        ports.pace.wait_until(ports.pace.now() + 0.05)
        now = ports.pace.now()
        ports.can.send(0x601, bytes.fromhex("4000100000000000"), now)
        stamps = [t for t, can_id, _ in ports.can.receive(now) if can_id == 0x581]
    assert 0.0 < stamps[0] <= now
    ports.close()


def test_the_clock_of_a_faster_machine_is_as_fast(machine: Machine) -> None:
    ports = hardware_ports(machine.config, None, times=50.0)
    assert ports.pace is not None and ports.pace.times == 50.0
    ports.close()


def test_a_machine_that_is_switched_off_is_a_lost_bus(machine: Machine) -> None:
    ports = hardware_ports(machine.config, None)
    assert ports.pace is not None
    machine.off()
    ports.pace.wait_until(5.0)
    with pytest.raises(BusLost):
        ports.can.receive(ports.pace.now())
    assert ports.pace.now() < 5.0
    ports.close()


def test_a_machine_that_is_not_there_leaves_nothing_open(machine: Machine) -> None:
    lines = dict.fromkeys(machine.config.lines, ("127.0.0.1", 1))
    broken = reached_over_tcp(load_rig("sim"), can_address(machine.server), lines)
    with pytest.raises(BusLost, match=r"127\.0\.0\.1:1"):
        hardware_ports(broken, None)
    hardware_ports(machine.config, None).close()  # the bus is free again
