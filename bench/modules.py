"""Benefit and cost of the compiled modules: shares of a plain scan's CPU time, and the size of their C.

A share is a file's own time in a profile of a whole run, without its calls into other files; its base is the time in
the Python of this project. Profiles slow calls down and miss the cost of reading an object's fields, so a share only
serves to choose modules. The C is counted if mypyc is installed.
"""

from __future__ import annotations

import importlib.util
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from bench.child import ROOT
from bench.effort import Effort
from bench.figures import Figure, at_least, at_most
from bench.versions import Tree
from compiling.modules import HOT, PAYING, THRESHOLD

RECIPES = {"quickstart": ("--seed", "0"), "pin-on-disc": ("--seed", "0", "--rig", "pin-on-disc")}
"""A run of each kind of machine: a wheel at all rates of the scan, a specimen on a track with its prompts and waits."""
COMPILED_AT_LEAST = 90.0
"""Limit for the compiled modules together, % of a scan's Python."""
PACKAGES = ("drivers/", "sim/", "tester/")

Shares = Mapping[str, float]
"""% by file."""


def measure(effort: Effort) -> list[Figure]:
    """Return the shares of all compiled modules together, of each folder of them, and which should change sides."""
    tree = Tree("this checkout", ROOT)
    chosen = effort.pick(list(RECIPES), ["quickstart"])
    runs: list[dict[str, Shares]] = []
    for _ in range(effort.runs):
        with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as out:
            runs.append({name: shares_of(tree.own_s(name, Path(out), *RECIPES[name])) for name in chosen})
    return [
        *(together(name, [run[name] for run in runs]) for name in chosen),
        *folders(runs, c_kb() if importlib.util.find_spec("mypyc") else {}),
        *astray([greatest(run) for run in runs], partial="pin-on-disc" not in chosen),
    ]


def shares_of(own_s: Mapping[str, float]) -> Shares:
    """Return each file's share (%) of the time in this project's Python."""
    ours = {name: own for name, own in own_s.items() if name.startswith(PACKAGES)}
    total = sum(ours.values())
    return {name: 100.0 * own / total for name, own in ours.items()}


def greatest(run: Mapping[str, Shares]) -> Shares:
    """Return each file's greatest share in the recipes of a run."""
    files = {file for shares in run.values() for file in shares}
    return {file: max(shares.get(file, 0.0) for shares in run.values()) for file in files}


def together(recipe: str, runs: Sequence[Shares]) -> Figure:
    """Return the share of all compiled modules in a recipe."""
    values = tuple(sum(shares.get(file, 0.0) for file in HOT) for shares in runs)
    return Figure(f"all compiled modules, {recipe}", "%", values, at_least(COMPILED_AT_LEAST))


def folders(runs: Sequence[Mapping[str, Shares]], kilobytes: Mapping[str, float]) -> list[Figure]:
    """Return the compiled share of every folder, the greatest of the recipes, with its number of compiled modules."""
    names = {file: file.rpartition("/")[0] for file in HOT}
    figures: list[Figure] = []
    for folder, count in Counter(names.values()).items():
        files = [file for file in HOT if names[file] == folder]
        values = tuple(max(sum(s.get(file, 0.0) for file in files) for s in run.values()) for run in runs)
        lines = sum(len((ROOT / file).read_text(encoding="utf-8").splitlines()) for file in files)
        cost = f", {sum(kilobytes[file] for file in files):,.0f} kB of C" if kilobytes else ""
        figures.append(Figure(folder, "%", values, note=f"{count} modules, {lines:,} lines{cost}"))
    return sorted(figures, key=lambda figure: -figure.median)


def astray(runs: Sequence[Shares], *, partial: bool) -> list[Figure]:
    """Return how many modules are on the wrong side of the threshold, by a factor of two; ``partial``: for a first
    look."""

    def line(name: str, wrong: Sequence[Sequence[str]], asked: bool) -> Figure:
        limit = at_most(0.0) if asked and not partial else None
        return Figure(name, "", tuple(float(len(one)) for one in wrong), limit, ", ".join(wrong[0]))

    idle = [[file for file in PAYING if shares.get(file, 0.0) < THRESHOLD / 2] for shares in runs]
    busy = [
        sorted((f for f in shares if f not in HOT and shares[f] >= 2 * THRESHOLD), key=lambda f, s=shares: -s[f])
        for shares in runs
    ]
    return [
        line(f"listed as paying, below {THRESHOLD / 2:g} %", idle, True),
        line(f"not compiled, {2 * THRESHOLD:g} % or more", busy, False),
    ]


def c_kb() -> dict[str, float]:
    """Translate the modules and return the size of each one's C, kB (10^3 bytes)."""
    from compiling.command import c_file, translated

    with TemporaryDirectory(prefix="bench-") as folder:
        translated(Path(folder))
        return {file: (Path(folder) / c_file(file)).stat().st_size / 1e3 for file in HOT}
