"""Exclude a repeat from its condition's mean, or include it again: only with a reason, which is recorded."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from textual.widget import Widget
from textual.widgets import Input

from tester.base.lock import user
from tester.tui.dialogs.dialog import Dialog, entry, field, line
from tester.tui.formatting import clean
from tester.tui.host import HostApp
from tester.tui.starting import call
from tester.tui.stored import RepeatRow, Row, Stored, row_words


class ExcludeDialog(Dialog):
    """Asks for the reason and the person. ``done`` is called once they are recorded."""

    TITLE = "Leave a repeat out, or take it in again"

    def __init__(self, stored: Stored, row: Row, repeat: RepeatRow, done: Callable[[], None]) -> None:
        """``repeat``: of the condition ``row`` of ``stored``."""
        super().__init__()
        self.stored, self.row, self.repeat, self.done = stored, row, repeat, done
        self.verb = "include" if repeat.by_hand else "exclude"

    def on_mount(self) -> None:
        """Name the box and focus the reason."""
        self.query_one("#box").border_title = f"{self.verb.capitalize()} {self.row.condition}/{self.repeat.repeat}"
        self.query_one("#reason").focus()

    def content(self) -> Iterable[Widget]:
        """Return the description and the fields."""
        yield line([(clean(row_words(self.row)), "bold")])
        yield line(f"Repeat {self.repeat.repeat}: {self.repeat.figures}, {clean(self.repeat.status)}")
        if self.repeat.by_hand:
            yield line(f"Left out by {clean(self.repeat.by_hand)}. It enters the mean again, if it is valid.")
        else:
            yield line("It leaves the mean and the tables are made anew. Nothing is deleted: it can be included again.")
        yield field("Reason (needed)", entry("reason", hint="goes on record", limit=2000))
        yield field("Who", entry("who", user()))

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Record it, if there is a reason."""
        event.stop()
        reason, who = (self.query_one(f"#{name}", Input).value.strip() for name in ("reason", "who"))
        if not reason:
            self.host.say("nothing done: a reason is needed, or Esc", problem=True)
            self.query_one("#reason").focus()
            return
        host = self.host
        target = f"{self.row.condition}/{self.repeat.repeat}"
        host.run_worker(self._record(host, target, reason, who), exit_on_error=False)
        self.dismiss(None)

    async def _record(self, host: HostApp, target: str, reason: str, who: str) -> None:
        arguments = (f"--reason={reason}", f"--operator={who}", "--", str(self.stored.folder), target)
        done, words = await call("results", self.verb, *arguments)
        host.say(words if done else f"not done: {words}", problem=not done, lasting=True)
        if done:
            self.done()
