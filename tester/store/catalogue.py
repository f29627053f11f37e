"""The runs in a folder: one by its name, all of them, each with its status."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from difflib import get_close_matches
from enum import StrEnum
from pathlib import Path

from tester.base.lock import RUN_LOCK, Holder, user_of
from tester.base.words import listed_some
from tester.store.reader import DATABASE, RunReader
from tester.store.schema import StoreError

RUNS = Path("runs")
"""Where runs are kept unless told: under the working directory."""

MANIFEST = "manifest.json"
"""Written at a run's end, whatever the end: a run without one was cut off, or is under way."""


NAMED = 4
"""Runs that a message names at most."""
LATEST = "latest"
"""In place of a run's name: the newest run."""
_STAMPED = re.compile(r"\d{4}-\d{2}-\d{2}T\d{2}-\d{2}-\d{2}(?=-)")
"""How the name of a run's folder begins."""


def find_run(name: str, under: Path = RUNS) -> Path:
    """Return the folder of a run, given as a folder, its ``run.db`` or a name under ``under``.

    The beginning of a name does where one run alone begins so. ``latest`` is the newest run under ``under``,
    ``FOLDER/latest`` the newest under another folder; a folder of that very name comes first. Raises StoreError naming
    where it was looked for, and the runs that begin so, or the nearest name there is.
    """
    for folder in (Path(name), under / name):
        if (folder / DATABASE).is_file():
            return folder
        if folder.name == DATABASE and folder.is_file():
            return folder.parent
    there = under if name == LATEST else Path(name).parent
    if Path(name).name == LATEST:
        found = newest_run(there)
        if found is not None:
            return found
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
    """Return the runs whose names begin like the last part of ``name``, in the folder that it names or ``under``."""
    path = Path(name)
    if not path.name or path.name.startswith("."):
        return []
    there = under if path.parent == Path() else path.parent
    return [folder for folder in run_folders(there) if folder.name.startswith(path.name)]


def newest_run(under: Path = RUNS) -> Path | None:
    """Return the folder of the run that began last, None where there is none.

    By the date in the names; runs of one second, and folders without a date (looked at where no other is there), by
    what their records say.
    """
    folders = list(run_folders(under))
    stamps = {folder: found[0] for folder in folders if (found := _STAMPED.match(folder.name))}
    newest = max(stamps.values(), default="")
    among = [folder for folder in folders if stamps.get(folder, "") == newest]
    return max(among, key=_began, default=None)


def _began(folder: Path) -> tuple[str, int, str]:
    """Return when a run began, by its record; where that says nothing, or the same, by its name."""
    began = ""
    with suppress(StoreError), RunReader(folder) as reader:
        began = reader.run().info.started_utc
    return began, len(folder.name), folder.name


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


class RunStatus(StrEnum):
    """How a run stands. The words are those of every command, screen, catalogue and of JSON."""

    RUNNING = "running"
    """A process works on it: it holds the lock of the run's folder."""
    INTERRUPTED = "interrupted"
    """It has no end on record and nobody works on it: the process died, the power failed, the program broke off."""
    DONE = "done"
    """It went through its plan, and every condition has a value to be trusted."""
    INCOMPLETE = "incomplete"
    """It went through its plan, and a condition at least has no value to be trusted."""
    STOPPED = "stopped"
    TRIPPED = "tripped"
    FAILED = "failed"
    UNREACHABLE = "rig unreachable"
    UNREADABLE = "unreadable"
    """Its record cannot be read."""

    @property
    def over(self) -> bool:
        """Return whether its plan was gone through to the end: nothing is left to resume."""
        return self in (RunStatus.DONE, RunStatus.INCOMPLETE)

    @property
    def can_resume(self) -> bool:
        """Return whether `tester resume` may go on with it."""
        return not self.over and self not in (RunStatus.RUNNING, RunStatus.UNREADABLE)


WENT_THROUGH = "done"
"""What a record says of a run that went through its whole plan."""
_RECORDED = {
    "stopped": RunStatus.STOPPED,
    "tripped": RunStatus.TRIPPED,
    "rig unreachable": RunStatus.UNREACHABLE,
    "running": RunStatus.INTERRUPTED,
    "interrupted": RunStatus.INTERRUPTED,
}
"""What a record says, and what that means where nobody works on the run. ``running`` is written at the beginning."""


def run_status(recorded: str, *, held: bool, missing: bool) -> RunStatus:
    """Return the status of a run.

    ``recorded``: the status in its record; ``held``: a process holds the lock of its folder; ``missing``: a condition
    has no value to be trusted. A record whose word is none of ours has failed: nothing says that it went through.
    """
    if recorded == WENT_THROUGH:
        # Also while held: tables are being made, or a repeat is left out by hand.
        return RunStatus.INCOMPLETE if missing else RunStatus.DONE
    return RunStatus.RUNNING if held else _RECORDED.get(recorded, RunStatus.FAILED)
