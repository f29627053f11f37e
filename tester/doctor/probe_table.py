"""All probes of the doctor in order, and a file of their findings. A new probe is a function and a line here."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Final, NamedTuple
from zipfile import ZIP_DEFLATED, ZipFile

from tester.doctor import can_probes, host_probes, line_probes
from tester.doctor.device_parameters import dumped
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding
from tester.run.provenance import git_revision, library_versions

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
    ProbeEntry("watch", can_probes.errors),
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


RUNS_NAMED = 3
"""Number of newest runs whose file names are included."""


def written_bundle(path: Path, e: Examination, found: Sequence[TableEntry]) -> None:
    """Write the bundle; raises OSError. Nothing of the environment, of users or of other files goes into it."""
    texts = {
        "findings.txt": "".join(f"{one.finding}\n        {one.finding.todo}\n" for one in found),
        "findings.json": _json([{"heading": one.heading, **one.finding.as_data} for one in found]),
        "rig.yaml": e.rig.text,
        "versions.json": _json({**library_versions(), "revision": git_revision()}),
        "parameters.json": dumped(e).text,
        "runs.txt": "".join(f"{line}\n" for line in _last_runs(e.runs)),
    }
    with ZipFile(path, "w", ZIP_DEFLATED) as archive:
        for name, text in texts.items():
            archive.writestr(name, text)


def _json(data: object) -> str:
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def _last_runs(folder: Path) -> list[str]:
    """Return the names and sizes of the files of the last runs: what else can be asked for."""
    runs = sorted((path for path in folder.glob("*") if path.is_dir()), key=lambda path: path.name)[-RUNS_NAMED:]
    return [
        f"{file.relative_to(folder).as_posix()} {file.stat().st_size} bytes"
        for run in runs
        for file in sorted(run.rglob("*"))
        if file.is_file()
    ]
