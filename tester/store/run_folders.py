"""Finds the runs in a folder, one by its name or all of them, each with its status."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from difflib import get_close_matches
from enum import StrEnum
from pathlib import Path

from tester.base.lock import RUN_LOCK, Holder, user_of
from tester.base.words import listed_some
from tester.store.record_file import DATABASE
from tester.store.record_schema import StoreError
from tester.store.run_reader import RunReader

RUNS = Path("runs")
"""Default folder of runs, under the working directory."""

MANIFEST = "manifest.json"
"""Written whenever a run ends: a run without a manifest was interrupted, or is in progress."""


NAMED = 4
"""Greatest number of runs named in a message."""
LATEST = "latest"
"""Word for the newest run in place of a name."""
_STAMPED = re.compile(r"\d{4}-\d{2}-\d{2}T\d{2}-\d{2}-\d{2}(?=-)")
"""Pattern of the beginning of a run folder's name."""


def find_run(name: str, under: Path = RUNS) -> Path:
    """Return the folder of a run, given by the folder, by its ``run.db`` or by a name under ``under``.

    A prefix is enough if only one run has it. ``latest`` is the newest run under ``under``, ``FOLDER/latest`` the
    newest under another folder; a folder of exactly that name has precedence. Raises StoreError with the searched
    places, and the runs with this prefix, or the nearest name.
    """
    for folder in (Path(name), under / name):
        if (folder / DATABASE).is_file():
            return folder
        if folder.name == DATABASE and folder.is_file():
            return folder.parent
    there = under if name == LATEST else Path(name).parent
    if Path(name).name == LATEST:
        newest = newest_run(there)
        if newest is not None:
            return newest
        raise StoreError(f"no run {name}: there is no run under {there}")
    begin_so = _beginning_with(name, under)
    if len(begin_so) == 1:
        return begin_so[0]
    if begin_so:
        some = listed_some([folder.name for folder in begin_so], NAMED)
        raise StoreError(f"no run {name}: {len(begin_so)} runs begin so: {some}")
    near = get_close_matches(name, [folder.name for folder in run_folders(under)], 1)
    hint = f", did you mean {near[0]}?" if near else ""
    raise StoreError(f"no run {name}: neither a run folder nor a name under {under}{hint}")


def _beginning_with(name: str, under: Path) -> list[Path]:
    """Return the runs whose names begin with the last part of ``name``, in the folder that it names or in ``under``."""
    path = Path(name)
    if not path.name or path.name.startswith("."):
        return []
    there = under if path.parent == Path() else path.parent
    return [folder for folder in run_folders(there) if folder.name.startswith(path.name)]


def newest_run(under: Path = RUNS) -> Path | None:
    """Return the folder of the run that began last; None if there is none.

    The date in the names decides. Between runs of the same second the records decide, and also between folders without
    a date, which are considered only if no others exist.
    """
    folders = list(run_folders(under))
    stamps = {folder: stamp[0] for folder in folders if (stamp := _STAMPED.match(folder.name))}
    newest = max(stamps.values(), default="")
    among = [folder for folder in folders if stamps.get(folder, "") == newest]
    return max(among, key=_began, default=None)


def _began(folder: Path) -> tuple[str, int, str]:
    """Return when a run began, by its record; if it has no entry, or entries are equal, the name decides."""
    began = ""
    with suppress(StoreError), RunReader(folder) as reader:
        began = reader.run().info.started_utc
    return began, len(folder.name), folder.name


def run_folders(under: Path = RUNS) -> Iterator[Path]:
    """Yield the folders of runs under a folder, by name (which begins with the date); nothing for a missing folder."""
    for folder in sorted(under.iterdir()) if under.is_dir() else ():
        if (folder / DATABASE).is_file():
            yield folder


def under_way(folder: Path) -> Holder | None:
    """Return the process that now works on a run; None if there is none."""
    return user_of(folder / RUN_LOCK)


def cut_off(under: Path) -> list[Path]:
    """Return the runs under a folder that have no recorded end, because the process died or the power failed."""
    return [f for f in run_folders(under) if not (f / MANIFEST).is_file() and under_way(f) is None]


class RunStatus(StrEnum):
    """Status of a run. All commands, screens, catalogues and JSON use these words."""

    RUNNING = "running"
    """A process works on the run: it holds the lock of the run's folder."""
    INTERRUPTED = "interrupted"
    """The run has no recorded end and no process works on it: the process died, the power failed, or the program was
    aborted.
    """
    DONE = "done"
    """The run completed its plan, and every condition has a trustworthy value."""
    INCOMPLETE = "incomplete"
    """The run completed its plan, and at least one condition has no trustworthy value."""
    STOPPED = "stopped"
    TRIPPED = "tripped"
    FAILED = "failed"
    UNREACHABLE = "rig unreachable"
    UNREADABLE = "unreadable"
    """The run's record cannot be read."""

    @property
    def over(self) -> bool:
        """Return whether the run completed its plan, so that nothing is left to resume."""
        return self in (RunStatus.DONE, RunStatus.INCOMPLETE)

    @property
    def can_resume(self) -> bool:
        """Return whether `tester resume` may continue the run."""
        return not self.over and self not in (RunStatus.RUNNING, RunStatus.UNREADABLE)


WENT_THROUGH = "done"
"""Status in the record of a run that completed its plan."""
_RECORDED = {
    "stopped": RunStatus.STOPPED,
    "tripped": RunStatus.TRIPPED,
    "rig unreachable": RunStatus.UNREACHABLE,
    "running": RunStatus.INTERRUPTED,
    "interrupted": RunStatus.INTERRUPTED,
}
"""Status by the word in the record, for a run without a process. ``running`` is written at the beginning."""


def run_status(recorded: str, *, held: bool, missing: bool) -> RunStatus:
    """Return the status of a run.

    ``recorded``: the status in its record; ``held``: a process holds the lock of its folder; ``missing``: a condition
    has no trustworthy value. An unknown word counts as failed: nothing shows that the run completed its plan.
    """
    if recorded == WENT_THROUGH:
        # Even while the lock is held: tables are being written, or a person is excluding a repeat.
        return RunStatus.INCOMPLETE if missing else RunStatus.DONE
    return RunStatus.RUNNING if held else _RECORDED.get(recorded, RunStatus.FAILED)
