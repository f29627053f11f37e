"""The repeats of a condition, each with its trace, and the dialog that excludes a repeat or includes it again."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from textual.containers import VerticalScroll
from textual.content import Content
from textual.widget import Widget
from textual.widgets import Input, OptionList, Static
from textual.widgets.option_list import Option

from tester.base.lock import user
from tester.tui.dialogs.dialog import Dialog, entry, field, line
from tester.tui.formatting import clean, fit
from tester.tui.host import HostApp, call, read_in_thread
from tester.tui.plot import Canvas, PlotRange
from tester.tui.stored import RepeatRow, Row, Stored, condition, row_words
from tester.tui.widgets.panel_base import FAINT, Parts, rows

HEIGHT = 5
WIDTH = 60
"""Width of a trace if the screen's width is unknown, characters."""
MARGIN = 14
"""Width of the dialog without the trace: borders, labels, scroll bar, characters."""
LONGEST = 400
"""Greatest length of a repeat's line, characters."""


class ExcludeDialog(Dialog):
    """Asks for the reason and the person's name. ``done`` is called once they are recorded."""

    def __init__(self, stored: Stored, row: Row, repeat: RepeatRow, done: Callable[[], None]) -> None:
        """``repeat``: a repeat of the condition ``row`` of ``stored``."""
        super().__init__()
        self.stored, self.row, self.repeat, self.done = stored, row, repeat, done
        self.verb = "include" if repeat.by_hand else "exclude"
        self.title = f"{self.verb.capitalize()} {row.condition}/{repeat.repeat}"

    def content(self) -> Iterable[Widget]:
        """Return the description and the fields."""
        yield line([(clean(row_words(self.row)), "bold")])
        yield line(f"Repeat {self.repeat.repeat}: {self.repeat.figures}, {clean(self.repeat.status)}")
        if self.repeat.by_hand:
            yield line(f"Left out by {clean(self.repeat.by_hand)}. It enters the mean again, if it is valid.")
        else:
            yield line("It leaves the mean, and the tables are written again. Nothing is deleted.")
        yield field("Reason (needed)", entry("reason", hint="is recorded", limit=2000))
        yield field("Who", entry("who", user()))

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Record the decision, if there is a reason."""
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
        service = host.options.address
        connect = [] if service is None else [f"--connect={service}"]
        arguments = (f"--reason={reason}", f"--operator={who}", *connect, "--", str(self.stored.folder), target)
        done, words = await call("results", self.verb, *arguments)
        host.say(words if done else f"not done: {words}", problem=not done, lasting=True)
        if done:
            self.done()


class RepeatsDialog(Dialog):
    """Shows the traces of the accepted samples, every repeat in the same range for comparison."""

    TITLE = "Repeats"
    SUBTITLE = "Enter excludes or includes · Esc closes · F12 STOP"
    TALL = True

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
        self._read()

    def _read(self) -> None:
        self.run_worker(self._read_repeats(), group="read", exclusive=True, exit_on_error=False)

    async def _read_repeats(self) -> None:
        plain, width = self.host.options.plain, max(self.size.width - MARGIN, WIDTH // 3)
        columns = width if plain else 2 * width
        found = await read_in_thread(
            self.host, self.stored.name, lambda: condition(self.stored.folder, self.row.condition, columns)
        )
        if found is not None and self.is_attached:
            self.row, repeats = found
            self.found = repeats
            self.query_one("#condition", Static).update(Content.assemble(*self._heading()))
            listed = self.query_one("#repeat-list", OptionList)
            at = listed.highlighted or 0
            listed.set_options([Option(Content(repeat_words(one))) for one in repeats])
            listed.highlighted = min(at, len(repeats) - 1) if repeats else None
            parts = trace_parts(repeats, width, plain=plain)
            self.query_one("#repeats", Static).update(Content.assemble(*parts))

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Scroll to the trace of the highlighted repeat."""
        event.stop()
        above = sum(1 + (HEIGHT if repeat.trace else 0) for repeat in self.found[: event.option_index])
        self.query_one("#traces", VerticalScroll).scroll_to(y=above, animate=False)

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Ask why the repeat is to be excluded, or included again."""
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
    """Return a repeat as a line: its coefficient, its status, why it is excluded and by whom."""
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
