"""Values: measured value, setpoint, unit, and a bar with the limits."""

from __future__ import annotations

from tester.base.words import NONE, decimal
from tester.service.state_view import Value
from tester.tui.formatting import clean, fit
from tester.tui.screen_scene import ScreenScene
from tester.tui.widgets.panel_base import ABNORMAL, FAINT, WARNING, Panel, Parts, rows

RAIL, LOW, HIGH, SETPOINT, BAND, HERE = "─", "├", "┤", "┼", "═", "●"
OFF_LEFT, OFF_RIGHT = "◀", "▶"
"""Signs for a value to the left or to the right of the bar."""


def bar(value: Value, width: int) -> str:
    """Return the bar, ``width`` characters wide; without a value it shows only the rail and the limits."""
    if width < 3:
        return ""
    span = value.scale_high - value.scale_low
    if span <= 0.0:
        return RAIL * width

    def cell(x: float) -> int:
        return round((x - value.scale_low) / span * (width - 1))

    line = [RAIL] * width

    def mark(x: float | None, sign: str) -> None:
        if x is not None and 0 <= (at := cell(x)) < width:
            line[at] = sign

    if value.band_low is not None and value.band_high is not None:
        for at in range(max(cell(value.band_low), 0), min(cell(value.band_high), width - 1) + 1):
            line[at] = BAND
    mark(value.setpoint, SETPOINT)
    mark(value.low, LOW)
    mark(value.high, HIGH)
    if value.value is not None:
        at = cell(value.value)
        if at < 0:
            line[0] = OFF_LEFT
        elif at >= width:
            line[-1] = OFF_RIGHT
        else:
            line[at] = HERE
    return "".join(line)


def beyond(value: Value) -> str:
    """Return LOW or HIGH if the value is at or beyond a limit, else an empty text."""
    if value.value is None:
        return ""
    if value.high is not None and value.value >= value.high:
        return "HIGH"
    if value.low is not None and value.value <= value.low:
        return "LOW"
    return ""


LABEL, CELL, UNIT, FLAG = 15, 9, 5, 6


class ValuesPanel(Panel):
    """As many values as there are rows, the most important first."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return a row for each value."""
        values = scene.state.values if scene.state is not None else ()
        return rows([value_row(value, width, linked=scene.linked) for value in values[:height]])


def value_row(value: Value, width: int, *, linked: bool = True) -> Parts:
    """Return one value in ``width`` columns. ``linked`` False: the value is out of date."""
    label = fit(clean(value.label), LABEL).ljust(LABEL)
    unit = clean(value.unit, UNIT).ljust(UNIT)
    wanted = decimal(value.setpoint, value.decimals).rjust(CELL)
    fresh = value.quality == "good" and linked
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
