"""Two versions of the software side by side: their sources, their compiled copies, and runs of both in turns."""

from __future__ import annotations

import argparse
import io
import json
import os
import sqlite3
import subprocess
import sys
import tarfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import NamedTuple

from bench.child import ROOT
from bench.machine import machine
from bench.stopwatch import wall_ns
from compiling.wanted import VARIABLE

TESTER = "import sys; from tester.cli.main import main; main()"
PROFILED = """
import cProfile, json, os, pstats, sys
from tester.cli.main import invoke
profile = cProfile.Profile()
profile.runcall(invoke, sys.argv[1:])
root, own = sys.path[0] + os.sep, {}
for (file, _, _), (_, _, alone, _, _) in pstats.Stats(profile).stats.items():
    name = file[len(root):].replace(os.sep, "/") if file.startswith(root) else "others"
    own[name] = own.get(name, 0.0) + alone
print("own " + json.dumps(own))
"""
NO_VALUE = 6
"""Exit code of a finished run in which a condition has no value."""
BUILT = "built.json"
"""In a compiled copy: the cost of its build."""
PACKAGES = ("compiling", "drivers", "recipes", "sim", "tester")
INSTALLED = ("pyproject.toml", "setup.py", *(f"{name}/**/*" for name in PACKAGES))
"""The sources of an installation."""


class Cost(NamedTuple):
    """The cost of a command."""

    cpu_s: float
    """User and system time of all its processes."""
    user_s: float
    wall_s: float
    memory_mb: float
    """Peak memory (10^6 bytes) of its largest process."""
    rig_s: float = 0.0
    """Rig seconds of the run; 0 for other commands."""


class Tree(NamedTuple):
    """A measured version: the folder of its packages."""

    name: str
    folder: Path

    def call(self, code: str, *arguments: str, accepted: tuple[int, ...] = (0,)) -> tuple[str, Cost]:
        """Run code with these packages; return its output and cost. A failure ends the measurement."""
        command = [sys.executable, "-P", "-c", code, *arguments]
        return spent(self.name, command, self.folder, {"PYTHONPATH": str(self.folder)}, accepted)

    def cost(self, recipe: Path, out: Path, *options: str) -> Cost:
        """Run a recipe with seed 1, its record in ``out`` (empty so far); return the cost of the whole command."""
        call = ("run", str(recipe), "--yes", "--seed", "1", "--out", str(out), *options)
        cost = self.call(TESTER, *call, accepted=(0, NO_VALUE))[1]
        (record,) = out.glob("*/run.db")
        with closing(sqlite3.connect(record)) as database:
            return cost._replace(rig_s=database.execute("SELECT rig_seconds FROM run").fetchone()[0])

    def own_s(self, recipe: str, out: Path, *options: str) -> dict[str, float]:
        """Return the CPU seconds in each file of the packages, by a profile; ``others``: outside them."""
        printed, _ = self.call(PROFILED, "run", recipe, "--yes", "--out", str(out), *options)
        line = next(line for line in printed.splitlines() if line.startswith("own "))
        return json.loads(line.removeprefix("own "))

    def parts(self, recipe: Path, out: Path) -> dict[str, float]:
        """Return the CPU seconds that each part of the packages takes for a recipe, by a profile."""
        parts: dict[str, float] = {}
        for file, own_s in self.own_s(str(recipe), out, "--seed", "1").items():
            names = file.split("/")
            part = "/".join(names[:2]) if names[0] == "tester" else names[0]
            parts[part] = parts.get(part, 0.0) + own_s
        return parts


Trees = tuple[Tree, Tree]
"""The earlier version and this tree."""


def in_turns(
    trees: Trees, text: str, rounds: int, folder: Path, *options: str, each_round: Callable[[], object] | None = None
) -> tuple[list[Cost], list[Cost]]:
    """Run a recipe on both versions in turns, ``each_round`` once in every round, and return the cost of each run."""
    recipe = folder / "recipe.yaml"
    recipe.write_text(text, encoding="utf-8")
    costs: tuple[list[Cost], list[Cost]] = ([], [])
    for number in range(rounds):
        if each_round is not None:
            each_round()
        for side in (0, 1) if number % 2 else (1, 0):  # alternate the order: speed drifts
            with TemporaryDirectory(dir=folder) as out:
                cost = trees[side].cost(recipe, Path(out), *options)
            costs[side].append(cost)
            print(f"{number + 1}: {trees[side].name}, {cost.cpu_s:.2f} s CPU", file=sys.stderr, flush=True)
    return costs


def spent(
    name: str, command: Sequence[str], folder: Path, variables: Mapping[str, str], accepted: tuple[int, ...] = (0,)
) -> tuple[str, Cost]:
    """Run a command in a folder with more variables in its environment; return its output and cost (POSIX). Raises
    SystemExit with ``name`` and the last of its complaints for an exit code that is not accepted.
    """
    with TemporaryFile() as out, TemporaryFile() as complaints:
        begun = wall_ns()
        child = subprocess.Popen(command, cwd=folder, env=os.environ | variables, stdout=out, stderr=complaints)
        _, status, used = os.wait4(child.pid, 0)
        wall_s = (wall_ns() - begun) * 1e-9
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        complaints.seek(0)
        printed, complained = (file.read().decode("utf-8", "replace") for file in (out, complaints))
    if child.returncode not in accepted:
        raise SystemExit(f"{name}: exit code {child.returncode}\n{complained[-2000:]}")
    unit = 1e-6 if sys.platform == "darwin" else 1.024e-3
    return printed, Cost(used.ru_utime + used.ru_stime, used.ru_utime, wall_s, used.ru_maxrss * unit)


def parser_of(name: str, description: str) -> argparse.ArgumentParser:
    """Return the parser of a command that compares two versions, with the common options."""
    parser = argparse.ArgumentParser(prog=f"python -m bench {name}", description=description)
    parser.add_argument("--against", required=True, metavar="COMMIT", help="the earlier version")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--plain", action="store_true", help="only as plain Python")
    which.add_argument("--compiled", action="store_true", help="only compiled")
    parser.add_argument("--quick", action="store_true", help="short recipes")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep compiled copies here, and use them again")
    return parser


def versions(given: argparse.Namespace, folder: Path) -> Iterator[tuple[str, Trees]]:
    """Yield both versions, plain, then compiled, each made in ``folder`` on demand."""
    before = Tree(given.against, sources(given.against, folder / "before"))
    now = Tree("this tree", sources(None, folder / "now"))
    if not given.compiled:
        yield "plain", (before, now)
    if not given.plain:
        kept = (given.keep or folder).resolve()
        kept.mkdir(parents=True, exist_ok=True)
        yield "compiled", (compiled(before, kept), compiled(now, kept))


def measured_on() -> dict[str, str | int]:
    """Return the machine and the interpreter, without this process's imports."""
    return {key: value for key, value in machine().items() if key not in ("measured", "compiled scan")}


def sources(commit: str | None, folder: Path) -> Path:
    """Write the sources of a commit, or of this checkout, into a folder and return it."""
    if commit is None:
        listed = subprocess.run(
            ["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=ROOT, check=True, capture_output=True
        )
        for name in filter(None, listed.stdout.decode().split("\0")):
            if (ROOT / name).is_file():
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                (folder / name).write_bytes((ROOT / name).read_bytes())
        return folder
    archive = subprocess.run(["git", "archive", commit], cwd=ROOT, check=False, capture_output=True)
    if archive.returncode:
        raise SystemExit(f"no such commit: {commit} ({archive.stderr.decode().strip()})")
    with tarfile.open(fileobj=io.BytesIO(archive.stdout)) as tar:
        tar.extractall(folder, filter="data")
    return folder


def compiled(tree: Tree, kept: Path) -> Tree:
    """Return a tree with its scan compiled: the copy in ``kept``, or a new one, without the packages it needs."""
    folder = kept / fingerprint(tree.folder)
    if not (folder / BUILT).exists():
        command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--upgrade", "--target", str(folder)]
        _, cost = spent(f"{tree.name}, compiling", [*command, str(tree.folder)], kept, {VARIABLE: "1"})
        (folder / BUILT).write_text(json.dumps(cost._asdict()), encoding="utf-8")
    return Tree(tree.name, folder)


def build_of(tree: Tree) -> Cost:
    """Return the cost of building a compiled copy."""
    return Cost(**json.loads((tree.folder / BUILT).read_text(encoding="utf-8")))


def fingerprint(folder: Path) -> str:
    """Return a name for this interpreter's installation of these sources."""
    digest = sha256(sys.version.encode())
    for path in sorted(path for pattern in INSTALLED for path in folder.glob(pattern)):
        if path.is_file() and path.suffix != ".pyc":
            digest.update(str(path.relative_to(folder)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]
