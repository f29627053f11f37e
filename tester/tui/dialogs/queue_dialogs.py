"""Dialogs of the queue: add a recipe with options, and start the queue until a time of day."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from textual.containers import Horizontal
from textual.widget import Widget
from textual.widgets import Button, Checkbox, Input

from tester.base.words import counted
from tester.queue.check import time_of_day
from tester.queue.items import MOST_COPIES, wait_typed
from tester.service.commands import QueueAdd, QueueStart
from tester.tui.dialogs.dialog import Dialog, entry, field, line
from tester.tui.dialogs.start import PlainCheckbox


class QueueDialog(Dialog):
    """Enter in a field, or on the first button, sends the order; a value that is not valid is named and focused."""

    BUTTON = ""

    def buttons(self) -> Widget:
        """Return the buttons."""
        return Horizontal(
            Button(f"{self.BUTTON} (Enter)", id="go", compact=True), Button("Back", id="back", compact=True),
            classes="buttons",
        )  # fmt: skip

    def on_button_pressed(self, event: Button.Pressed) -> None:
        """Send the order, or go back."""
        event.stop()
        if event.button.id == "go":
            self.go()
        else:
            self.dismiss(None)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Send the order."""
        event.stop()
        self.go()

    def on_checkbox_changed(self, event: Checkbox.Changed) -> None:
        """Show the box's state in words, because not every terminal has colours."""
        event.checkbox.label = self.label(on=event.value)

    def label(self, *, on: bool) -> str:
        """Return the label of the box in this state."""
        raise NotImplementedError

    def go(self) -> None:
        """Send the order and close, or name what is not valid."""
        raise NotImplementedError

    def typed(self, name: str) -> str:
        """Return the text of a field."""
        return self.query_one(f"#{name}", Input).value.strip()

    def refuse(self, name: str, text: str) -> None:
        """Name what is not valid, and focus its field."""
        self.host.say(text, problem=True)
        self.query_one(f"#{name}").focus()


class AddDialog(QueueDialog):
    """Adds a recipe several times, or with a limit for its questions."""

    TITLE = "Add to the queue"
    BUTTON = "Add"

    def __init__(self, action: QueueAdd, name: str) -> None:
        """``action``: adds the recipe ``name`` once, without a limit."""
        super().__init__()
        self.action, self.recipe = action, name

    def content(self) -> Iterable[Widget]:
        """Return the recipe, the fields and the buttons."""
        yield line([(self.recipe, "bold")])
        yield field("Copies", entry("copies", "1", limit=2))
        yield field("Answer within", entry("within", hint="2 h; empty: its questions wait without a limit", limit=20))
        yield line("Its item is stopped when a question has waited longer, guard closed.")
        yield PlainCheckbox(self.label(on=False), id="skip", value=False, compact=True)
        yield self.buttons()

    def label(self, *, on: bool) -> str:
        """Return what the queue does after an unanswered question."""
        return f"Then the queue continues if the next item asks for no person: {'yes' if on else 'no'}"

    def go(self) -> None:
        """Add it."""
        text, skip = self.typed("within"), self.query_one("#skip", Checkbox).value
        copies = int(self.typed("copies")) if self.typed("copies").isdecimal() else 0
        if not 1 <= copies <= MOST_COPIES:
            self.refuse("copies", f"copies: expected a number from 1 to {MOST_COPIES}")
            return
        if skip and not text:
            self.refuse("within", "answer within: expected a time such as 2 h, after which the queue continues")
            return
        try:
            within_s = wait_typed(text) if text else None
        except ValueError as error:
            self.refuse("within", f"answer within: {error}")
            return
        order = replace(self.action, copies=copies, answer_within_s=within_s, unanswered="skip" if skip else "stand")
        times = f" as {counted(copies, 'item')}" if copies > 1 else ""
        self.host.order(order, f"{self.recipe} is added{times}")
        self.dismiss(None)


class StartUntilDialog(QueueDialog):
    """Starts the queue with a time beyond which no item may last."""

    TITLE = "Start the queue until a time"
    BUTTON = "Start"

    def __init__(self, first: int | None) -> None:
        """``first``: number of the first item that waits, None for none."""
        super().__init__()
        self.first = first

    def content(self) -> Iterable[Widget]:
        """Return the field, the box and the buttons."""
        yield line("No item begins that may last beyond this time; the queue then stands.")
        yield field("Until", entry("until", hint="HH:MM, such as 06:30", limit=5))
        if self.first is not None:
            yield PlainCheckbox(self.label(on=False), id="agree", value=False, compact=True)
        yield self.buttons()

    def label(self, *, on: bool) -> str:
        """Return whether the first item runs as the rig is now."""
        return f"Item {self.first} runs although something changed since it was added: {'yes' if on else 'no'}"

    def go(self) -> None:
        """Start it."""
        try:
            until = time_of_day(self.typed("until")).strftime("%H:%M")
        except ValueError as error:
            self.refuse("until", str(error))
            return
        agrees = self.first is not None and self.query_one("#agree", Checkbox).value
        agree = (self.first,) if self.first is not None and agrees else ()
        self.host.order(QueueStart(agree, until), f"the queue is started until {until}")
        self.dismiss(None)
