"""Recipes: the list with the number of problems, the text, the problems; runs start here."""

from __future__ import annotations

import os
import shlex
import subprocess
from functools import partial
from pathlib import Path
from typing import ClassVar

from textual.app import ComposeResult, SuspendNotSupported
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.content import Content
from textual.widgets import OptionList, TextArea
from textual.widgets.option_list import Option

from tester.base.trouble import in_words
from tester.service.commands import CheckRecipe, ShowPlan
from tester.tui.dialogs.plan_dialog import PlanDialog
from tester.tui.dialogs.start import StartDialog, number_in
from tester.tui.formatting import clean, clean_lines, fit
from tester.tui.host import Keys, View
from tester.tui.recipe_library import Checked, ListedRecipe, RecipeProblem, own_copy, read_again, shelf
from tester.tui.screen_scene import UNDER_WAY, ScreenScene
from tester.tui.widgets.panel_base import FAINT

FIRST = "quickstart"
GROUPS = ("Mine", "Shipped for this rig", "Shipped for other rigs")
"""Headings of the list."""
NAME = 16
"""Columns of a recipe's name; its conditions and hours follow."""
EDITORS = ("VISUAL", "EDITOR")
DEFAULT_EDITOR = "notepad" if os.name == "nt" else "vi"
TAKES_A_LINE = ("vi", "vim", "nvim", "nano", "emacs")
"""Editors that accept +LINE to open a file at a line."""
HELP = """\
The list on the left: your recipes, then those shipped: ✔ valid on this rig, ✘ with the number of problems, conditions,
hours of rig time. Problems are below the text, each with line,
column, the error and the source of the limit.

Enter   on a recipe: the start dialog, or with problems the first of them. On a problem: jump to its line.
e       edit in $EDITOR, a shipped recipe as your copy; the recipe is then checked again.
d       the plan: steps, durations, total, sliding distance, wear.
g       look for recipes again.
b       pages in browsers: codes to pair one, who is paired, and the end of a pairing.
Tab     from list to text to problems.
While the editor has the terminal, keys go to it: `tester stop` in another shell stops the rig.
"""


class RecipesView(View):
    """Lets a person choose, correct and start a recipe."""

    KEYS: ClassVar[Keys] = (("Enter", "Start"), ("e", "Edit"), ("d", "Plan"), ("space", "Hold"), ("a", "Ack"),
                            ("F1", "Help"), ("q", "Detach"))  # fmt: skip
    HELP: ClassVar[str | None] = HELP
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("e", "edit", "Edit", show=False),
        Binding("d", "plan", "Plan", show=False),
        Binding("g", "reload", "Look again", show=False),
        Binding("b", "app.pages", "Browsers", show=False),
    ]

    def __init__(self, *, id: str) -> None:  # noqa: A002 - as in Textual
        """Read nothing yet."""
        super().__init__(id=id)
        self.recipes: list[ListedRecipe] = []
        self.rows: list[ListedRecipe | None] = []
        """The rows of the list; None for the heading of a group."""
        self.checked: dict[str, Checked] = {}
        """Problems of each recipe, by its path."""
        self.failed: dict[str, str] = {}
        self.planned: dict[str, str] = {}
        """Conditions and hours of each recipe that can run, by its path."""
        self._asked = False

    def compose(self) -> ComposeResult:
        """Lay out list, text, problems."""
        with Horizontal():
            yield OptionList(id="recipe-list", markup=False)
            with Vertical(id="recipe-right"):
                yield TextArea("", read_only=True, show_line_numbers=True, soft_wrap=False, id="recipe-text")
                yield OptionList(id="problems", markup=False)

    def on_mount(self) -> None:
        """Read the recipes."""
        self.query_one("#recipe-list").border_title = "Recipes"
        self.query_one("#problems").border_title = "Problems"
        self.query_one("#problems").display = False
        self._read(FIRST)

    def take_focus(self) -> None:
        """Focus the list."""
        self.query_one("#recipe-list").focus()

    def show(self, scene: ScreenScene) -> None:
        """Check the recipes once there is a service."""
        if scene.linked and not self._asked and not scene.replayed and not scene.view_only:
            self._asked = True
            self._check_all()

    # -- the list ---------------------------------------------------------------------------------------------

    def _read(self, chosen: str) -> None:
        self.recipes = shelf(self.host.options.recipe_folder)
        self._list(next((recipe for recipe in self.recipes if recipe.name == chosen), None))

    def _list(self, chosen: ListedRecipe | None) -> None:
        """List the recipes by groups, the cursor on the chosen one."""
        self.rows, options = [], list[Option]()
        for group, title in enumerate(GROUPS):
            members = [recipe for recipe in self.recipes if self._group(recipe) == group]
            if members:
                self.rows += [None, *members]
                options += [Option(Content(title), disabled=True), *(Option(self._label(recipe)) for recipe in members)]
        listed = self.query_one("#recipe-list", OptionList)
        listed.clear_options()
        listed.add_options(options)
        paths = [recipe.path if recipe is not None else None for recipe in self.rows]
        at = paths.index(chosen.path) if chosen is not None and chosen.path in paths else 1
        listed.highlighted = at if at < len(self.rows) else None
        self._open()

    def _group(self, recipe: ListedRecipe) -> int:
        """Return the place of a recipe's group in ``GROUPS``; a shipped one that this rig cannot run is another's."""
        return 0 if not recipe.shipped else 2 if self.checked.get(str(recipe.path)) else 1

    def _label(self, recipe: ListedRecipe) -> Content:
        checked = self.checked.get(str(recipe.path))
        if recipe.unreadable or str(recipe.path) in self.failed:
            sign = "✘"
        elif checked is None:
            sign = "…"
        else:
            sign = f"✘ {len(checked)}" if checked else "✔"
        bad = sign.startswith("✘")
        name, size = fit(clean(recipe.name, 60), NAME), self.planned.get(str(recipe.path), "")
        return Content.assemble((f"{sign:<4}", "bold reverse" if bad else ""), f"{name:<{NAME}}", (size, FAINT))

    @property
    def chosen(self) -> ListedRecipe | None:
        """Return the recipe under the cursor."""
        at = self.query_one("#recipe-list", OptionList).highlighted
        return self.rows[at] if at is not None and at < len(self.rows) else None

    def _open(self) -> None:
        """Show the chosen recipe's text and problems."""
        recipe = self.chosen
        if recipe is None:
            return
        text = self.query_one("#recipe-text", TextArea)
        shown = clean_lines(recipe.text) if not recipe.unreadable else f"cannot be read: {clean(recipe.unreadable)}"
        if text.text != shown:
            text.load_text(shown)
        text.border_title = Content(clean(str(recipe.path) if not recipe.shipped else f"{recipe.name} (shipped)"))
        faults = self.checked.get(str(recipe.path)) or ()
        problems = self.query_one("#problems", OptionList)
        problems.clear_options()
        failed = self.failed.get(str(recipe.path), "")
        if not faults and not failed and problems.has_focus:
            self.take_focus()
        problems.display = bool(faults or failed)
        if failed:
            problems.add_option(Option(clean(failed)))
        problems.add_options([Option(f"{p.line}:{p.column} {clean(p.message)}") for p in faults])

    def _relabel(self, recipe: ListedRecipe) -> None:
        for at, listed in enumerate(self.rows):
            if listed is not None and listed.path == recipe.path:
                self.query_one("#recipe-list", OptionList).replace_option_prompt_at_index(at, self._label(listed))
        if self.chosen is not None and self.chosen.path == recipe.path:
            self._open()

    # -- checking ---------------------------------------------------------------------------------------------

    def _check_all(self) -> None:
        order = sorted(self.recipes, key=lambda recipe: recipe is not self.chosen)
        self._begin_check(order)

    def _begin_check(self, recipes: list[ListedRecipe]) -> None:
        """Check these recipes, and abandon earlier checks."""
        self.run_worker(partial(self._check, recipes), group="check", exclusive=True, exit_on_error=False)

    async def _check(self, recipes: list[ListedRecipe]) -> None:
        for recipe in recipes:
            if not recipe.unreadable:
                await self._check_one(recipe)
        if self.is_attached:
            self._list(self.chosen)
        for recipe in recipes:
            if self.checked.get(str(recipe.path)) == () and str(recipe.path) not in self.failed:
                await self._plan_one(recipe)

    async def _plan_one(self, recipe: ListedRecipe) -> None:
        """Ask for the number of conditions and the hours of a recipe, unless the rig is in use."""
        state = self.host.scene.state
        if state is None or (state.run is not None and state.run.outcome == UNDER_WAY):
            return
        plan = await self.host.ask(ShowPlan(recipe.reference, recipe.sent))
        if isinstance(plan, dict) and self.is_attached:
            hours = number_in(plan, "rig_seconds") / 3600.0
            self.planned[str(recipe.path)] = f"{number_in(plan, 'conditions'):4.0f}{hours:6.1f} h"
            self._relabel(recipe)

    async def _check_one(self, recipe: ListedRecipe) -> None:
        answer = await self.host.ask(CheckRecipe(recipe.reference, recipe.sent))
        problems = answer.get("problems") if isinstance(answer, dict) else None
        self.failed.pop(str(recipe.path), None)
        if isinstance(problems, list):
            self.checked[str(recipe.path)] = tuple(_problem(problem) for problem in problems)
        else:
            self.failed[str(recipe.path)] = "could not be checked"
        if self.is_attached:
            self._relabel(recipe)

    # -- keys -------------------------------------------------------------------------------------------------

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Show the highlighted recipe."""
        if event.option_list.id == "recipe-list":
            self._open()

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Start the recipe, or jump to the chosen problem."""
        event.stop()
        if event.option_list.id == "problems":
            self._jump(event.option_index)
            return
        recipe = self.chosen
        if recipe is None or recipe.unreadable:
            return
        checked = self.checked.get(str(recipe.path))
        if checked:
            self._jump(0)
            self.query_one("#problems").focus()
        elif checked is None:
            self.host.say(f"{recipe.name} has not been checked yet")
        else:
            self.host.push_screen(StartDialog(recipe))

    def _jump(self, at: int) -> None:
        recipe = self.chosen
        problems = (self.checked.get(str(recipe.path)) if recipe is not None else None) or ()
        if at < len(problems):
            text = self.query_one("#recipe-text", TextArea)
            row = min(max(problems[at].line - 1, 0), text.document.line_count - 1)
            text.move_cursor((row, max(problems[at].column - 1, 0)))

    def action_plan(self) -> None:
        """Show the plan."""
        recipe = self.chosen
        if recipe is not None and not recipe.unreadable:
            self.host.push_screen(PlanDialog(recipe))

    def action_reload(self) -> None:
        """Search for recipes again."""
        self._read(self.chosen.name if self.chosen is not None else FIRST)
        self._check_all()

    def action_edit(self) -> None:
        """Open the editor, then check again."""
        recipe = self.chosen
        if recipe is None or self.host.options.view_only:
            return
        try:
            file = own_copy(recipe, self.host.options.recipe_folder) if recipe.shipped else recipe
            self._edit(file)
        except OSError as error:
            self.host.say(f"cannot be edited: {in_words(error)}", problem=True)
            return
        except SuspendNotSupported:
            self.host.say("no editor can be shown here: edit the file, then press g", problem=True)
            return
        if recipe.shipped:
            self.host.say(f"your copy: {file.path}")
        self.checked.pop(str(file.path), None)
        self.planned.pop(str(file.path), None)
        self._read(file.name)
        others = [r for r in self.recipes if r.path != file.path and str(r.path) not in self.checked]
        self._begin_check([read_again(file), *others])

    def _edit(self, recipe: ListedRecipe) -> None:
        command = shlex.split(next((os.environ[name] for name in EDITORS if os.environ.get(name)), DEFAULT_EDITOR))
        problems = self.checked.get(str(recipe.path))
        if problems and Path(command[0]).name in TAKES_A_LINE:
            command.append(f"+{problems[0].line}")
        with self.host.suspend():
            subprocess.run([*command, str(recipe.path)], check=False)


def _problem(found: object) -> RecipeProblem:
    match found:
        case {"line": int(line), "column": int(column), "message": str(message)}:
            return RecipeProblem(line, column, message)
        case _:
            return RecipeProblem(1, 1, str(found))
