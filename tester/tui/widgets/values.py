"""Values: measured, wanted, unit, and a bar with the limits."""

from __future__ import annotations

from tester.service.state import Value
from tester.tui.bar import bar, believable, beyond
from tester.tui.scene import Scene
from tester.tui.widgets.panel import ABNORMAL, FAINT, WARNING, Panel, Parts, rows
from tester.tui.words import NOTHING, clean, fit, number

FIRST = ("friction", "load", "slip", "surface", "hub", "sideslip")
REST = ("wheel_speed", "belt_speed", "camber", "heat", "press", "force_x", "force_y", "moment", "torque")
LABEL, CELL, UNIT, FLAG = 15, 9, 5, 6


class ValuesPanel(Panel):
    """As many values as there are rows, the important ones first."""

    def picture(self, scene: Scene, width: int, height: int) -> Parts:
        """Return a row for each value."""
        found = [value for key in (*FIRST, *REST) if (value := scene.value(key)) is not None]
        return rows([value_row(value, width, linked=scene.linked) for value in found[:height]])


def value_row(value: Value, width: int, *, linked: bool = True) -> Parts:
    """Return one value in ``width`` columns. ``linked`` False: what is shown is not how it is."""
    label = fit(clean(value.label), LABEL).ljust(LABEL)
    unit = clean(value.unit, UNIT).ljust(UNIT)
    wanted = number(value.setpoint, value.decimals).rjust(CELL)
    fresh = believable(value) and linked
    measured = number(value.value, value.decimals)
    flag, style = beyond(value), ABNORMAL
    if value.quality == "none" or value.value is None:
        measured, flag, style = NOTHING, "", FAINT
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
