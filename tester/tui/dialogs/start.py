"""Starts a run: specimen, operator, notes, and the pre-flight list. Only this dialog starts motion."""

from __future__ import annotations

from collections.abc import Iterable

from pydantic import JsonValue
from textual.containers import Horizontal
from textual.widget import Widget
from textual.widgets import Button, Checkbox, Input, Static

from tester.base.units import rig_speed
from tester.base.words import counted, duration
from tester.service.commands import RunRecipe, ShowPlan
from tester.service.state_view import Check
from tester.tui.dialogs.confirm import preflight_rows
from tester.tui.dialogs.dialog import Dialog, entry, field, line
from tester.tui.formatting import clean
from tester.tui.recipe_library import ListedRecipe

LATER = ("guard and safety chain", "zero of the load cell", "watchdogs of the drives")
"""Checks that the service makes before a drive is armed, and that must succeed for a start (docs/safety.md)."""


class PlainCheckbox(Checkbox):
    """A box whose label shows in words whether it is set, because Textual shows that only by colour."""

    BUTTON_INNER = "·"


class StartDialog(Dialog):
    """The last check before a run begins."""

    TITLE = "Start a run"
    AUTO_FOCUS = "#start"

    def __init__(self, recipe: ListedRecipe) -> None:
        """``recipe``: a recipe without problems."""
        super().__init__()
        self.recipe = recipe

    def content(self) -> Iterable[Widget]:
        """Return recipe, list, fields, buttons."""
        state = self.host.scene.state
        rig = clean(state.rig) if state is not None else "?"
        simulated = state is not None and state.simulated
        where = f"{rig} (simulated)" if simulated else rig
        yield line([(clean(self.recipe.name), "bold"), f" on rig {where}"])
        yield line("planning …", id="plan")
        yield line(preflight_rows(self._checks()), id="preflight")
        yield field(f"Specimen, {self._part}", entry("specimen", hint="batch or serial number"))
        yield field("Operator", entry("operator"))
        yield field("Notes", entry("notes", limit=1500))
        if simulated:
            speed = self.host.options.speed
            typed = "max" if speed is None else f"{speed:g}"
            yield field("Rig s per second", entry("speed", typed, hint="1, 60, max"))
        yield PlainCheckbox(self._ask(on=False), id="yes", value=False, compact=True)
        with Horizontal(classes="buttons"):
            yield Button("Start (Enter)", id="start", compact=True)
            yield Button("Back", id="back", compact=True)

    @property
    def _part(self) -> str:
        """Name for people of the part that is changed."""
        return clean(self.host.scene.machine.specimen)

    def _ask(self, *, on: bool) -> str:
        return f"Answer questions (install {self._part}, clean debris) by itself: {'yes' if on else 'no'}"

    def _checks(self) -> tuple[Check, ...]:
        known = self.host.scene.state.preflight if self.host.scene.state is not None else ()
        names = {check.name for check in known}
        later = tuple(Check(name, None, "proved at connecting, before motion") for name in LATER if name not in names)
        return (Check("recipe", True, "valid on this rig"), *known, *later)

    def on_mount(self) -> None:
        """Plan the recipe."""
        self.run_worker(self._plan(), exit_on_error=False)

    async def _plan(self) -> None:
        plan = await self.host.ask(ShowPlan(self.recipe.reference, self.recipe.sent))
        if self.is_attached:
            words = totals(plan, self._part) if isinstance(plan, dict) else "no plan: it could not be worked out"
            self.query_one("#plan", Static).update(words)

    def on_button_pressed(self, event: Button.Pressed) -> None:
        """Start, or go back."""
        event.stop()
        if event.button.id == "start":
            self._start()
        else:
            self.dismiss(None)

    def on_checkbox_changed(self, event: Checkbox.Changed) -> None:
        """Show the box's state in words, because not every terminal has colours."""
        event.checkbox.label = self._ask(on=event.value)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Enter in a field moves to the button."""
        event.stop()
        self.query_one("#start").focus()

    def _typed(self, name: str) -> str:
        return self.query_one(f"#{name}", Input).value.strip()

    def _start(self) -> None:
        speed: float | None = 1.0
        if self.query("#speed"):
            try:
                speed = rig_speed(self._typed("speed"))
            except ValueError:
                self.host.say("rig seconds per second: a number above 0, or max", problem=True)
                self.query_one("#speed").focus()
                return
        specimen = self._typed("specimen")
        notes = "; ".join(text for text in (f"specimen {specimen}" if specimen else "", self._typed("notes")) if text)
        order = RunRecipe(
            self.recipe.reference, self.recipe.sent, speed=speed, yes=self.query_one("#yes", Checkbox).value,
            operator=self._typed("operator"), notes=notes,
        )  # fmt: skip
        self.host.order(order, f"{self.recipe.name} has begun")
        self.host.go_to("run")
        self.dismiss(None)


def totals(plan: dict[str, JsonValue], part: str) -> str:
    """Return a plan's totals as a line; ``part``: name for people of the part that wears and is changed."""
    conditions = counted(int(number_in(plan, "conditions")), "condition")
    parts = counted(int(number_in(plan, f"{part}s")), part)
    return (
        f"{conditions}, {parts}, {duration(number_in(plan, 'rig_seconds'))} of rig time, "
        f"{number_in(plan, 'sliding_m'):.0f} m sliding, {number_in(plan, 'loss_mm'):.2f} mm wear"
    )


def number_in(record: dict[str, JsonValue], key: str) -> float:
    """Return a number of a plan or a step; 0 if it has none."""
    value = record.get(key)
    return float(value) if isinstance(value, int | float) else 0.0
