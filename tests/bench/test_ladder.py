"""The ladder: ratios and intervals from the rounds, recipes that every version reads, turns, exit code."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import pytest
import yaml

from bench.child import ROOT
from bench.cli import main as bench
from bench.ladder import Recipe, climb, ratio_of, recipes
from bench.versions import Cost, Tree, sources
from tester.inputs.recipe.loader import load_checked
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.recipe.part import PART


def test_a_ratio_is_the_geometric_mean_of_the_rounds_with_students_interval() -> None:
    ratio = ratio_of([2.0, 8.0], [1.0, 1.0])
    assert ratio.mean == pytest.approx(4.0)
    # Two rounds: logarithms ln 2 and ln 8, s = ln 4 / sqrt 2, t = 12.706.
    assert ratio.low == pytest.approx(4.0 * 2.0**-12.706, rel=1e-3)
    assert ratio.high == pytest.approx(4.0 * 2.0**12.706, rel=1e-3)


@pytest.mark.parametrize(
    ("now", "misses"),
    [((1.0, 1.01, 0.99), False), ((1.08, 1.09, 1.07), True), ((1.05, 1.40, 0.80), False), ((1.02, 1.02, 1.02), False)],
)
def test_a_ratio_misses_where_its_whole_interval_is_too_low(now: tuple[float, ...], misses: bool) -> None:
    assert ratio_of([1.0, 1.0, 1.0], now).misses is misses


@pytest.mark.parametrize("recipe", list(recipes()), ids=lambda recipe: recipe.name)
def test_every_recipe_is_valid(recipe: Recipe) -> None:
    assert load_checked(recipe.text, load_rig("sim"), PART, "ladder.yaml").recipe.recipe == recipe.name


class Timed(Tree):
    """A tree whose runs take the times of a table; keeps the order of the runs."""

    order: ClassVar[list[str]] = []

    def cost(self, recipe: Path, out: Path, *options: str) -> Cost:
        assert yaml.safe_load(recipe.read_text(encoding="utf-8")) == {"recipe": "a"} and not options
        self.order.append(self.name)
        cpu_s = 1.0 if self.name == "before" else 2.0
        return Cost(cpu_s, cpu_s, cpu_s, 100.0)


def test_trees_run_in_turns_that_alternate_and_a_slow_tree_misses(tmp_path: Path) -> None:
    Timed.order.clear()
    lines: list[str] = []
    trees = Timed("before", tmp_path), Timed("now", tmp_path)
    assert climb(trees, [Recipe("a", "recipe: a\n", True)], 3, tmp_path, lines.append) == 1
    assert Timed.order == ["now", "before", "before", "now", "now", "before"]
    assert lines == ["a                        0.500   (0.500 to 0.500)   MISSES   1.00 s, 2.00 s"]


def test_a_commit_that_does_not_exist_ends_with_its_name(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="no such commit: nothing-like-it"):
        bench(["ladder", "--against", "nothing-like-it", "--plain"])


def test_the_sources_of_this_tree_are_those_that_git_lists(tmp_path: Path) -> None:
    if not (ROOT / ".git").exists():
        pytest.skip("not a checkout")
    assert (sources(None, tmp_path) / "tester" / "cli" / "main.py").is_file()
