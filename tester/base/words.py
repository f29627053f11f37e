"""Numbers, durations and texts as people read them and JSON holds them: on terminals, screens and in reports."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from datetime import datetime
from math import floor, isfinite, log10
from typing import Final

NONE: Final = "—"
"""Replaces a missing value."""


COEFFICIENT: Final = 3
"""Decimals of a friction coefficient and of its uncertainties: U has two significant digits at 1 % and more."""


def coefficient(value: float | None) -> str:
    """Return a friction coefficient, or an uncertainty or difference of it, to ``COEFFICIENT`` decimals."""
    return decimal(value, COEFFICIENT)


def decimal(value: float | None, decimals: int) -> str:
    """Return a number with ``decimals`` decimals, never as -0; a dash where there is none."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}" if value is not None and isfinite(value) else NONE


def significant(value: float | None, digits: int = 3) -> str:
    """Return a number with ``digits`` significant digits; a dash where there is none."""
    return f"{value + 0.0:.{digits}g}" if value is not None and isfinite(value) else NONE


def percent(share: float, decimals: int = 1) -> str:
    """Return a share of 1 in per cent; a dash where there is none."""
    return f"{decimal(100.0 * share, decimals)}\u00a0%" if isfinite(share) else NONE


def duration(seconds: float | None) -> str:
    """Return seconds as h:mm:ss; a dash where there are none."""
    if seconds is None or not isfinite(seconds):
        return NONE
    minutes, s = divmod(round(max(seconds, 0.0)), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{s:02d}"


def rough_duration(seconds: float) -> str:
    """Return a duration in everyday form: 45 s, 12 min, 3 h 05 min."""
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60.0)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60:02d} min"


def local_hour(utc: str) -> str:
    """Return a time, ISO 8601 with a time zone, as weekday, hour and minute in this computer's zone; "" for none."""
    return datetime.fromisoformat(utc).astimezone().strftime("%a %H:%M") if utc else ""


def about(seconds: float) -> str:
    """Return a duration that is only roughly known, to one digit: about 20 s, about 7 min, about 2 h; at least 1 s."""
    unit, size_s = ("s", 1.0) if seconds < 95.0 else ("min", 60.0) if seconds < 5700.0 else ("h", 3600.0)
    units = max(seconds / size_s, 1.0)
    digit = 10.0 ** floor(log10(units))
    return f"about {digit * round(units / digit):.0f} {unit}"


def listed(items: Iterable[str], word: str = "and") -> str:
    """Return items in words: ``a``, ``a and b``, ``a, b and c``; ``word`` before the last."""
    texts = list(items)
    return f" {word} ".join([", ".join(texts[:-1]), *texts[-1:]] if len(texts) > 1 else texts)


def listed_some(items: Sequence[object], at_most: int) -> str:
    """Return the first items, and how many more there are: ``a, b, c and 3 more``."""
    shown = ", ".join(map(str, items[:at_most]))
    return f"{shown} and {len(items) - at_most} more" if len(items) > at_most else shown


def counted(n: int, noun: str, plural: str = "") -> str:
    """Return a number of things in words: ``1 condition``, ``3 conditions``."""
    return f"{n} {noun if n == 1 else plural or f'{noun}s'}"


def conditions_done(done: int, conditions: int, *, short: bool = False) -> str:
    """Return the progress of a run's conditions: ``17 of 55 conditions done``, or ``17/55 done`` in narrow places."""
    return f"{done}/{conditions} done" if short else f"{done} of {counted(conditions, 'condition')} done"


FORBIDDEN = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200b\u200e\u200f\u2028-\u202e\u2060-\u2069\ufeff\ufff9-\ufffb"
    "\ud800-\udfff\ufffe\uffff\U000e0000-\U000e007f]"
)
"""Control, bidirectional and invisible characters, and invalid characters."""

_NOT_IN_A_LINE = re.compile(f"{FORBIDDEN.pattern}|[\t\n]")


def plain_text(text: str, where: str = "") -> str:
    """Return a text of one line unchanged: a name, a note, a reason. ``where``: its meaning, for the message.

    Raises ValueError with the first refused character, and its place counted from 1.
    """
    refused = _NOT_IN_A_LINE.search(text)
    if refused is None:
        return text
    what = f"the character U+{ord(refused.group()):04X}, number {refused.start() + 1}, is not accepted"
    raise ValueError(f"{where}: {what} (control, bidirectional or invisible)" if where else what)


def harmless(text: str) -> str:
    """Return a text that cannot steer a terminal: dangerous characters become question marks; tabs and line ends
    stay."""
    return FORBIDDEN.sub("?", text)


Json = str | int | float | bool | None | list["Json"] | dict[str, "Json"]


def finite(value: float) -> float | None:
    """Return a number, None (JSON's null) for NaN and infinity."""
    return value if isfinite(value) else None
