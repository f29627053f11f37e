"""The repeats of a condition, each with its trace."""

from __future__ import annotations

import asyncio
import sqlite3
from collections.abc import Iterable

from textual.content import Content
from textual.widget import Widget
from textual.widgets import Static

from tester.store.schema import StoreError
from tester.tui.dialogs.dialog import Dialog, line
from tester.tui.plot import Canvas, Range
from tester.tui.stored import RepeatRow, Row, Stored, repeats
from tester.tui.widgets.panel import FAINT, NOTICE, Parts, rows
from tester.tui.words import clean, number

WIDTH, HEIGHT = 60, 5


class RepeatsDialog(Dialog):
    """Traces of the accepted samples: every repeat in the same range, so that they can be held against each other."""

    TITLE = "Repeats"

    def __init__(self, stored: Stored, row: Row) -> None:
        """``row``: a condition of ``stored``."""
        super().__init__()
        self.stored, self.row = stored, row

    def content(self) -> Iterable[Widget]:
        """Return the place of the repeats."""
        yield line([(clean(" ".join(self.row.cells)), "bold")])
        yield line("reading …", id="repeats")

    def on_mount(self) -> None:
        """Have them read."""
        self.add_class("-tall")
        self.run_worker(self._read_repeats(), exit_on_error=False)

    async def _read_repeats(self) -> None:
        columns = WIDTH if self.host.options.plain else 2 * WIDTH
        try:
            found = await asyncio.to_thread(repeats, self.stored.folder, self.row.condition, columns)
        except (StoreError, OSError, sqlite3.Error) as error:
            self.host.say(f"cannot be read: {error}", problem=True)
            return
        if self.is_attached:
            parts = repeat_parts(found, plain=self.host.options.plain)
            self.query_one("#repeats", Static).update(Content.assemble(*parts))


def repeat_parts(found: Iterable[RepeatRow], *, plain: bool = False) -> Parts:
    """Return the repeats one below the other."""
    listed = list(found)
    known = [y for one in listed for ends in one.trace if ends is not None for y in ends]
    if not listed:
        return [("no repeat is committed", FAINT)]
    scale = Range(least=0.1)
    if known:
        scale.cover(min(known), max(known))
    lines: list[Parts] = []
    for one in listed:
        out = f"  not in the mean: {clean(one.exclusion)}" if one.exclusion else ""
        words = f"repeat {one.repeat}: mu {number(one.mu, 3)}  {clean(one.status)}{out}"
        lines.append([(words, NOTICE if out else "bold")])
        if one.trace:
            canvas = Canvas(WIDTH, HEIGHT, plain=plain)
            canvas.bins(one.trace, scale)
            labels = {0: f"{scale.high:.2f}", HEIGHT - 1: f"{scale.low:.2f}"}
            lines += [[(f"{labels.get(at, ''):>6} ", FAINT), drawn] for at, drawn in enumerate(canvas.lines())]
    return rows(lines)
