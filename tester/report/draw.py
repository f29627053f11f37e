"""Draws charts with matplotlib, which comes with the extra ``report`` and is imported for the first drawing.

Readable in grey and by colour-blind people: points that belong together share a colour, a mark and a dash, and the
colours differ in lightness. Drawing uses no screen, no clock and nothing random: the same chart gives the same file.
"""

from __future__ import annotations

import warnings
from functools import partial
from io import BytesIO
from itertools import pairwise
from math import ceil
from operator import mul
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any, BinaryIO, Final

from tester.base.plugins import MissingExtraError, needs
from tester.base.words import harmless
from tester.report.chart import Chart, ChartPanel, ChartSurface, Figure, SecondScale, Series

if TYPE_CHECKING:
    from collections.abc import Sequence

COLOURS: Final = ("#000000", "#D55E00", "#56B4E9", "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#404040")
"""Okabe and Ito's palette (jfly.uni-koeln.de/color), whose colours colour-blind people can distinguish, in an order in
which neighbours differ in lightness; a grey instead of its yellow, which is too light for lines."""
MARKS: Final = ("o", "s", "^", "D", "v", "P", "X", "<")
DASHES: Final = ("-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1)), (0, (1, 1)), (0, (8, 2)))
FORMATS: Final = ("png", "svg", "pdf")
PANEL_INCH: Final = (3.6, 3.2)
STRIP_INCH: Final = (7.2, 1.5)
"""Size of a panel of a stacked chart."""
COLUMNS, COLUMNS_OF_PAGE = 3, 2
"""Panels side by side, in a file and in a page, whose letters would else be too small."""
TITLE_WIDTH, NOTE_WIDTH = 52, 64
"""Characters of title and note that fit over a panel."""
RC: Final[dict[str, object]] = {
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "axes.grid": True,
    "grid.color": "#D0D0D0",
    "grid.linewidth": 0.5,
    "axes.axisbelow": True,
    "lines.linewidth": 1.1,
    "lines.markersize": 4.5,
    "legend.fontsize": 7.0,
    "legend.framealpha": 0.8,
    "svg.hashsalt": "friction-tester",
    "svg.fonttype": "path",
    "text.parse_math": False,
}
"""matplotlib's own font, so that a figure looks the same everywhere; a $ in a name is no formula."""
IN_A_PAGE: Final[dict[str, object]] = {"svg.fonttype": "none"}
"""Text of a figure within a page is text: a browser can search and read it out, and it takes a tenth of the space."""
MARKED: Final = "points"
"""Prefix of the id of a series' points: ``points-PANEL-SERIES``, each counted from 0."""
LONGEST, LONGEST_LABEL = 200, 32
"""Most characters of a title or a note, and of a label in a legend."""
NO_DATES: Final = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}


def draw(figure: Figure, path: Path, dpi: float = 150.0) -> None:
    """Write a figure; the suffix of ``path`` selects the format. Raises MissingExtraError, OSError, ValueError."""
    ending = path.suffix.removeprefix(".").lower()
    if ending not in FORMATS:
        raise ValueError(f"{path.name}: a figure is one of {', '.join(FORMATS)}")
    made = BytesIO()
    _draw(figure, made, ending, dpi, {}, COLUMNS)
    path.write_bytes(made.getvalue())


def svg_for_a_page(figure: Figure) -> bytes:
    """Return a figure as SVG with text as text and with identifiers on its points (``MARKED``).

    Raises MissingExtraError.
    """
    made = BytesIO()
    _draw(figure, made, "svg", 72.0, IN_A_PAGE, COLUMNS_OF_PAGE)
    return made.getvalue()


def _draw(
    figure: Figure, target: BinaryIO, ending: str, dpi: float, further: dict[str, object], most_across: int
) -> None:
    try:
        import matplotlib  # pyright: ignore
        from matplotlib.figure import Figure as Canvas  # pyright: ignore
    except ImportError as error:
        raise MissingExtraError(needs("a figure", "matplotlib", "report")) from error
    library: Any = matplotlib
    with library.rc_context({**RC, **further}), warnings.catch_warnings():
        # A name in letters that the font lacks is drawn as boxes; a page shows it in a font that has them.
        warnings.filterwarnings("ignore", message="Glyph .* missing from", category=UserWarning)
        stacked = isinstance(figure, Chart) and figure.stacked
        across = 1 if stacked else min(most_across, len(figure.panels))
        down = ceil(len(figure.panels) / across)
        wide, high = STRIP_INCH if stacked else PANEL_INCH
        canvas: Any = Canvas(figsize=(wide * across, high * down + 0.5), layout="constrained")
        own_x = isinstance(figure, Chart) and figure.own_x
        places: Any = canvas.subplots(down, across, squeeze=False, sharex=not own_x, sharey=not stacked)
        flat: list[Any] = [place for row in places for place in row]
        if isinstance(figure, Chart):
            _draw_chart(figure, flat)
        else:
            _draw_surface(figure, canvas, flat)
        for place in flat[len(figure.panels) :]:
            place.set_axis_off()
        columns = 2 if stacked else across
        canvas.suptitle(fill(drawable(figure.title), TITLE_WIDTH * columns), fontsize=9.0)
        if figure.note:
            canvas.supxlabel(fill(drawable(figure.note), NOTE_WIDTH * columns), fontsize=7.0, color="#404040")
        canvas.savefig(target, format=ending, dpi=dpi, metadata=NO_DATES[ending])


def drawable(text: str, longest: int = LONGEST) -> str:
    """Return text in drawable form: people's text may be long, and hold characters without a glyph."""
    plain = harmless(text).replace("\n", " ").replace("\t", " ")
    return plain if len(plain) <= longest else f"{plain[: longest - 1]}…"


def _draw_chart(chart: Chart, places: Sequence[Any]) -> None:
    for number, (panel, place) in enumerate(zip(chart.panels, places, strict=False)):
        _draw_panel(panel, place, number)
        if not chart.stacked or number == len(chart.panels) - 1:
            place.set_xlabel(panel.x_label or chart.x_label)
        if chart.log_x:
            place.set_xscale("log")
            # its own formatter writes a formula, and text here is never read as a formula
            place.xaxis.set_major_formatter("{x:g}")
            place.xaxis.set_minor_formatter(_two_and_five if _narrow(panel) else "")
        if panel.log_y:
            place.set_yscale("log")
            place.yaxis.set_major_formatter("{x:g}")
            place.yaxis.set_minor_formatter("")
        place.set_ylabel(panel.y_label or chart.y_label)
        _second_scales(place, chart.x_second, panel.y_second)
    if chart.from_zero:  # last: an axis with a fixed limit ignores further points, also of panels that share it
        places[0].set_ylim(bottom=0.0)


def _second_scales(
    place: Any, x: SecondScale | None, y: SecondScale | None, at: tuple[Sequence[float], ...] = ((), ())
) -> None:
    """Draw the further scales of a pair of axes, whose own scales are set; ``at``: marks of x and y, () for any."""
    sides = ((x, "top", place.secondary_xaxis, at[0]), (y, "right", place.secondary_yaxis, at[1]))
    for second, side, add, marks in sides:
        if second is None:
            continue
        drawn = add(side, functions=(partial(mul, second.factor), partial(mul, 1.0 / second.factor)))
        along = drawn.xaxis if side == "top" else drawn.yaxis
        along.set_label_text(second.label)
        if marks:
            along.set_ticks([second.factor * mark for mark in marks])
        along.set_major_formatter("{x:g}")


def _narrow(panel: ChartPanel) -> bool:
    """Return whether a panel spans less than two decades, where powers of ten alone are too few marks."""
    every = [x for series in panel.series for x in series.x]
    return max(every) < 100.0 * min(every)


def _two_and_five(value: float, _: object) -> str:
    return f"{value:g}" if f"{value:e}"[0] in "25" else ""


def _draw_panel(panel: ChartPanel, place: Any, number: int) -> None:
    lined = {series.style for series in panel.series if series.look == "law"}
    for turn, series in enumerate(panel.series):
        drawn = _draw_series(series, place, joined=panel.joined and not series.widths and series.style not in lined)
        drawn.set_gid(f"{MARKED}-{number}-{turn}")
    if panel.title:
        place.set_title(fill(drawable(panel.title), TITLE_WIDTH), fontsize=8.0)
    if any(series.label for series in panel.series):
        place.legend()


def _draw_series(series: Series, place: Any, joined: bool) -> Any:
    """Draw measured points filled, published ones hollow, a law as a line, excluded points as crosses.

    ``joined``: join measured points by a line, where no law is drawn through them. Returns the line of the points.
    """
    i = series.style % len(COLOURS)
    colour = COLOURS[i]
    label = drawable(series.label, LONGEST_LABEL) or None
    alone: dict[str, dict[str, object]] = {
        "law": {"color": colour, "linestyle": DASHES[i], "linewidth": 1.0},
        "limit": {"color": "#606060", "linestyle": DASHES[i], "linewidth": 0.9},
        "published": {"color": colour, "marker": MARKS[i], "linestyle": "none", "markerfacecolor": "none"},
    }
    if series.look in alone:
        return place.plot(series.x, series.y, label=label, **alone[series.look])[0]
    mark = "x" if series.look == "left out" else MARKS[i]
    drawn: Any = place.errorbar(
        series.x,
        series.y,
        yerr=series.bars or None,
        xerr=series.widths or None,
        color=colour,
        marker=mark,
        linestyle=DASHES[i] if joined and series.look == "measured" else "none",
        elinewidth=0.8,
        capsize=2.0,
        label=label,
    )
    return drawn.lines[0]


def _draw_surface(surface: ChartSurface, canvas: Any, places: Sequence[Any]) -> None:
    """Draw a field for each pair of values, at its place on both axes, with its number; the colours differ in lightness
    alone."""
    every = [v for _, _, _, grid in surface.panels for row in grid for v in row if v == v]
    low, high = min(every), max(every)
    drawn: Any = None
    for (title, x, y, grid), place in zip(surface.panels, places, strict=False):
        drawn = place.pcolormesh(_edges(x), _edges(y), grid, cmap="cividis", vmin=low, vmax=high)
        place.set_xticks(x, [f"{value:g}" for value in x])
        place.set_yticks(y, [f"{value:g}" for value in y])
        place.grid(False)
        for height, row in zip(y, grid, strict=True):
            for along, value in zip(x, row, strict=True):
                if value == value:
                    color = "white" if value < 0.5 * (low + high) else "black"
                    place.text(along, height, f"{value:.2f}", ha="center", va="center", color=color)
        place.set_title(title, fontsize=8.0)
        place.set_xlabel(surface.x_label)
        place.set_ylabel(surface.y_label)
        _second_scales(place, surface.x_second, surface.y_second, (x, y))
    if drawn is not None:
        canvas.colorbar(drawn, ax=[*places[: len(surface.panels)]], label=surface.z_label)


def _edges(values: Sequence[float]) -> list[float]:
    """Return the edges of the fields of at least two ascending values: half way between them, and as far outside."""
    between = [0.5 * (lower + upper) for lower, upper in pairwise(values)]
    return [2.0 * values[0] - between[0], *between, 2.0 * values[-1] - between[-1]]
