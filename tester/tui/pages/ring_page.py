"""Ring: errors of the line through a slip ring, by angle of the ring, by speed, and from run to run."""

from __future__ import annotations

from typing import ClassVar

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.widgets import DataTable

from tester.analysis.ring_errors import RingRun
from tester.base.words import NONE, decimal
from tester.tui.formatting import clean
from tester.tui.host import Keys, View, read_in_thread
from tester.tui.pages.results_page import TextTable
from tester.tui.rings import KeptRings, RingRow
from tester.tui.widgets.ring_panel import AgePanel, AnglePanel, SpeedPanel

HEADER = ("Run", "Turns", "Requests", "Errors", "of 1000", "Angle")
HELP = """\
Requests over the ring without a good reply, from the stored runs: a run under way counts once it has ended.

Above: the runs of one rig, oldest first, with the turns of the ring until the end of each. Below, of the run under the
cursor: errors in twelve sectors of the angle, counted from its position when mounted; errors by speed. The trend is of
all runs above. The table shows an angle if the errors gather there beyond chance.

n  a new ring, or new brushes, before the run under the cursor: turns and trend count from there. Again: all runs.
g  look for runs again.
"""


class RingPage(View):
    """The ring of this machine."""

    KEYS: ClassVar[Keys] = (("↑↓", "Run"), ("n", "New ring"), ("g", "Look again"), ("space", "Hold"), ("a", "Ack"),
                            ("F1", "Help"), ("q", "Detach"))  # fmt: skip
    HELP: ClassVar[str | None] = HELP
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("n", "anew", "New ring", show=False),
        Binding("g", "reload", "Look again", show=False),
    ]

    def __init__(self, *, id: str) -> None:  # noqa: A002 - as in Textual
        """Read nothing yet."""
        super().__init__(id=id)
        self.kept = KeptRings()
        self.rows: list[RingRow] = []

    def compose(self) -> ComposeResult:
        """Lay out table and panels."""
        table = TextTable(id="ring-runs", cursor_type="row")
        table.fill(HEADER)
        yield table
        with Horizontal():
            yield AnglePanel(id="ring-angle", classes="box")
            with Vertical():
                yield SpeedPanel(id="ring-speed", classes="box", title="Errors by speed")
                yield AgePanel(id="ring-age", classes="box", title="Errors by age")

    @property
    def table(self) -> TextTable:
        """Return the table of the runs."""
        return self.query_one("#ring-runs", TextTable)

    def enter(self) -> None:
        """Read the runs as they are stored now."""
        super().enter()
        self.action_reload()

    def take_focus(self) -> None:
        """Focus the runs."""
        self.table.focus()

    def action_reload(self) -> None:
        """Read the stored runs again."""
        self.table.border_title = "Runs: looking …"
        self.run_worker(self._read, group="rings", exclusive=True, exit_on_error=False)

    async def _read(self) -> None:
        kept = await read_in_thread(self.host, "the runs", lambda: self.kept.read(self.host.options.runs))
        if kept is None:
            self.table.border_title = "Runs"
        elif self.is_attached:
            self._fill()

    def _fill(self) -> None:
        """Show the runs, with the cursor on the newest, and the panels of the chosen run."""
        before = self.rows[self.table.cursor_row].run.name if self.rows else ""
        self.rows = self.kept.rows()
        self.table.fill(HEADER, [cells(row) for row in self.rows])
        names = [row.run.name for row in self.rows]
        self.table.move_cursor(row=names.index(before) if before in names else max(len(names) - 1, 0))
        about = f", since {clean(self.kept.since)}" if self.kept.since else ""
        self.table.border_title = Text(f"Runs: {len(self.rows)}{about}")
        self.table.border_subtitle = Text(clean(self.kept.counted, 70))
        self._choose()

    def on_data_table_row_highlighted(self, event: DataTable.RowHighlighted) -> None:
        """Show the run under the cursor."""
        event.stop()
        self._choose()

    @property
    def chosen(self) -> RingRun | None:
        """Return the run under the cursor."""
        at = self.table.cursor_row
        return self.rows[at].run if at < len(self.rows) else None

    def _choose(self) -> None:
        run = self.chosen
        angle = self.query_one(AnglePanel)
        angle.run = self.query_one(SpeedPanel).run = run
        angle.entitle(f"Errors by angle of {clean(self.kept.turns)}" if self.kept.turns else "Errors by angle")
        self.query_one(AgePanel).found = self.rows
        for panel in (angle, self.query_one(SpeedPanel), self.query_one(AgePanel)):
            panel.show(self.host.scene)

    def action_anew(self) -> None:
        """Count the ring as new from the run under the cursor, or again from the first run."""
        run = self.chosen
        if run is not None:
            self.kept.since = "" if self.kept.since else run.name
            self._fill()


def cells(row: RingRow) -> tuple[str, ...]:
    """Return a run's cells for HEADER."""
    run = row.run
    places = [f"{sector.centre_deg:.0f}° ±{sector.half_deg:.0f}" for sector in row.sectors if sector.found]
    per_thousand = decimal(run.per_thousand, 2) if run.requests else NONE
    texts = (run.name, f"{row.age:.0f}", str(run.requests), str(run.errors), per_thousand, ", ".join(places))
    return tuple(clean(text, 60) for text in texts)
