"""The runs in a folder: finding one by its name, listing all."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tester.store.reader import DATABASE, RunReader
from tester.store.records import StoredRun
from tester.store.schema import StoreError

RUNS = Path("runs")
"""Where runs are kept unless told: under the working directory."""


@dataclass(frozen=True, slots=True)
class Listing:
    """One run folder: its name, the run as far as it can be read, repeats committed, conditions planned."""

    name: str
    run: StoredRun | None
    repeats: int
    conditions: int
    problem: str = ""


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


def list_runs(under: Path = RUNS) -> Iterator[Listing]:
    """Yield the runs under a folder, by name (which begins with the date); none where there is no folder."""
    for folder in sorted(under.iterdir()) if under.is_dir() else ():
        if not (folder / DATABASE).is_file():
            continue
        try:
            with RunReader(folder) as reader:
                yield Listing(folder.name, reader.run(), len(reader.repeats()), len(reader.conditions()))
        except StoreError as error:
            yield Listing(folder.name, None, 0, 0, str(error))
