"""Runs `tester sweep` and `tester plan` as a user does, each sweep once, and reads the results."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from tests.campaigns.acceptance.bench import COMMAND, ROOT


class SweepError(Exception):
    """A command failed that a figure depends on."""


@dataclass(frozen=True, slots=True)
class SweepSpec:
    """One sweep; equal specifications run once. ``overrides`` as for ``--set``."""

    recipe: str
    """A shipped recipe's name, or the text of a recipe."""
    seeds: int
    overrides: tuple[str, ...] = ()
    first: int = 0
    """The first seed; the others follow it."""


@dataclass(frozen=True, slots=True)
class Swept:
    """A sweep's results: its exit code, and the rows of its tables as text."""

    code: int
    runs: list[dict[str, str]]
    conditions: list[dict[str, str]]


class Sweeps:
    """Sweeps in a folder of their own. ``command``: another installation's `tester`, or None for this checkout's."""

    def __init__(self, folder: Path, *, full: bool, jobs: int, command: str | None = None) -> None:
        """``full``: the long form of each topic; ``jobs``: runs side by side."""
        self.folder = folder
        self.full = full
        self.jobs = jobs
        self.command = command
        self._swept: dict[SweepSpec, Swept] = {}
        self._count = 0

    def sweep(self, spec: SweepSpec) -> Swept:
        """Return a sweep's results; run it if necessary. Raises SweepError if it leaves no tables."""
        if spec not in self._swept:
            self._swept[spec] = self._run(spec)
        return self._swept[spec]

    def plan(self, spec: SweepSpec) -> dict[str, object]:
        """Return the output of `tester plan --json` for a sweep's recipe. Raises SweepError."""
        code, output = self._tester("plan", self._named(spec.recipe), "--json", *_set(spec))
        if code:
            raise SweepError(f"tester plan: exit {code}: {output[-400:]}")
        return dict(json.loads(output))

    def _run(self, spec: SweepSpec) -> Swept:
        out = self._place("sweep")
        extent = ["--seeds", str(spec.seeds), "--seed", str(spec.first), "--jobs", str(self.jobs), "--out", str(out)]
        code, output = self._tester("sweep", self._named(spec.recipe), *extent, *_set(spec))
        lines = output.splitlines()
        folder = self.folder / lines[-1] if lines else out
        if not (folder / "runs.csv").is_file():
            raise SweepError(f"tester sweep: exit {code}, no table")
        return Swept(code, _rows(folder / "runs.csv"), _rows(folder / "conditions.csv"))

    def _named(self, recipe: str) -> str:
        """Return a recipe's name on a command line; a text becomes a file."""
        if "\n" not in recipe:
            return recipe
        path = self._place("recipe").with_suffix(".yaml")
        path.write_text(recipe, encoding="utf-8")
        return str(path)

    def _place(self, name: str) -> Path:
        self._count += 1
        return self.folder / f"{self._count:03d}-{name}"

    def _tester(self, *arguments: str) -> tuple[int, str]:
        """Run one command line to its end; return its exit code and standard output."""
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        start = [self.command] if self.command else [sys.executable, "-c", COMMAND]
        if not self.command:
            environment["PYTHONPATH"] = str(ROOT)
        done = subprocess.run(
            [*start, *arguments], cwd=self.folder, env=environment, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, encoding="utf-8", check=False,
        )  # fmt: skip
        return done.returncode, done.stdout


def _set(spec: SweepSpec) -> list[str]:
    return [word for override in spec.overrides for word in ("--set", override)]


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8-sig", newline="") as file:
        return list(csv.DictReader(file))
