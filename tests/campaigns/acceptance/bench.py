"""Runs the product as its users do: `tester` in processes of its own, and keeps each outcome for all topics."""

from __future__ import annotations

import csv
import json
import math
import os
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from threading import Lock

import tester

ROOT = Path(tester.__file__).resolve().parent.parent
"""Folder that holds the packages under test."""

COMMAND = "from tester.cli.main import main; main()"
"""Same as the console script `tester`."""

CPU_TO_FILE = "import atexit, time; atexit.register(lambda: open({!r}, 'w').write(str(time.process_time())))\n"
"""For a platform that does not report a child's CPU time to its parent."""

PATIENCE_S = 7200
"""Time-out of a process, wall clock."""


class ProductError(Exception):
    """A command failed that a check depends on."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a process ended."""

    code: int
    stdout: str
    stderr: str
    cpu_s: float


@dataclass(frozen=True, slots=True)
class RunSpec:
    """One `tester run`; equal specifications run once."""

    recipe: str
    """A shipped recipe's name, or a file."""
    seed: int = 1
    overrides: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    """Further options; they must not change a result."""
    bus_log: bool = False


@dataclass(frozen=True, slots=True)
class Run:
    """A finished run."""

    outcome: Outcome
    folder: Path
    bus_log: Path

    def bytes_of(self, name: str) -> bytes:
        """Return one of the run's files."""
        return (self.folder / name).read_bytes()

    def rows(self, name: str) -> list[dict[str, str]]:
        """Return the rows of one of the run's tables."""
        with (self.folder / name).open(encoding="utf-8-sig", newline="") as file:
            return list(csv.DictReader(file))


class Bench:
    """Starts processes, several at a time, in a folder of its own."""

    def __init__(self, folder: Path, *, full: bool = False, jobs: int = 1) -> None:
        """``folder`` receives every run; ``full``: the long form of each topic; ``jobs``: runs side by side."""
        self.folder = folder
        self.full = full
        self._pool = ThreadPoolExecutor(max(jobs, 1))
        self._runs: dict[RunSpec, Future[Run]] = {}
        self._lock = Lock()
        self._count = 0

    def close(self) -> None:
        """Wait for running processes and drop the queued ones."""
        self._pool.shutdown(cancel_futures=True)

    # -- files ------------------------------------------------------------------------------------------------

    def place(self, name: str) -> Path:
        """Return a new path."""
        with self._lock:
            self._count += 1
            return self.folder / f"{self._count:03d}-{name}"

    def write(self, name: str, text: str) -> Path:
        """Write a text file and return its path."""
        path = self.place(name)
        path.write_text(text, encoding="utf-8")
        return path

    # -- commands ---------------------------------------------------------------------------------------------

    def tester(self, *arguments: str) -> Outcome:
        """Run one `tester` command line to its end."""
        return self.python(COMMAND, *arguments)

    def python(self, code: str, *arguments: str) -> Outcome:
        """Run Python code with the packages under test in a fresh interpreter."""
        place = self.place("process")
        place.mkdir()
        out, err, cpu = place / "stdout", place / "stderr", place / "cpu"
        if not hasattr(os, "wait4"):
            code = CPU_TO_FILE.format(str(cpu)) + code
        paths = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "PYTHONIOENCODING": "utf-8"}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)  # it would compile every module in every process
        with out.open("wb") as to_out, err.open("wb") as to_err:
            process = subprocess.Popen(
                [sys.executable, "-c", code, *arguments],
                cwd=self.folder, env=environment, stdin=subprocess.DEVNULL, stdout=to_out, stderr=to_err,
            )  # fmt: skip
            cpu_s = _wait(process)
        if math.isnan(cpu_s) and cpu.exists():
            cpu_s = float(cpu.read_text())
        texts = [path.read_text(encoding="utf-8", errors="replace") for path in (out, err)]
        return Outcome(process.returncode, texts[0], texts[1], cpu_s)

    def json(self, *arguments: str) -> dict[str, object]:
        """Return what a command prints with --json. Raises ProductError if it fails."""
        done = self.tester(*arguments, "--json")
        if done.code != 0:
            raise ProductError(f"tester {' '.join(arguments)}: exit {done.code}: {done.stderr.strip()[-500:]}")
        return dict(json.loads(done.stdout))

    # -- runs -------------------------------------------------------------------------------------------------

    def start(self, specs: Sequence[RunSpec]) -> None:
        """Start runs, or queue them."""
        for spec in specs:
            if spec not in self._runs:
                self._runs[spec] = self._pool.submit(self._run, spec)

    def run(self, spec: RunSpec) -> Run:
        """Return a finished run; start it if necessary. Raises ProductError if it has no tables."""
        self.start([spec])
        return self._runs[spec].result()

    def _run(self, spec: RunSpec) -> Run:
        place = self.place(f"run-{Path(spec.recipe).stem}-{spec.seed}")
        place.mkdir()
        arguments = ["run", spec.recipe, "--yes", "--seed", str(spec.seed), "--out", str(place / "runs")]
        for override in spec.overrides:
            arguments += ["--set", override]
        if spec.bus_log:
            arguments += ["--bus-log", str(place / "bus")]
        done = self.tester(*arguments, *spec.options)
        lines = done.stdout.splitlines()
        folder = (self.folder / lines[-1]) if lines else place
        if not (folder / "conditions.csv").is_file():
            raise ProductError(f"tester {' '.join(arguments)}: exit {done.code}: {done.stderr.strip()[-800:]}")
        return Run(done, folder, place / "bus")


def _wait(process: subprocess.Popen[bytes]) -> float:
    """Wait for a process and return the CPU time of it and its children in s, NaN if unknown."""
    if not hasattr(os, "wait4"):
        process.wait(PATIENCE_S)
        return math.nan
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return usage.ru_utime + usage.ru_stime
