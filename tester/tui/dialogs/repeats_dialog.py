"""The repeats of a condition, each with its trace; here one is excluded from the mean, or included again."""

from __future__ import annotations

import asyncio
import sqlite3
from collections.abc import Callable, Iterable

from textual.containers import VerticalScroll
from textual.content import Content
from textual.widget import Widget
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from tester.base.trouble import in_words
from tester.store.record_schema import StoreError
from tester.tui.dialogs.dialog import Dialog, line
from tester.tui.dialogs.exclude_dialog import ExcludeDialog
from tester.tui.formatting import clean, fit
from tester.tui.plot import Canvas, PlotRange
from tester.tui.stored import RepeatRow, Row, Stored, condition, row_words
from tester.tui.widgets.panel_base import FAINT, Parts, rows

HEIGHT = 5
WIDTH = 60
"""Width of a trace if the screen's width is unknown, characters."""
MARGIN = 14
"""Width of the dialog beside a trace: borders, labels, scroll bar, characters."""
LONGEST = 400
"""Longest line of a repeat, characters."""


class RepeatsDialog(Dialog):
    """Traces of the accepted samples: every repeat in the same range, for comparison."""

    TITLE = "Repeats"

    def __init__(self, stored: Stored, row: Row, changed: Callable[[], None]) -> None:
        """``row``: a condition of ``stored``; ``changed`` is called when a repeat is excluded or included."""
        super().__init__()
        self.stored, self.row, self.changed = stored, row, changed
        self.found: tuple[RepeatRow, ...] = ()

    def content(self) -> Iterable[Widget]:
        """Return the widgets for the repeats."""
        yield line(self._heading(), id="condition")
        yield OptionList(id="repeat-list", markup=False)
        with VerticalScroll(id="traces", can_focus=False):
            yield line("reading …", id="repeats")

    def _heading(self) -> Parts:
        heading: Parts = [(clean(f"{row_words(self.row)}  {self.row.figures}"), "bold")]
        return [*heading, *(f"\n{clean(line)}" for line in self.row.flags)]

    def on_mount(self) -> None:
        """Read the repeats."""
        self.add_class("-tall")
        self.query_one("#box").border_subtitle = "Enter excludes or includes · Esc closes · F12 STOP"
        self.query_one("#repeat-list").focus()
        self._read()

    def _read(self) -> None:
        self.run_worker(self._read_repeats(), group="read", exclusive=True, exit_on_error=False)

    async def _read_repeats(self) -> None:
        plain, width = self.host.options.plain, max(self.size.width - MARGIN, WIDTH // 3)
        columns = width if plain else 2 * width
        try:
            self.row, repeats = await asyncio.to_thread(condition, self.stored.folder, self.row.condition, columns)
        except (StoreError, OSError, sqlite3.Error) as error:
            self.host.say(f"cannot be read: {in_words(error)}", problem=True)
            return
        if self.is_attached:
            self.found = repeats
            self.query_one("#condition", Static).update(Content.assemble(*self._heading()))
            listed = self.query_one("#repeat-list", OptionList)
            at = listed.highlighted or 0
            listed.set_options([Option(Content(repeat_words(one))) for one in repeats])
            listed.highlighted = min(at, len(repeats) - 1) if repeats else None
            parts = trace_parts(repeats, width, plain=plain)
            self.query_one("#repeats", Static).update(Content.assemble(*parts))

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Scroll to the repeat's trace."""
        event.stop()
        above = sum(1 + (HEIGHT if repeat.trace else 0) for repeat in self.found[: event.option_index])
        self.query_one("#traces", VerticalScroll).scroll_to(y=above, animate=False)

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Ask why to exclude it, or to include it again."""
        event.stop()
        if self.host.options.view_only:
            self.host.say("view only: nothing is changed from here")
            return
        self.host.push_screen(ExcludeDialog(self.stored, self.row, self.found[event.option_index], self._has_changed))

    def _has_changed(self) -> None:
        self.changed()
        if self.is_attached:
            self._read()


def repeat_words(one: RepeatRow) -> str:
    """Return a repeat in a line: its coefficient, its status, why it is excluded and by whom."""
    out = f"  ✘ not in the mean: {clean(one.exclusion)}" if one.exclusion else ""
    who = f" ({clean(one.by_hand)})" if one.by_hand else ""
    return fit(f"repeat {one.repeat}: {one.figures}  {clean(one.status)}{out}{who}", LONGEST)


def trace_parts(found: Iterable[RepeatRow], width: int = WIDTH, *, plain: bool = False) -> Parts:
    """Return the traces one below the other, each under its number."""
    listed = list(found)
    known = [y for repeat in listed for ends in repeat.trace if ends is not None for y in ends]
    if not listed:
        return [("no repeat is committed", FAINT)]
    scale = PlotRange(least=0.1)
    if known:
        scale.cover(min(known), max(known))
    lines: list[Parts] = []
    for repeat in listed:
        lines.append([(f"repeat {repeat.repeat}: {repeat.figures}", FAINT if repeat.exclusion else "bold")])
        if repeat.trace:
            canvas = Canvas(width, HEIGHT, plain=plain)
            canvas.bins(repeat.trace, scale)
            labels = {0: f"{scale.high:.2f}", HEIGHT - 1: f"{scale.low:.2f}"}
            lines += [[(f"{labels.get(at, ''):>6} ", FAINT), drawn] for at, drawn in enumerate(canvas.lines())]
    return rows(lines)
