"""The doctor's probes in order, and a file of their findings. A new probe needs a function and a line here."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Final, NamedTuple
from zipfile import ZIP_DEFLATED, ZipFile

from tester.doctor import can_probes, drive_probes, host_probes, line_probes, rehearsal, steadiness
from tester.doctor.device_parameters import dumped
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding
from tester.run.provenance import git_revision, library_versions

Probe = Callable[[Examination], Iterator[Finding]]


PROBES: Final[tuple[tuple[str, Probe], ...]] = (
    ("rig file", host_probes.rig_file),
    ("computer", host_probes.disk),
    ("computer", host_probes.clock),
    ("adapters", host_probes.serial_ports),
    ("adapters", host_probes.latency_timers),
    ("adapters", host_probes.can_adapter),
    ("CAN", can_probes.bus),
    ("CAN", drive_probes.axes),
    ("CAN", can_probes.strangers),
    ("Modbus", line_probes.lines),
    ("Modbus", line_probes.devices),
    ("Modbus", line_probes.units),
    ("watch", can_probes.masters),
    ("watch", can_probes.heartbeats),
    ("watch", can_probes.emergencies),
    ("watch", can_probes.load),
    ("watch", can_probes.errors),
    ("watch", line_probes.ages),
    ("watch", steadiness.steadiness),
    ("watch", steadiness.heat),
    ("watch", host_probes.punctuality),
    ("run", rehearsal.arming),
)


class TableEntry(NamedTuple):
    """A finding with its heading."""

    heading: str
    finding: Finding

    @property
    def as_data(self) -> dict[str, str]:
        """The entry as plain data for programs."""
        return {"heading": self.heading, **asdict(self.finding), "severity": self.finding.severity.word}


def examined(examination: Examination) -> Iterator[TableEntry]:
    """Yield every probe's findings as they arise. Raises InvalidSource if the rig file names unknown profiles."""
    for heading, probe in PROBES:
        for finding in probe(examination):
            yield TableEntry(heading, finding)


RUNS_NAMED = 3
"""Number of newest runs whose file names the bundle contains."""


def written_bundle(path: Path, e: Examination, findings: Sequence[TableEntry]) -> None:
    """Write the bundle; raises OSError. It contains nothing about the environment, users or other files."""
    texts = {
        "findings.txt": "".join(f"{entry.finding}\n        {entry.finding.todo}\n" for entry in findings),
        "findings.json": _json([entry.as_data for entry in findings]),
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
    """Return the names and sizes of the files of the newest runs, so that a person can request them."""
    runs = sorted((path for path in folder.glob("*") if path.is_dir()), key=lambda path: path.name)[-RUNS_NAMED:]
    return [
        f"{file.relative_to(folder).as_posix()} {file.stat().st_size} bytes"
        for run in runs
        for file in sorted(run.rglob("*"))
        if file.is_file()
    ]
