"""The runs in a folder: finding one by its name, naming all, telling those that were cut off."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from tester.lock import RUN_LOCK, Holder, user_of
from tester.store.reader import DATABASE
from tester.store.schema import StoreError

RUNS = Path("runs")
"""Where runs are kept unless told: under the working directory."""

MANIFEST = "manifest.json"
"""Written at a run's end, whatever the end: a run without one was cut off, or is under way."""


def find_run(name: str, under: Path = RUNS) -> Path:
    """Return the folder of a run, given as a folder, its ``run.db`` or a name under ``under``.

    Raises StoreError naming where it was looked for.
    """
    for folder in (Path(name), under / name):
        if (folder / DATABASE).is_file():
            return folder
        if folder.name == DATABASE and folder.is_file():
            return folder.parent
    raise StoreError(f"no run {name}: neither a run folder nor a name under {under}")


def run_folders(under: Path = RUNS) -> Iterator[Path]:
    """Yield the folders of runs under a folder, by name (which begins with the date); none where there is no folder."""
    for folder in sorted(under.iterdir()) if under.is_dir() else ():
        if (folder / DATABASE).is_file():
            yield folder


def under_way(folder: Path) -> Holder | None:
    """Return who works on a run at present, None where nobody does."""
    return user_of(folder / RUN_LOCK)


def cut_off(under: Path) -> list[Path]:
    """Return the runs under a folder that ended without an end: the process died, or the power failed."""
    return [f for f in run_folders(under) if not (f / MANIFEST).is_file() and under_way(f) is None]
