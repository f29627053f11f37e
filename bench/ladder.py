"""``python -m bench ladder --against COMMIT``: speed of this tree against an earlier one, in turns.

    python -m bench ladder --against COMMIT                  # plain and compiled, five rounds: half an hour
    python -m bench ladder --against COMMIT --plain --quick  # four rounds of short recipes: what CI runs

Both trees go into folders of their own: the sources, and, compiled, the result of pip install. Each then runs the same
recipes with the same seed by ``tester run``, in turns, with the packages of this interpreter. A ratio is the CPU time
of COMMIT divided by that of this tree, so above 1 is faster; its interval holds the mean of the rounds' ratios with 95
% (Student's t of their logarithms). The recipes are whole tests, and tests that spend nearly all their time in one kind
of tick: 100 Hz (sliding), 20 Hz (heated, turning), 10 Hz (at rest). A ratio whose interval lies wholly below ``SLIP``
is a miss, and the exit code is 1; there are no retries. The parts of a scan, from a profile of the first recipe, are
printed for information (plain only).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from statistics import fmean, stdev
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import yaml

from bench.versions import Trees, in_turns, measured_on, parser_of, versions

SLIP = 0.97
"""Minimum ratio that the interval must reach."""
ROUNDS, QUICK_ROUNDS = 5, 4
STUDENT = {2: 12.706, 3: 4.303, 4: 3.182, 5: 2.776, 6: 2.571, 7: 2.447, 8: 2.365, 9: 2.306, 10: 2.262}
"""97.5 % quantile of Student's t by the number of rounds."""
Changes = Mapping[str, Any]

BASE: dict[str, Any] = {
    "specimens": [{"compound": "1#"}],
    "measure": {
        "wheel_speed": "0.8 m/s",
        "repeats": 1,
        "min_valid": 1,
        "window": "30 rev",
        "temperature_band": "2 degC",
        "soak": {"within": "1 degC", "for": "60 s"},
    },
    "grids": [{"name": "one", "slip_velocity": "300 mm/s", "load": "200 N", "temperature": "40 degC"}],
}
"""One condition; every recipe below changes some of its keys, in words that each version understands."""


class Recipe(NamedTuple):
    """A recipe to run on both trees; ``quick``: of the short form."""

    name: str
    text: str
    quick: bool


class Ratio(NamedTuple):
    """Ratios of the rounds, with the interval of their mean."""

    mean: float
    low: float
    high: float

    @property
    def misses(self) -> bool:
        """Whether the whole interval is below ``SLIP``."""
        return self.high < SLIP

    def __str__(self) -> str:
        return f"{self.mean:6.3f}   ({self.low:.3f} to {self.high:.3f}){'   MISSES' if self.misses else ''}"


def ratio_of(before: Sequence[float], now: Sequence[float]) -> Ratio:
    """Return the mean ratio of CPU times, round by round, with its 95 % interval; at least two rounds."""
    logs = [math.log(earlier / later) for earlier, later in zip(before, now, strict=True)]
    mean, half = fmean(logs), STUDENT[len(logs)] * stdev(logs) / math.sqrt(len(logs))
    return Ratio(math.exp(mean), math.exp(mean - half), math.exp(mean + half))


def recipes() -> Iterator[Recipe]:
    """Yield the recipes: whole tests first, then one for each kind of tick; short ones of a few seconds last."""
    pre_grind = {"wheel_speed": "0.8 m/s", "belt_speed": "0.6 m/s", "load": "200 N", "duration": "4 min"}
    rest = {"at_least": "20 min", "until": "25 degC", "within": "2 degC"}
    loads, both = {"load": ["100 N", "200 N"]}, {"temperature": ["40 degC", "55 degC"]}
    ground = {"pre_grind": pre_grind, "rest": rest}
    yield written("four conditions", ground, {"repeats": 5, "min_valid": 3}, loads | both)
    yield written("two conditions", ground, {"repeats": 2}, loads)
    slide = {"temperature_band": "20 K", "soak": {"within": "2 degC", "for": "2 s"}, "max_bursts": 1000}
    slow = {"slip_velocity": "100 mm/s", "load": "100 N", "temperature": "30 degC"}
    yield written("100 Hz, sliding", {}, slide | {"window": "800 rev"}, slow)
    yield written("20 Hz, turning", {}, turning_s(1500), both)
    long = {"rest": rest | {"at_least": "120 min", "at_most": "150 min"}}
    yield written("10 Hz, at rest", ground | long, {}, {})
    little = {"pre_grind": pre_grind | {"duration": "1 min"}, "rest": rest | {"at_least": "5 min"}}
    yield written("one condition", little, {"window": "14 rev"}, {}, quick=True)
    yield written("100 Hz, sliding", {}, slide | {"window": "100 rev"}, slow, quick=True)
    yield written("20 Hz, turning", {}, turning_s(300), {}, quick=True)


def turning_s(seconds: int) -> Changes:
    """Return how long a heated wheel turns before its measurement."""
    return {"soak": {"within": "1 degC", "for": f"{seconds} s"}}


def written(name: str, keys: Changes, measure: Changes, grid: Changes, quick: bool = False) -> Recipe:
    """Return a recipe: ``BASE`` with some keys changed."""
    changed = BASE | dict(keys) | {"measure": BASE["measure"] | dict(measure), "grids": [BASE["grids"][0] | dict(grid)]}
    return Recipe(name, yaml.safe_dump({"recipe": name} | changed, sort_keys=False), quick)


def climb(
    trees: Trees, chosen: Sequence[Recipe], rounds: int, folder: Path, show: Callable[[str], object]
) -> int:
    """Run the recipes on both trees in turns, show a line for each, and return the number of misses."""
    misses = 0
    for recipe in chosen:
        times = [[cost.cpu_s for cost in costs] for costs in in_turns(trees, recipe.text, rounds, folder)]
        ratio = ratio_of(*times)
        misses += ratio.misses
        show(f"{recipe.name:<24}{ratio}   {fmean(times[0]):.2f} s, {fmean(times[1]):.2f} s")
    return misses


def show_parts(trees: Trees, recipe: Recipe, folder: Path, show: Callable[[str], object]) -> None:
    """Show the ratio of each part of the packages in one profiled run of both trees."""
    path = folder / "recipe.yaml"
    path.write_text(recipe.text, encoding="utf-8")
    profiles: list[dict[str, float]] = []
    for tree in trees:
        with TemporaryDirectory(dir=folder) as out:
            profiles.append(tree.parts(path, Path(out)))
    before, now = profiles
    show(f"parts of {recipe.name}, by a profile (which slows calls down); s before, s now, ratio")
    for part in sorted(before.keys() | now.keys(), key=lambda part: -now.get(part, 0.0)):
        earlier, later = before.get(part, 0.0), now.get(part, 0.0)
        share = f"{earlier / later:6.2f}" if earlier and later else "     -"
        show(f"    {part:<20}{earlier:8.2f}{later:8.2f}  {share}")


def main(arguments: Sequence[str]) -> int:
    """Measure and print; return 1 if a ratio misses."""
    parser = parser_of("ladder", "Speed beside an earlier commit.")
    parser.add_argument("--rounds", type=int, choices=sorted(STUDENT), help="rounds of every recipe (default 5)")
    options = parser.parse_args(arguments)
    rounds = options.rounds or (QUICK_ROUNDS if options.quick else ROUNDS)
    chosen = [recipe for recipe in recipes() if recipe.quick is options.quick]
    misses = 0
    print(", ".join(f"{key}: {value}" for key, value in measured_on().items()), flush=True)
    with TemporaryDirectory(prefix="ladder-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        for kind, trees in versions(options, folder):
            print(f"{kind}: {rounds} rounds; CPU of {options.against} by that of this tree, 95 % interval", flush=True)
            misses += climb(trees, chosen, rounds, folder, lambda line: print(line, flush=True))
            if kind == "plain" and not options.quick:
                show_parts(trees, chosen[0], folder, print)
    return int(misses > 0)
