"""The doctor's report on the computer: its ports, adapters, disk, clock and punctuality."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tester.doctor import host_probes
from tester.doctor.bus_watch import RigWatch
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding, Severity
from tester.doctor.open_wires import SimulatedWires
from tester.doctor.probe_table import Probe
from tester.kinds import load_rig
from tests.tester.doctor.fake_computer import CELL, HEAT, FakeComputer, ip_link, on_adapters

RIG = load_rig("sim")


def found(probe: Probe, computer: FakeComputer) -> list[Finding]:
    return list(probe(Examination(on_adapters(RIG), computer, SimulatedWires(RIG), Path("runs"))))


def bad(findings: list[Finding]) -> list[str]:
    return [str(finding) for finding in findings if finding.severity >= Severity.WARNING]


@pytest.mark.parametrize(
    "probe",
    [
        host_probes.serial_ports,
        host_probes.latency_timers,
        host_probes.can_adapter,
        host_probes.disk,
        host_probes.clock,
        host_probes.rig_file,
    ],
)
def test_a_computer_that_is_as_it_should_be_has_no_warning(probe: Probe) -> None:
    assert bad(found(probe, FakeComputer())) == []


def test_a_port_that_is_not_there_is_named_with_those_that_are() -> None:
    computer = FakeComputer(ports={HEAT: FakeComputer().ports[HEAT]})
    assert bad(found(host_probes.serial_ports, computer)) == [
        f"fault   line load_cell: there is no serial port {CELL} (there are: /dev/ttyUSB1)"
    ]


def test_a_port_that_may_not_be_used_names_the_group_to_join() -> None:
    findings = found(host_probes.serial_ports, FakeComputer(forbidden=frozenset({HEAT})))
    (refused,) = [finding for finding in findings if finding.severity is Severity.FAULT]
    assert refused.subject == "line heat"
    assert "usermod -a -G dialout" in refused.todo


def test_an_unused_port_is_noted() -> None:
    computer = FakeComputer()
    computer.ports["/dev/serial/by-id/other"] = type(computer.ports[CELL])("/dev/ttyUSB7", "CP2102")
    assert any("/dev/ttyUSB7 (CP2102)" in str(finding) for finding in found(host_probes.serial_ports, computer))


def test_a_latency_timer_of_16_ms_names_the_file_to_write_on_linux() -> None:
    (slow, _) = found(host_probes.latency_timers, FakeComputer(latency={CELL: 16, HEAT: 1}))
    assert slow.severity is Severity.WARNING
    assert "/sys/bus/usb-serial/devices/ttyUSB0/latency_timer" in slow.todo


def test_a_latency_timer_of_16_ms_names_the_device_manager_on_windows() -> None:
    (slow,) = found(host_probes.latency_timers, FakeComputer(platform="win32", latency={CELL: 16}))
    assert "Device Manager" in slow.todo


def test_a_port_without_a_latency_timer_gives_no_finding() -> None:
    assert found(host_probes.latency_timers, FakeComputer(latency={})) == []


def test_a_can_interface_at_another_bit_rate_is_a_fault() -> None:
    computer = FakeComputer(outputs={"ip": ip_link(125_000)})
    assert bad(found(host_probes.can_adapter, computer)) == [
        "fault   CAN adapter: can0 runs at a bit rate of 125000 bit/s, the rig file has 500000"
    ]


def test_a_can_interface_that_is_bus_off_is_a_fault() -> None:
    computer = FakeComputer(outputs={"ip": ip_link(state="BUS-OFF")})
    assert bad(found(host_probes.can_adapter, computer)) == ["fault   CAN adapter: can0 is bus-off"]


def test_a_can_interface_that_is_down_names_the_command() -> None:
    computer = FakeComputer()
    computer.files["/sys/class/net/can0/operstate"] = "down"
    down = next(finding for finding in found(host_probes.can_adapter, computer) if finding.severity is Severity.FAULT)
    assert down.todo == "sudo ip link set can0 up type can bitrate 500000 restart-ms 0"


def test_a_can_interface_that_is_not_there_is_named_with_those_that_are() -> None:
    computer = FakeComputer(files={"/sys/class/net/can7/operstate": "up"})
    assert bad(found(host_probes.can_adapter, computer)) == [
        "fault   CAN adapter: there is no interface can0 (there are: can7)"
    ]


def test_a_can_interface_without_a_bit_rate_is_no_warning() -> None:
    assert bad(found(host_probes.can_adapter, FakeComputer(outputs={}))) == []


def test_a_queue_that_takes_less_than_two_scans_is_a_warning() -> None:
    computer = FakeComputer()
    computer.files["/sys/class/net/can0/tx_queue_len"] = "10"
    (short,) = bad(found(host_probes.can_adapter, computer))
    assert "txqueuelen 10" in short


@pytest.mark.parametrize(
    ("free", "severity"),
    [
        (1_000_000, Severity.FAULT),
        (100_000_000, Severity.WARNING),
        (10_000_000_000, Severity.OK),
        (None, Severity.WARNING),
    ],
)
def test_the_disk_is_held_against_a_day_of_contact(free: int | None, severity: Severity) -> None:
    (finding,) = found(host_probes.disk, FakeComputer(free=free))
    assert finding.severity is severity


def test_a_run_folder_that_cannot_be_written_is_a_fault() -> None:
    assert bad(found(host_probes.disk, FakeComputer(forbidden=frozenset({"runs"}))))[0].startswith("fault   run folder")


@pytest.mark.parametrize(
    ("outputs", "severity"),
    [({"timedatectl": "yes\n"}, Severity.OK), ({"timedatectl": "no\n"}, Severity.NOTE), ({}, Severity.NOTE)],
)
def test_the_clock_is_reported_as_set_or_not(outputs: dict[str, str], severity: Severity) -> None:
    (finding,) = found(host_probes.clock, FakeComputer(outputs=outputs))
    assert finding.severity is severity


class Timed(Examination):
    """A check after its watch."""

    def __init__(self, late_s: list[float]) -> None:
        super().__init__(RIG, FakeComputer(), SimulatedWires(RIG))
        self.__dict__["watch"] = RigWatch(seconds=1.0, late_s=late_s)


def punctual(late_s: list[float]) -> Iterator[Finding]:
    return host_probes.punctuality(Timed(late_s))


def test_a_punctual_computer_is_reported_with_the_limits_it_supports() -> None:
    (finding,) = punctual([0.001] * 999 + [0.004])
    assert finding.severity is Severity.OK
    assert "at most 4.0 ms late" in finding.found
    assert "stale limits from 14 ms" in finding.found


def test_a_computer_whose_drive_data_would_be_stale_is_a_warning() -> None:
    (finding,) = punctual([0.001, 0.043])
    assert finding.severity is Severity.WARNING
    assert "25 ms old" in finding.found


def test_a_computer_that_is_later_than_a_scan_may_be_is_a_fault() -> None:
    (finding,) = punctual([0.001, 0.2])
    assert finding.severity is Severity.FAULT
    assert "150 ms" in finding.found


def test_in_simulated_time_the_computer_is_not_timed() -> None:
    (finding,) = punctual([])
    assert finding.severity is Severity.NOTE


def test_keys_that_the_rig_file_lacks_are_reported() -> None:
    examination = Examination(RIG, FakeComputer(), SimulatedWires(RIG), packaged_keys=("interlocks.pushed",))
    (finding,) = host_probes.rig_file(examination)
    assert "interlocks.pushed" in finding.found
