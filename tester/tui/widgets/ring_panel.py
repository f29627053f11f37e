"""Errors of the line through a ring: by angle as columns, by speed as rows, by age as points with their trend."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import wrap
from typing import Final

from tester.analysis.ring_errors import RingRun, trend_of
from tester.base.words import NONE, decimal
from tester.tui.formatting import fit
from tester.tui.plot import Point, scatter
from tester.tui.rings import RingRow
from tester.tui.screen_scene import ScreenScene
from tester.tui.widgets.panel_base import FAINT, NOTICE, Panel, Parts, rows

STEPS: Final = " ▁▂▃▄▅▆▇█"
"""Characters for zero to eight eighths of a row."""
SECTORS: Final = 12
SCATTER_FROM: Final = 9
"""Number of rows from which points are shown in addition to the words."""


class AnglePanel(Panel):
    """Errors of a run in twelve sectors, each mounting separately."""

    run: RingRun | None = None

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return columns of errors above their angles."""
        run = self.run
        if run is None:
            return [("no run has a record of a ring", FAINT)]
        sectors = run.sectors()
        counts = [sum(mounting.sectors[at] for mounting in sectors) for at in range(SECTORS)]
        if not sum(counts):
            words = f"{run.errors} errors while it stood" if run.errors else "no errors"
            return [(fit(words, width), FAINT)]
        lines: list[Parts] = [[line] for line in columns(counts, width, height - 2)]
        for number_, sector in enumerate(sectors, start=1):
            if sector.found and len(lines) < height:
                text = f"{number_}: most at {sector.centre_deg:.0f}°, half within {sector.half_deg:.0f}° of it"
                lines.append([(fit(text, width), NOTICE)])
        if len(lines) < height:
            lines.append([(fit("from where it stood when mounted", width), FAINT)])
        return rows(lines[:height])


def columns(counts: Sequence[int], width: int, height: int) -> list[str]:
    """Return a column for each sector, in ``height`` rows with the angles below; the greatest count is shown above its
    column.
    """
    each = max(width // SECTORS, 1)
    most, room = max(counts), max(height - 2, 1)
    eighths = [round(8 * room * count / most) if most else 0 for count in counts]
    eighths = [max(eighth, 1) if count else 0 for eighth, count in zip(eighths, counts, strict=True)]
    lines = ["".join(f"{count:<{each}}" if count == most else " " * each for count in counts).rstrip()]
    for row in range(room - 1, -1, -1):
        signs = (STEPS[min(max(eighth - 8 * row, 0), 8)] for eighth in eighths)
        lines.append("".join((sign * max(each - 1, 1)).ljust(each) for sign in signs).rstrip())
    lines.append("".join(f"{30 * at:<{each}}" if at % (1 if each > 3 else 2) == 0 else " " * each
                         for at in range(SECTORS)).rstrip())  # fmt: skip
    return [fit(line, width) for line in lines]


class SpeedPanel(Panel):
    """Errors of a run by speed class."""

    run: RingRun | None = None

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return a row for each class."""
        if self.run is None:
            return []
        lines: list[Parts] = []
        for words, requests, errors in self.run.by_speed():
            share = decimal(1e3 * errors / requests, 2) if requests else NONE
            lines.append([fit(f"{words:<15}{errors:>6}{share:>8}/1000", width)])
        return rows(lines[:height])


class AgePanel(Panel):
    """The share of failed requests over the turns of the ring."""

    found: Sequence[RingRow] = ()

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return points, if there is room, and the trend in words."""
        counted = [(row.age, row.run.requests, row.run.errors) for row in self.found if row.run.requests]
        trend = trend_of(counted)
        text = trend.words or "a trend needs two or more runs with errors"
        words = wrap(text, max(width, 1))
        style = NOTICE if trend.grows else ""
        lines: list[Parts] = []
        if height >= SCATTER_FROM and len(counted) > 1:
            points = [Point(round(age), 1e3 * errors / requests, "●") for age, requests, errors in counted]
            for line in scatter(points, width, height - len(words)):
                lines.append([fit(line, width)])
        for word in words:
            lines.append([(word, style)])
        return rows(lines[:height])
