"""Queue: the items in order, what the queue waits for, and keys that change it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import DataTable

from tester.base.words import rough_duration
from tester.queue.view import ItemView, QueueView
from tester.service.commands import QueueAdd, QueueDrop, QueueMove, QueueSkip, QueueStand, QueueStart
from tester.tui.dialogs.queue_dialogs import AddDialog, StartUntilDialog
from tester.tui.formatting import clean, clock_text
from tester.tui.host import Keys, View
from tester.tui.pages.recipes import RecipesView
from tester.tui.pages.results_page import TextTable
from tester.tui.screen_scene import ScreenScene

HEADER = ("Item", "State", "Recipe", "Takes", "Ends", "Earliest", "Latest", "Asks", "Reason")
HELP = """\
Recipes that run one after another, each frozen when it is added. The line above the table states what the queue does or
waits for. Times are those of 95 % of queues. After a trip, a stop or a restart a person starts the queue again.

n           add the recipe under the cursor of screen Recipes: at real time; a simulated rig answers its own questions.
o           add it with options: several times; a time after which an item with an unanswered question is stopped.
[  ]        move the item under the cursor up, down.
k           skip: pass over it; if it runs, stop it, and the next one begins.
Delete      drop it.
s           start the queue.   w  stand: begin no further item.
u           start it until a time of day: no item begins that may last beyond it.
y           start it, and let the first item run although something changed since it was added.
`tester queue check` states until when the queue runs alone.
"""


class QueuePage(View):
    """The queue of the service's rig."""

    KEYS: ClassVar[Keys] = (("n o", "Add"), ("[ ]", "Move"), ("k", "Skip"), ("s u", "Start"), ("w", "Stand"),
                            ("space", "Hold"), ("F1", "Help"), ("q", "Detach"))  # fmt: skip
    HELP: ClassVar[str | None] = HELP
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("n", "add", "Add", show=False),
        Binding("o", "options", "Add with options", show=False),
        Binding("left_square_bracket", "shift(-1)", "Up", show=False),
        Binding("right_square_bracket", "shift(1)", "Down", show=False),
        Binding("k", "skip", "Skip", show=False),
        Binding("delete", "drop", "Drop", show=False),
        Binding("s", "start", "Start", show=False),
        Binding("u", "until", "Start until", show=False),
        Binding("w", "stand", "Stand", show=False),
        Binding("y", "agree", "Agree and start", show=False),
    ]

    def __init__(self, *, id: str) -> None:  # noqa: A002 - as in Textual
        """Show nothing before the service has sent its queue."""
        super().__init__(id=id)
        self.queue: QueueView | None = None

    def compose(self) -> ComposeResult:
        """Lay out the table."""
        table = TextTable(id="queue-items", cursor_type="row")
        table.fill(HEADER)
        yield table

    @property
    def table(self) -> DataTable[Text]:
        """Return the table of the items."""
        return self.query_one("#queue-items", TextTable)

    def take_focus(self) -> None:
        """Focus the items."""
        self.table.focus()

    def show(self, scene: ScreenScene) -> None:
        """Show the queue if it has changed."""
        if scene.queue is self.queue:
            return
        chosen = self.chosen
        self.queue = scene.queue
        table = self.query_one("#queue-items", TextTable)
        items = self.queue.items if self.queue is not None else ()
        table.fill(HEADER, [cells(item) for item in items])
        numbers = [item.id for item in items]
        first = next((at for at, item in enumerate(items) if not item.state.over), 0)
        table.move_cursor(row=numbers.index(chosen.id) if chosen is not None and chosen.id in numbers else first)
        table.border_title = Text(clean(f"Queue: {self.queue.state}" if self.queue is not None else "Queue", 200))
        table.border_subtitle = Text(", ".join(_limits(self.queue)) if self.queue is not None else "")

    @property
    def chosen(self) -> ItemView | None:
        """Return the item under the cursor."""
        items = self.queue.items if self.queue is not None else ()
        at = self.table.cursor_row
        return items[at] if at < len(items) else None

    def action_add(self) -> None:
        """Add the recipe that is chosen on the screen of the recipes."""
        if (found := self._chosen_recipe()) is not None:
            action, name = found
            self.host.order(action, f"{name} is added")

    def action_options(self) -> None:
        """Ask how to add that recipe."""
        if (found := self._chosen_recipe()) is not None:
            self.host.push_screen(AddDialog(*found))

    def _chosen_recipe(self) -> tuple[QueueAdd, str] | None:
        """Return the command that adds the chosen recipe, and its name; if there is none, say so and return None."""
        recipe, state = self.host.query_one(RecipesView).chosen, self.host.scene.state
        if recipe is None or state is None:
            self.host.say("choose a recipe on F2 first")
            return None
        return QueueAdd(str(recipe.path), yes=state.simulated), clean(recipe.name, 40)

    def action_shift(self, places: int) -> None:
        """Move the item under the cursor up (-1) or down (1)."""
        item, queue = self.chosen, self.queue
        if item is None or queue is None:
            return
        numbers = [one.id for one in queue.listed]
        if item.id not in numbers:
            self.host.say(f"item {item.id} is over")
            return
        at = numbers.index(item.id)
        rest = [number for number in numbers if number != item.id]
        to = min(max(at + places, 0), len(rest))
        before = rest[to] if to < len(rest) else 0
        self.host.order(QueueMove(item.id, queue.revision, before))

    def action_skip(self) -> None:
        """Pass over the item under the cursor."""
        if (item := self.chosen) is not None and self.queue is not None:
            self.host.order(QueueSkip(item.id, self.queue.revision), f"item {item.id} is skipped")

    def action_drop(self) -> None:
        """Remove the item under the cursor."""
        if (item := self.chosen) is not None and self.queue is not None:
            self.host.order(QueueDrop(item.id, self.queue.revision), f"item {item.id} is dropped")

    def action_start(self) -> None:
        """Start the queue."""
        self.host.order(QueueStart(), "the queue is started")

    def action_until(self) -> None:
        """Ask until when to start the queue."""
        self.host.push_screen(StartUntilDialog(self._first_waiting))

    def action_agree(self) -> None:
        """Start the queue, and let its first item run although something has changed."""
        if (waiting := self._first_waiting) is not None:
            self.host.order(QueueStart(agree=(waiting,)), f"the queue is started, item {waiting} as the rig is now")

    @property
    def _first_waiting(self) -> int | None:
        """Return the number of the first item that waits."""
        listed = self.queue.listed if self.queue is not None else ()
        return next((item.id for item in listed if item.state == "waiting"), None)

    def action_stand(self) -> None:
        """Begin no further item."""
        self.host.order(QueueStand(), "no further item begins")


def _limits(queue: QueueView) -> Iterator[str]:
    """Yield when the queue ends, and the time beyond which no item may last."""
    if queue.end_utc:
        yield f"ends {clock_text(queue.end_utc)}"
    if queue.until_utc:
        yield f"no item begins that may last beyond {clock_text(queue.until_utc)}"


def cells(item: ItemView) -> tuple[str, ...]:
    """Return an item's cells for HEADER."""
    times = (item.end_utc, item.end_low_utc, item.end_high_utc) if not item.state.over else (item.ended_utc, "", "")
    texts = (
        str(item.id),
        item.end.value if item.end is not None else item.state.value,
        item.name,
        rough_duration(item.seconds),
        *(clock_text(time) if time else "" for time in times),
        str(len(item.asks)) if item.asks else "",
        item.reason or (item.unanswered.words() if item.asks and item.unanswered is not None else ""),
    )
    return tuple(clean(text, 60) for text in texts)
