"""Every probe of the doctor, in the order in which it looks. A new probe is a function, and a line here."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

from tester.doctor import bus_errors, can_probes, host_probes, line_probes
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding

Probe = Callable[[Examination], Iterator[Finding]]


class ProbeEntry(NamedTuple):
    """A probe, and the heading under which its findings stand."""

    heading: str
    probe: Probe


PROBES: Final[tuple[ProbeEntry, ...]] = (
    ProbeEntry("rig file", host_probes.rig_file),
    ProbeEntry("computer", host_probes.disk),
    ProbeEntry("computer", host_probes.clock),
    ProbeEntry("adapters", host_probes.serial_ports),
    ProbeEntry("adapters", host_probes.latency_timers),
    ProbeEntry("adapters", host_probes.can_adapter),
    ProbeEntry("CAN", can_probes.bus),
    ProbeEntry("CAN", can_probes.axes),
    ProbeEntry("CAN", can_probes.strangers),
    ProbeEntry("Modbus", line_probes.lines),
    ProbeEntry("Modbus", line_probes.devices),
    ProbeEntry("Modbus", line_probes.units),
    ProbeEntry("watch", can_probes.masters),
    ProbeEntry("watch", can_probes.heartbeats),
    ProbeEntry("watch", can_probes.emergencies),
    ProbeEntry("watch", can_probes.load),
    ProbeEntry("watch", bus_errors.errors),
    ProbeEntry("watch", line_probes.ages),
    ProbeEntry("watch", host_probes.punctuality),
)


class TableEntry(NamedTuple):
    """A finding under its heading."""

    heading: str
    finding: Finding


def examined(examination: Examination) -> Iterator[TableEntry]:
    """Yield what every probe finds, as it is found. Raises InvalidSource for a rig file whose profiles do not exist."""
    for heading, probe in PROBES:
        for finding in probe(examination):
            yield TableEntry(heading, finding)
