"""Results: the stored runs, a run's conditions, a plot, a condition's repeats, export."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from typing import ClassVar

from rich.cells import cell_len
from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widget import Widget
from textual.widgets import DataTable

from tester.base.axes import Axis, condition_words
from tester.base.words import duration
from tester.service.commands import ListRuns
from tester.tui.dialogs.dialog import Dialog
from tester.tui.dialogs.export import ExportDialog
from tester.tui.dialogs.repeats_dialog import RepeatsDialog
from tester.tui.formatting import clean, fit
from tester.tui.host import Keys, Listed, View, read_in_thread, runs_in
from tester.tui.plot import scatter
from tester.tui.screen_scene import ScreenScene
from tester.tui.stored import Row, Stored, points, read, series
from tester.tui.widgets.panel_base import FAINT, Panel, Parts, rows


class PlotDialog(Dialog):
    """A plot of mu against one setpoint, which a key changes."""

    TITLE = "Plot"
    SUBTITLE = "p next axis · Esc closes · F12 STOP"
    TALL = True
    BINDINGS: ClassVar[list[BindingType]] = [Binding("p", "next", "Next", show=False)]

    def __init__(self, stored: Stored, row: Row | None, axis: int) -> None:
        """``row``: the condition whose series is highlighted; ``axis``: the first axis."""
        super().__init__()
        self.stored, self.row, self.axis = stored, row, axis

    def content(self) -> Iterable[Widget]:
        """Return the plot."""
        yield PlotPanel(id="big-plot")

    def on_mount(self) -> None:
        """Draw the plot."""
        self._plot()

    def _plot(self) -> None:
        panel = self.query_one(PlotPanel)
        panel.plot(self.stored, self.row, self.axis)
        self.query_one("#box").border_title = panel.title
        panel.show(self.host.scene)

    def action_next(self) -> None:
        """Plot against the next axis."""
        self.axis += 1
        self._plot()


class PlotPanel(Panel):
    """A stored run's coefficients against one of its axes."""

    stored: Stored | None = None
    row: Row | None = None
    axis = 0

    def plot(self, stored: Stored | None, row: Row | None, axis: int) -> None:
        """Plot this run; ``row``: the condition whose series is highlighted."""
        self.stored, self.row, self.axis = stored, row, axis % len(stored.plotted) if stored is not None else 0
        self.redraw()

    @property
    def title(self) -> str:
        """Return the axes of the plot, and the highlighted series."""
        along = self.along
        if along is None:
            return "mu"
        what = f"mu ± U against {along.name.replace('_', ' ')} ({along.unit})"
        if self.stored is None or self.row is None or len(series(self.stored, self.row, along)) < 2:
            return what
        setpoint = self.row.held
        others = [one for one in setpoint.axes if one.name != along.name and not one.at_default(setpoint)]
        return f"{what}: ● {clean(condition_words(setpoint, others), 80)}   · others"

    @property
    def along(self) -> Axis | None:
        """Return the axis to plot against; None while no run is chosen."""
        return self.stored.plotted[self.axis] if self.stored is not None else None

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return the plot."""
        along = self.along
        if self.stored is None or along is None:
            return [("no run chosen", FAINT)]
        lines = scatter(points(self.stored, along, self.row), width, height)
        shown: list[Parts] = [[fit(line, width)] for line in lines]
        return rows(shown) if shown else [("no values to plot", FAINT)]


RUN_HEADER = ("Run", "Recipe", "Status", "Values", "Rig time", "Started")
EMPTY = ("compound", "mu")
"""Columns of the conditions while no run is chosen."""
HELP = """\
Above the stored runs, below the conditions of the chosen one: mu at the temperature asked for, both expanded
uncertainties U (95 %), s (between repeats), valid (of those asked for), the means of further sensors, flags. Behind mu,
and as a point's sign, ! is a number that is not to be trusted, ? one with a doubt among its flags. The plot is mu
against one setpoint, with U of what was mounted as a bar; a point's sign is its compound, + is several. What differs
from the chosen condition in more than that setpoint is a faint dot.

Enter   on a run: read it. On a condition: its repeats, with traces, and why one is not in the mean; Enter there
        leaves a repeat out, or takes it in again, with a reason that is recorded. Nothing is ever deleted.
p       plot against the next axis; axes with a single value are shown above the table instead.
e       export a table to a file.
g       look for runs again.
"""


_WIDEST = 300
"""Greatest width of a cell: all flags at once, 267 characters, are not cut."""


class TextTable(DataTable[Text]):
    """A table of plain text, never interpreted as markup."""

    def fill(self, header: Sequence[str], rows: Sequence[Sequence[str]] = ()) -> None:
        """Show these cells, each column as wide as its widest cell.

        The widths are explicit, because a table measures them only when idle. Cells painted before that, for example
        under a dialog, would stay on the screen in columns that are too narrow.
        """
        self.clear(columns=True)
        for number, title in enumerate(header):
            self.add_column(Text(title), width=max(cell_len(row[number]) for row in (header, *rows)))
        for row in rows:
            self.add_row(*(Text(cell) for cell in row))
        self.call_later(self.refresh)  # the table updates its scroll range at its next message, so send one


class ResultsView(View):
    """The stored runs."""

    KEYS: ClassVar[Keys] = (("Enter", "Open"), ("p", "Plot"), ("e", "Export"), ("g", "Look again"), ("space", "Hold"),
                            ("F1", "Help"), ("q", "Detach"))  # fmt: skip
    HELP: ClassVar[str | None] = HELP
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("p", "plot", "Plot", show=False),
        Binding("e", "export", "Export", show=False),
        Binding("g", "reload", "Look again", show=False),
    ]

    def __init__(self, *, id: str) -> None:  # noqa: A002 - as in Textual
        """Read nothing yet."""
        super().__init__(id=id)
        self.names: list[str] = []
        self.stored: Stored | None = None

    def compose(self) -> ComposeResult:
        """Lay out the tables."""
        runs = TextTable(id="runs", cursor_type="row", zebra_stripes=False)
        runs.fill(RUN_HEADER)
        conditions = TextTable(id="conditions", cursor_type="row")
        conditions.fill(EMPTY)
        runs.border_title, conditions.border_title = "Runs", "Conditions"
        yield runs
        yield conditions
        yield PlotPanel(id="plot", classes="box")

    @property
    def runs_table(self) -> TextTable:
        """Return the table of the runs."""
        return self.query_one("#runs", TextTable)

    @property
    def conditions_table(self) -> TextTable:
        """Return the table of the conditions."""
        return self.query_one("#conditions", TextTable)

    def enter(self) -> None:
        """Read the runs, and focus them."""
        super().enter()
        self.action_reload()

    def take_focus(self) -> None:
        """Focus the runs."""
        self.runs_table.focus()

    def action_reload(self) -> None:
        """Search for runs again."""
        if self.host.options.view_only or self.host.link is None:
            return
        self.runs_table.border_title = "Runs: looking …"
        self.run_worker(self._list, group="runs", exclusive=True, exit_on_error=False)

    async def _list(self) -> None:
        runs = runs_in(await self.host.ask(ListRuns()))
        if runs is not None and self.is_attached:
            self.fill(runs[::-1])

    def fill(self, runs: list[Listed]) -> None:
        """Show these runs (`tester runs --json`), newest first."""
        table = self.runs_table
        before = table.cursor_row
        self.names = [str(run.get("run", "")) for run in runs]
        table.fill(RUN_HEADER, [run_cells(run) for run in runs])
        if before < len(runs):
            table.move_cursor(row=before)
        table.border_title = f"Runs: {len(runs)}"

    def on_data_table_row_selected(self, event: DataTable.RowSelected) -> None:
        """Read the chosen run, or show the chosen condition's repeats."""
        event.stop()
        if self.runs_table.has_focus:
            if event.cursor_row < len(self.names):
                self.open_run(self.names[event.cursor_row])
        elif self.stored is not None and (row := self.chosen) is not None:
            self.host.push_screen(RepeatsDialog(self.stored, row, self._read_again))

    def on_data_table_row_highlighted(self, event: DataTable.RowHighlighted) -> None:
        """Highlight the series of the condition under the cursor."""
        event.stop()
        self._plot(self.query_one(PlotPanel).axis)

    @property
    def chosen(self) -> Row | None:
        """Return the condition under the cursor."""
        at = self.conditions_table.cursor_row
        return self.stored.rows[at] if self.stored is not None and at < len(self.stored.rows) else None

    def _read_again(self) -> None:
        """Read the run again, after a repeat was excluded or included."""
        if self.stored is not None:
            self.open_run(str(self.stored.folder))

    def open_run(self, name: str) -> None:
        """Read a run, by its name or folder, and show its conditions."""
        self.run_worker(partial(self._open, name), group="open", exclusive=True, exit_on_error=False)

    async def _open(self, name: str) -> None:
        self.conditions_table.border_title = "reading …"
        stored = await read_in_thread(self.host, name, lambda: read(name, self.host.options.runs))
        if stored is None:
            self.conditions_table.border_title = "Conditions"
        elif self.is_attached:
            self.open(stored)
            if self.host.screen is self.screen:
                self.conditions_table.focus()

    def open(self, stored: Stored) -> None:
        """Show a run's conditions."""
        table = self.conditions_table
        again = self.stored is not None and self.stored.folder == stored.folder
        at, axis = (table.cursor_row, self.query_one(PlotPanel).axis) if again else (0, 0)
        self.stored = stored
        table.fill(stored.header, [[fit(clean(cell), _WIDEST) for cell in row.cells] for row in stored.rows])
        table.border_title = Text(f"{clean(stored.name)}: {clean(stored.recipe)}, {clean(stored.status)}")
        table.border_subtitle = Text(f"all: {clean(stored.common)}" if stored.common else "")
        table.move_cursor(row=at)
        head = stored.record_head
        self.runs_table.border_subtitle = Text(f"record head {clean(head)}" if head else "")
        self._plot(axis)

    def _plot(self, axis: int) -> None:
        panel = self.query_one(PlotPanel)
        panel.plot(self.stored, self.chosen, axis)
        panel.entitle(panel.title)

    def action_plot(self) -> None:
        """Plot against the next axis, on the whole screen if there is no room next to the tables."""
        panel = self.query_one(PlotPanel)
        if panel.display:
            self._plot(panel.axis + 1)
        elif self.stored is not None:
            self.host.push_screen(PlotDialog(self.stored, self.chosen, panel.axis))
        else:
            self.host.say("choose a run first")

    def action_export(self) -> None:
        """Ask what to export, and to which file."""
        at = self.runs_table.cursor_row
        name = self.stored.name if self.stored is not None else self.names[at] if at < len(self.names) else ""
        if name and not self.host.options.view_only:
            self.host.push_screen(ExportDialog(name, self.host.options.runs))
        else:
            self.host.say("choose a run first")


def run_cells(run: Listed) -> tuple[str, ...]:
    """Return a run's cells for RUN_HEADER."""
    seconds = run.get("rig_seconds")
    time = duration(seconds if isinstance(seconds, int | float) else None)
    values = f"{run.get('values', '?')}/{run.get('conditions', '?')}"
    texts = (run.get("run", ""), run.get("recipe", ""), run.get("status", ""), values, time, run.get("started_utc", ""))
    return tuple(clean(str(text), 60) for text in texts)
