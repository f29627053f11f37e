"""A file for whoever helps from far: findings, rig file, versions, parameters, names of logs. No secrets."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

from tester.doctor.examination import Examination
from tester.doctor.parameters import dumped
from tester.doctor.table import TableEntry
from tester.run.provenance import git_revision, library_versions

RUNS_NAMED = 3
"""Of so many last runs the names of the files are told."""


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
