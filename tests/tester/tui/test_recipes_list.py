"""The list of recipes: a person's own first, then those for this rig, each with its conditions and hours."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from tester.tui.pages.recipes import GROUPS, RecipesView
from tester.tui.recipe_library import RecipeProblem
from tests.tester.service.views import state
from tests.tester.tui.stage import Stage, play


def test_recipes_are_grouped_with_conditions_and_hours(tmp_path: Path) -> None:
    (tmp_path / "recipes").mkdir()
    (tmp_path / "recipes" / "mine.yaml").write_text("recipe: mine\n", encoding="utf-8")

    async def act(on: Stage) -> None:
        await on.show(replace(state("OFFLINE"), run=None))
        await on.pilot.press("g")
        await on.until(on.checked, "the recipes are checked")
        view = on.app.query_one(RecipesView)
        own = next(recipe for recipe in view.recipes if not recipe.shipped)
        await on.until(lambda: str(own.path) in view.planned, "my recipe is planned")
        lines = on.text().split("\n")
        at = {title: next(n for n, line in enumerate(lines) if title in line) for title in GROUPS[:2]}
        (mine,) = [n for n, line in enumerate(lines) if "✔   mine" in line]
        assert at["Mine"] < mine < at["Shipped for this rig"] and GROUPS[2] not in on.text()
        assert "   2   0.8 h" in lines[mine]  # two conditions, 2,700 s

    play(act, tmp_path)


def test_a_shipped_recipe_that_this_rig_cannot_run_is_among_those_of_other_rigs(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await on.until(on.checked, "the recipes are checked")
        view = on.app.query_one(RecipesView)
        other = next(recipe for recipe in view.recipes if recipe.name == "grosch")
        view.checked[str(other.path)] = view.checked[str(other.path)] or (RecipeProblem(1, 1, "for another rig"),)
        view._list(view.chosen)
        await on.pilot.pause()
        lines = on.text().split("\n")
        heading = next(n for n, line in enumerate(lines) if GROUPS[2] in line)
        assert "✘ 1 grosch" in lines[heading + 1]
        assert view.chosen is not None and view.chosen.name == "quickstart"

    play(act, tmp_path)
