"""Runs that questions have named, below one folder: results and pyramid are kept while a record stays the same."""

from __future__ import annotations

from collections import OrderedDict
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

from tester.page.stored.pyramid import Pyramid, keep, pyramid_of
from tester.results.run_results import RunResults, results_of
from tester.store.notes import tags_of
from tester.store.record_file import DATABASE
from tester.store.record_schema import StoreError
from tester.store.run_folders import under_way
from tester.store.run_reader import RunReader

MOST = 12
"""Runs whose results are kept: two overlays of six."""
MOST_PYRAMIDS = 4
"""Runs whose pyramid is kept: of a million samples it takes 30 MB."""


class QuestionError(Exception):
    """A question cannot be answered; the message gives the reason."""


class RunCache:
    """The runs below a folder."""

    def __init__(self, under: Path) -> None:
        """``under``: folder of the runs."""
        self.under = under
        self._results: OrderedDict[str, tuple[object, RunResults]] = OrderedDict()
        self._tags: dict[str, tuple[object, list[str]]] = {}
        self._pyramids: OrderedDict[str, Pyramid] = OrderedDict()
        self._keeping = ThreadPoolExecutor(1, "pyramids")
        """Writes files, so that no answer waits for the disk: a fifth of a second for a million samples."""

    def folder(self, name: object) -> Path:
        """Return the folder of a run named without a folder. Raises QuestionError."""
        if not isinstance(name, str) or not name or Path(name).name != name or name.startswith(".") or "\\" in name:
            raise QuestionError("run: expected the name of a run")
        folder = self.under / name
        if not (folder / DATABASE).is_file():
            raise QuestionError(f"no run {name} under {self.under}")
        return folder

    def results(self, folder: Path) -> RunResults:
        """Return a run's results. Raises StoreError."""
        state = _state(folder)
        kept = self._results.get(folder.name)
        if kept is None or kept[0] != state:
            with RunReader(folder) as reader:
                kept = state, results_of(reader)
            self._results[folder.name] = kept
        self._results.move_to_end(folder.name)
        while len(self._results) > MOST:
            self._results.popitem(last=False)
        return kept[1]

    def tags(self, name: str) -> list[str]:
        """Return a run's tags; none for a run that cannot be read, or is of another computer."""
        folder = self.under / name
        if not (folder / DATABASE).is_file():
            return []
        state = _state(folder)
        kept = self._tags.get(name)
        if kept is None or kept[0] != state:
            tags: list[str] = []
            with suppress(StoreError), RunReader(folder) as reader:
                tags = tags_of(reader)
            kept = self._tags[name] = state, tags
        return kept[1]

    def pyramid(self, reader: RunReader) -> Pyramid:
        """Return a run's pyramid. Raises StoreError."""
        name = reader.path.parent.name
        over = under_way(reader.path.parent) is None
        made = pyramid_of(
            reader, self._pyramids.get(name), lasting=over, keep=lambda file, one: self._keeping.submit(keep, file, one)
        )
        self._pyramids[name] = made
        self._pyramids.move_to_end(name)
        while len(self._pyramids) > MOST_PYRAMIDS:
            self._pyramids.popitem(last=False)
        return made


def _state(folder: Path) -> object:
    """Return what changes whenever a record does, or a process begins or ends its work on it."""
    found: list[object] = [under_way(folder) is not None]
    for name in (DATABASE, f"{DATABASE}-wal"):
        with suppress(OSError):
            status = (folder / name).stat()
            found += [status.st_mtime_ns, status.st_size]
    return tuple(found)


