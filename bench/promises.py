"""``python -m bench promises --against COMMIT``: the promised gains of this tree over that commit, and whether it keeps
them.

    python -m bench promises --against 45113df                       # all, plain and compiled, five rounds: hours
    python -m bench promises --against 45113df --compiled table2     # one of them
    python -m bench promises --against 45113df --quick --keep FOLDER  # less of each, compiled copies used again

Both versions run the recipes of COMMIT with the same seed in turns, each as ``tester run`` in its own process. The CPU
time of all processes of a run is compared; with ``--wall`` Table 2 is judged by its wall time, on an idle machine. A
figure is the median of the rounds, and a table also shows the least and the greatest. If the two versions need
different rig seconds for a recipe, the table also gives the ratio for equal rig seconds.

``--skeleton FOLDER`` holds ``rig.py``, a rig without interlocks and store (class ``Supervisor``), that runs between the
rounds: a version's ratio to it depends on the machine, but hardly on the machine's other work.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import yaml

from bench.figures import Figure, Limit, at_least, at_most, number, ratio, unavailable
from bench.ladder import recipes
from bench.report import missed, table
from bench.versions import Cost, Trees, build_of, in_turns, measured_on, parser_of, spent, versions

ROUNDS, QUICK_ROUNDS = 5, 3
JOBS = 2
BUILD_S = 60.0
"""Limit of a build on two idle cores."""
SKELETON_S = 600.0
SKELETON = """
import sys
from time import process_time
sys.path.insert(0, sys.argv[1])
from rig import Supervisor
skeleton = Supervisor(10)
begun = process_time()
skeleton.run(int(sys.argv[2]), 0.01, 1)
print(process_time() - begun)
"""
"""Ticks at 100 Hz, the slow devices at every tenth."""


class Asked(NamedTuple):
    """Limits of one kind of installation, relative to the same kind of the earlier version."""

    conditions: float
    """Least ratio of CPU times, COMMIT over this tree, of whole conditions ..."""
    flat: float
    """... and of sliding at 100 Hz nearly all the time."""
    skeleton: float
    """Least ratio of the speeds beside the skeleton while sliding, this tree over COMMIT."""
    table2: float
    """Greatest ratio of wall times of Table 2, this tree over COMMIT."""
    grosch: float = 0.5
    """Greatest ratio of CPU times of a master curve, this tree over COMMIT."""


ASKED = {"plain": Asked(2.5, 1.7, 2.2, 0.4), "compiled": Asked(3.0, 1.8, 2.7, 0.25)}


class Extent(NamedTuple):
    """The extent of the measurement, and its folders."""

    rounds: int
    quick: bool
    wall: bool
    skeleton: Path | None
    folder: Path


def conditions(trees: Trees, asked: Asked, extent: Extent) -> list[Figure]:
    """Return the comparison of whole conditions."""
    recipe = next(recipe for recipe in recipes() if recipe.quick is extent.quick)
    costs = in_turns(trees, recipe.text, extent.rounds, extent.folder)
    return faster(recipe.name, trees, costs, asked.conditions)


def flat(trees: Trees, asked: Asked, extent: Extent) -> list[Figure]:
    """Return the comparison of a run that slides nearly all the time, scanned at 100 Hz, and of both versions with the
    skeleton."""
    (recipe,) = (one for one in recipes() if one.quick is extent.quick and one.name.startswith("100 Hz"))
    source = extent.skeleton
    speeds: list[float] = []

    def run_skeleton() -> None:
        if source is not None and (source / "rig.py").exists():
            speeds.append(skeleton_speed(source))

    costs = in_turns(trees, recipe.text, extent.rounds, extent.folder, each_round=run_skeleton)
    figures = faster(recipe.name, trees, costs, asked.flat)
    return [*figures, *beside_skeleton(trees, costs, speeds, asked.skeleton, source)]


def table2(trees: Trees, asked: Asked, extent: Extent) -> list[Figure]:
    """Return the comparison of Table 2 in two jobs, by time and by memory."""
    text = table2_text(trees[0].folder, extent.quick)
    costs = in_turns(trees, text, extent.rounds, extent.folder, "--jobs", str(JOBS))
    name = f"Table 2, {JOBS} jobs" + (", a temperature of two compounds" if extent.quick else "")
    limit = at_most(asked.table2)
    return [
        *shorter(name, trees, costs, None if extent.wall else limit),
        _share(f"{name}: wall", trees, costs, lambda cost: cost.wall_s, limit if extent.wall else None),
        _share(f"{name}: memory", trees, costs, lambda cost: cost.memory_mb, at_most(1.0)),
        *_spent(name, trees, costs, "MB", lambda cost: cost.memory_mb),
    ]


def grosch(trees: Trees, asked: Asked, extent: Extent) -> list[Figure]:
    """Return the comparison of a master curve; most of its rig time passes while the chamber settles."""
    text = grosch_text(trees[0].folder, extent.quick)
    costs = in_turns(trees, text, extent.rounds, extent.folder, "--rig", "grosch")
    name = "grosch" + (", two temperatures, seven speeds" if extent.quick else "")
    return shorter(name, trees, costs, at_most(asked.grosch))


PROMISES: dict[str, Callable[[Trees, Asked, Extent], list[Figure]]] = {
    "conditions": conditions, "flat": flat, "table2": table2, "grosch": grosch,
}  # fmt: skip
BUILD = "build"


def table2_text(before: Path, quick: bool) -> str:
    """Return the earlier version's Table 2; ``quick``: two of its compounds, one of its temperatures."""
    recipe = yaml.safe_load((before / "recipes" / "table2.yaml").read_text(encoding="utf-8"))
    if quick:
        recipe["specimens"] = recipe["specimens"][:JOBS]
        recipe["grids"] = [grid | {"temperature": "40 degC"} for grid in recipe["grids"]]
    return _written(recipe)


def grosch_text(before: Path, quick: bool) -> str:
    """Return the earlier version's master curve; ``quick``: two temperatures, the seven fastest speeds, one track."""
    recipe = yaml.safe_load((before / "recipes" / "grosch.yaml").read_text(encoding="utf-8"))
    if quick:
        grid = recipe["grids"][0] | ({"surface": "silicon carbide"} if "surface" in recipe["grids"][0] else {})
        recipe["grids"] = [grid | {"temperature": ["0 degC", "30 degC"], "track_speed": grid["track_speed"][2:]}]
    return _written(recipe)


def _written(recipe: dict[str, Any]) -> str:
    return yaml.safe_dump(recipe, sort_keys=False, allow_unicode=True)


Costs = tuple[list[Cost], list[Cost]]


def faster(name: str, trees: Trees, costs: Costs, least: float) -> list[Figure]:
    """Return the speed ratio of this tree, for the recipe and for equal rig seconds, and the cost of each run."""
    words = f"{name}: CPU, {trees[0].name} / {trees[1].name}"
    cpu_s = [[cost.cpu_s for cost in side] for side in costs]
    paces = [[cost.cpu_s / cost.rig_s for cost in side] for side in costs]
    return [
        ratio(words, *cpu_s, at_least(least)),
        ratio(f"{words}, equal rig s", *paces),
        *_spent(name, trees, costs),
    ]


def shorter(name: str, trees: Trees, costs: Costs, limit: Limit | None) -> list[Figure]:
    """Return this tree's CPU time as a part of the earlier one, and the cost of each run."""
    return [
        _share(f"{name}: CPU", trees, costs, _cpu_s, limit),
        _share(f"{name}: CPU for equal rig s", trees, costs, lambda cost: cost.cpu_s / cost.rig_s, None),
        *_spent(name, trees, costs),
    ]


def _share(name: str, trees: Trees, costs: Costs, of: Callable[[Cost], float], limit: Limit | None) -> Figure:
    before, now = ([of(cost) for cost in side] for side in costs)
    return ratio(f"{name}, {trees[1].name} / {trees[0].name}", now, before, limit)


def _cpu_s(cost: Cost) -> float:
    return cost.cpu_s


def _spent(
    name: str, trees: Trees, costs: Costs, unit: str = "s CPU", of: Callable[[Cost], float] = _cpu_s
) -> list[Figure]:
    return [
        Figure(f"{name}: {tree.name}", unit, tuple(map(of, own)), note=f"{number(own[0].rig_s)} rig s")
        for tree, own in zip(trees, costs, strict=True)
    ]


def skeleton_speed(source: Path) -> float:
    """Run the skeleton in a process of its own and return its rig seconds per CPU second."""
    ticks = round(SKELETON_S * 100)
    printed, _ = spent("the skeleton", [sys.executable, "-c", SKELETON, str(source), str(ticks)], source, {})
    return SKELETON_S / float(printed)


def beside_skeleton(
    trees: Trees, costs: Costs, skeleton: Sequence[float], least: float, source: Path | None
) -> list[Figure]:
    """Return the skeleton's speed, that of both versions beside it, and the ratio of the two."""
    name = f"beside the skeleton: {trees[1].name} / {trees[0].name}"
    if source is None:
        return [unavailable(name, "x", "no --skeleton FOLDER was given")]
    if not skeleton:
        return [unavailable(name, "x", f"there is no {source / 'rig.py'}")]
    before, now = ([cost.rig_s / cost.cpu_s for cost in side] for side in costs)
    beside = [ratio(f"{tree.name} / skeleton", own, skeleton) for tree, own in zip(trees, (before, now), strict=True)]
    return [
        Figure("skeleton", "rig s/CPU s", tuple(skeleton)),
        *beside,
        ratio(name, beside[1].runs, beside[0].runs, at_least(least)),
    ]


def build(trees: Trees) -> list[Figure]:
    """Return the cost of building the compiled copy: its user time on two cores, and its wall time here."""
    cost = build_of(trees[1])
    note = "user time / 2, an estimate for two idle cores"
    return [
        Figure("compiled build", "s", (cost.user_s / 2,), at_most(BUILD_S), note),
        Figure("compiled build, wall time here", "s", (cost.wall_s,)),
    ]


def main(arguments: Sequence[str]) -> int:
    """Measure and print; return 1 if a figure misses its limit."""
    parser = parser_of("promises", "What this tree was to gain over an earlier commit.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join([*PROMISES, BUILD])} (default: all)")
    parser.add_argument("--skeleton", type=Path, metavar="FOLDER", help="folder of the skeleton's rig.py")
    parser.add_argument("--rounds", type=int, metavar="N", help=f"rounds ({ROUNDS}; {QUICK_ROUNDS} with --quick)")
    parser.add_argument("--wall", action="store_true", help="judge Table 2 by wall time: nothing else runs")
    given = parser.parse_args(arguments)
    if unknown := [name for name in given.names if name not in (*PROMISES, BUILD)]:
        parser.error(f"no figure {unknown[0]!r}; there are: {', '.join([*PROMISES, BUILD])}")
    if given.rounds is not None and given.rounds < 1:
        parser.error("--rounds must be at least 1")
    names = given.names or [*PROMISES, BUILD]
    skeleton = given.skeleton.resolve() if given.skeleton else None
    rounds = given.rounds or (QUICK_ROUNDS if given.quick else ROUNDS)
    results: dict[str, list[Figure]] = {}
    with TemporaryDirectory(prefix="promises-", ignore_cleanup_errors=True) as folder:
        extent = Extent(rounds, given.quick, given.wall, skeleton, Path(folder))
        for kind, trees in versions(given, extent.folder):
            for name, measure in PROMISES.items():
                if name in names:
                    print(f"measuring: {kind}, {name}", file=sys.stderr, flush=True)
                    results[kind] = results.get(kind, []) + measure(trees, ASKED[kind], extent)
                    print(table({kind: results[kind]}, {}), file=sys.stderr, flush=True)
            if kind == "compiled" and BUILD in names:
                results[kind] = results.get(kind, []) + build(trees)
    print(table(results, measured_on()))
    return int(bool(missed(results)))
