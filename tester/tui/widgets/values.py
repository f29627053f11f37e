"""Values: measured, wanted, unit, and a bar with the limits."""

from __future__ import annotations

from tester.base.words import NONE, decimal
from tester.service.state import Value
from tester.tui.bar import bar, believable, beyond
from tester.tui.formatting import clean, fit
from tester.tui.scene import ScreenScene
from tester.tui.widgets.panel import ABNORMAL, FAINT, WARNING, Panel, Parts, rows

LABEL, CELL, UNIT, FLAG = 15, 9, 5, 6


class ValuesPanel(Panel):
    """As many values as there are rows, in their own order: the important ones first."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return a row for each value."""
        values = scene.state.values if scene.state is not None else ()
        return rows([value_row(value, width, linked=scene.linked) for value in values[:height]])


def value_row(value: Value, width: int, *, linked: bool = True) -> Parts:
    """Return one value in ``width`` columns. ``linked`` False: what is shown is not how it is."""
    label = fit(clean(value.label), LABEL).ljust(LABEL)
    unit = clean(value.unit, UNIT).ljust(UNIT)
    wanted = decimal(value.setpoint, value.decimals).rjust(CELL)
    fresh = believable(value) and linked
    measured = decimal(value.value, value.decimals)
    flag, style = beyond(value), ABNORMAL
    if value.quality == "none" or value.value is None:
        measured, flag, style = NONE, "", FAINT
    elif not fresh:
        measured, style = f"{measured}?", FAINT
        flag = "BAD" if value.quality == "bad" else "STALE"
    room = width - LABEL - 2 * CELL - UNIT - FLAG - 3
    rail = bar(value, room) if room >= 8 else ""
    normal = fresh and not flag
    cell: Parts = [measured.rjust(CELL) if normal else (measured.rjust(CELL), style)]
    line: Parts = [label, *cell, wanted, f" {unit} ", rail if normal else (rail, FAINT if not fresh else "bold")]
    if flag and width > LABEL + CELL + FLAG:
        line += [" ", (flag, WARNING if flag in ("BAD", "STALE") else ABNORMAL)]
    return line
