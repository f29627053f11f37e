"""A value on a bar with its limits: ``──├──═●═──┤──``. How near a limit is, is seen before the alarm."""

from __future__ import annotations

from tester.service.state import Value

RAIL, LOW, HIGH, SETPOINT, BAND, HERE = "─", "├", "┤", "┼", "═", "●"
OFF_LEFT, OFF_RIGHT = "◀", "▶"
"""The value lies outside the bar."""


def bar(value: Value, width: int) -> str:
    """Return the bar in so many characters; only the rail and the limits where there is no value."""
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
    """Return LOW or HIGH where the value is at or beyond a limit, else an empty text."""
    if value.value is None:
        return ""
    if value.high is not None and value.value >= value.high:
        return "HIGH"
    if value.low is not None and value.value <= value.low:
        return "LOW"
    return ""


def believable(value: Value) -> bool:
    """Return whether the value can be taken for one: not stale, and not reported invalid."""
    return value.quality == "good"
