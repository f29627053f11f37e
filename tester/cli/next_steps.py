"""What `tester` alone prints: the next commands, from what is in this folder."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import NamedTuple

RUNS = "runs"
"""Folder of the runs below the working directory, as every command takes it by default."""
LOOKED_AT = 5
"""Runs, recipes and rig files of each sort that are considered, the newest first."""
YAML_HEAD = 100_000
"""Characters of a file that are read to tell a recipe from a rig file."""
_KEY = re.compile(r"^(\w+):[ \t]*([^#\n]*?)[ \t]*(?:#.*)?$", re.MULTILINE)
"""A top-level key with its value."""


class NextStep(NamedTuple):
    """A command line to type, and what it does here."""

    command: str
    does: str


def next_steps(here: Path) -> Iterator[NextStep]:
    """Yield what a person can do next in a folder, the most urgent first. Unreadable files are passed over."""
    runs = _runs(here / RUNS)
    recipes, rigs = _written(here)
    yield from islice(_unfinished(runs), LOOKED_AT)
    yield from _uncommissioned(rigs, here / RUNS)
    if not runs:
        yield NextStep("tester run quickstart", "measures two loads on the simulated rig, in seconds")
    for path in recipes:
        yield NextStep(f"tester run {path.name}", f"runs your recipe; `tester plan {path.name}` lists its steps")
    if runs:
        yield NextStep("tester show latest", f"prints the results of {runs[0].name}")
        yield NextStep("tester report latest", "writes them as one page to send")
    yield NextStep("tester new", "writes a recipe by five questions")
    if not rigs:
        yield NextStep("tester rig init my-rig.yaml", "writes a commented file for a rig of your own")
    yield NextStep("tester tui", "opens the operator's screen")
    yield NextStep("tester --help", "lists all commands")


def lines(here: Path) -> Iterator[str]:
    """Yield the steps as text, a line each: the command, then what it does."""
    steps = list(next_steps(here))
    width = max(len(step.command) for step in steps)
    for step in steps:
        yield f"{step.command:{width}}  {step.does}"


def _runs(folder: Path) -> list[Path]:
    """Return the runs of a folder, the newest first."""
    if not folder.is_dir():
        return []  # without runs the store is not loaded: a first call answers at once
    from tester.store.run_folders import run_folders

    return sorted(run_folders(folder), reverse=True)


def _unfinished(runs: list[Path]) -> Iterator[NextStep]:
    """Yield how to resume the newest runs that did not reach the end of their plan and that no process works on."""
    if not runs:
        return
    from tester.store.record_schema import StoreError
    from tester.store.run_folders import run_status, under_way
    from tester.store.run_reader import RunReader

    for folder in runs[:LOOKED_AT]:
        with suppress(StoreError, OSError), RunReader(folder) as reader:
            in_use = under_way(folder) is not None
            status = run_status(reader.run().status, held=in_use, missing=False)
            if status.can_resume:
                count = reader.count("repeat")
                kept = f"{count} repeat{'' if count == 1 else 's'} kept"
                yield NextStep(f"tester resume {folder.name}", f"resumes this run: {status}, {kept}")


def _written(here: Path) -> tuple[list[Path], dict[Path, str]]:
    """Return the newest recipes of a folder, and its rig files of real machines with the names of the rigs.

    The top-level keys tell them apart; no file is checked.
    """
    recipes: list[Path] = []
    rigs: dict[Path, str] = {}
    files = [path for path in here.glob("*.yaml") if path.is_file()]
    for path in sorted(files, key=lambda path: path.stat().st_mtime, reverse=True):
        with suppress(OSError), path.open(encoding="utf-8", errors="replace") as stream:
            top = dict(_KEY.findall(stream.read(YAML_HEAD)))
            if "recipe" in top:
                recipes.append(path)
            elif "rig" in top and top.get("simulated") != "true":
                rigs[path] = top["rig"].strip("\"'")
    return recipes[:LOOKED_AT], dict(islice(rigs.items(), LOOKED_AT))


def _uncommissioned(rigs: dict[Path, str], runs: Path) -> Iterator[NextStep]:
    """Yield how to commission the rigs that have no record of it."""
    if not rigs:
        return
    from tester.machine.commission.record import record_path

    for path, rig in rigs.items():
        if not record_path(runs, rig).is_file():
            yield NextStep(f"tester commission {path.name}", "guides you through commissioning; none is on record")
