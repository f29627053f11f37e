"""A report as one HTML file, self-contained, without requests or scripts; its figures are SVG within the page.

Text from people, devices and files is text everywhere: Jinja2 escapes all of it, and before that every character that
could steer a reader (control, bidirectional, invisible) becomes a question mark and very long text is cut. Only
drawings are markup of this program's making. The page forbids itself everything but its own style and its own pictures.
The markup is well-formed XML as well, which a test can check strictly.

A browser shows the ``title`` of the element under the pointer as a tooltip. Identifiers get the figure's key in front,
because those of all figures of a page share a namespace.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from importlib.resources import files
from math import isfinite
from typing import Any, Final
from xml.etree import ElementTree

from tester.base.plugins import MissingExtraError, needs
from tester.base.words import harmless
from tester.report.chart import Chart, Figure, Series
from tester.report.draw import LONGEST, MARKED, drawable, svg_for_a_page
from tester.report.layout import Report

POLICY: Final = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
"""Content-Security-Policy of the page: its own style and embedded pictures; no script at all."""
LONGEST_TEXT: Final = 4000
"""Most characters of one text; the page gives the number of the rest."""
SVG: Final = "http://www.w3.org/2000/svg"
XLINK: Final = "http://www.w3.org/1999/xlink"
HREF: Final = f"{{{XLINK}}}href"
REACH: Final = 6.0
"""Radius about a point, in points of the drawing, within which a pointer hits it."""
_DECIMALS = re.compile(r"(\.\d\d)\d+")
"""A hundredth of a point is finer than any screen or printer."""
_LONG: Final = ("d", "x", "y", "cx", "cy")
"""Attributes with coordinates, in which decimals may be cut."""
_FONT, _FONTS = "'DejaVu Sans'", "'DejaVu Sans', Verdana, sans-serif"
"""The font of the drawing, and its substitutes for a reader without it: one of equal width, or any."""

ElementTree.register_namespace("", SVG)
ElementTree.register_namespace("xlink", XLINK)


def page_of(report: Report) -> str:
    """Return the HTML of a report; raises MissingExtraError."""
    try:
        from jinja2 import Environment, FunctionLoader, StrictUndefined
        from markupsafe import Markup
    except ImportError as error:
        raise MissingExtraError(needs("a report", "jinja2", "report")) from error

    def finalize(value: object) -> object:
        return value if isinstance(value, Markup) or not isinstance(value, str) else readable(value)

    environment = Environment(
        loader=FunctionLoader(_packaged),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=finalize,
        trim_blocks=True,
        lstrip_blocks=True,
        auto_reload=False,
    )
    filters: dict[str, Any] = environment.filters  # pyright: ignore
    filters["drawing"] = Markup  # a drawing is this program's own markup
    return environment.get_template("page.html").render(
        report=report, policy=POLICY, style=Markup(_packaged("page.css"))
    )


def readable(text: str) -> str:
    """Return text that is safe on a page: harmless, and of at most ``LONGEST_TEXT`` characters."""
    plain = harmless(text)
    if len(plain) <= LONGEST_TEXT:
        return plain
    return f"{plain[:LONGEST_TEXT]}… ({len(plain) - LONGEST_TEXT} more characters)"


def _packaged(name: str) -> str:
    return files("tester.report").joinpath(name).read_text(encoding="utf-8")


def inline_svg(figure: Figure, key: str) -> str:
    """Return a figure as an SVG element; ``key``, letters, digits and -, is unique in the page.

    Raises MissingExtraError.
    """
    root = ElementTree.fromstring(svg_for_a_page(figure))
    for parent in list(root.iter()):
        for child in list(parent):
            if child.tag in (f"{{{SVG}}}metadata", f"{{{SVG}}}style"):
                parent.remove(child)
    if isinstance(figure, Chart):
        _name_points(root, figure)
    _shorten(root)
    _own_names(root, key)
    width, height = (root.attrib.pop(name).removesuffix("pt") for name in ("width", "height"))
    root.set("viewBox", f"0 0 {width} {height}")
    root.set("role", "img")
    root.set("aria-label", alt_text(figure))
    return ElementTree.tostring(root, encoding="unicode")


def alt_text(figure: Figure) -> str:
    """Return the content of a figure in words: its title, and the span of each panel's points."""
    sentences = [figure.title]
    if isinstance(figure, Chart):
        for panel in figure.panels:
            points = [series for series in panel.series if series.look in ("measured", "left out")]
            x, y = _spans((v for point in points for v in point.x), (v for point in points for v in point.y))
            if x and y:
                title = f"{panel.title}: " if panel.title else ""
                upright = panel.y_label or figure.y_label
                sentences.append(
                    f"{title}{sum(len(series.x) for series in points)} points, {figure.x_label} {x}, {upright} {y}"
                )
    else:
        for title, along, upward, grid in figure.panels:
            (z,) = _spans(value for row in grid for value in row)
            sentences.append(f"{title}: {len(along)} by {len(upward)} values, {figure.z_label} {z}")
    return drawable("; ".join(sentences), 4 * LONGEST)


def _spans(*groups: Iterator[float]) -> list[str]:
    spans: list[str] = []
    for values in groups:
        known = [value for value in values if isfinite(value)]
        spans.append(f"{min(known):.4g} to {max(known):.4g}" if known else "")
    return spans


def _name_points(root: ElementTree.Element, chart: Chart) -> None:
    groups = {element.get("id", ""): element for element in root.iter(f"{{{SVG}}}g")}
    for i, panel in enumerate(chart.panels):
        upright = panel.y_label or chart.y_label
        for j, series in enumerate(panel.series):
            group = groups.get(f"{MARKED}-{i}-{j}")
            if group is not None and series.look not in ("law", "limit"):
                _name(group, _names(series, chart.x_label, upright))


def _names(series: Series, x_label: str, y_label: str) -> Sequence[str]:
    """Return a label for each drawn point: one at finite coordinates."""
    names = series.names or [
        f"{f'{series.label}: ' if series.label else ''}{x_label} {x:.4g}, {y_label} {y:.4g}"
        for x, y in zip(series.x, series.y, strict=True)
    ]
    places = zip(names, series.x, series.y, strict=True)
    return [name for name, x, y in places if isfinite(x) and isfinite(y)]


def _name(group: ElementTree.Element, names: Sequence[str]) -> None:
    """Wrap every mark of a group in a group with a title, and add a disc that a pointer hits more easily."""
    holders = [(parent, child) for parent in group.iter() for child in parent if child.tag == f"{{{SVG}}}use"]
    if len(holders) != len(names):  # a mark outside the drawing is not drawn: better no name than a wrong one
        return
    for (parent, mark), name in zip(holders, names, strict=True):
        named = ElementTree.Element(f"{{{SVG}}}g")
        ElementTree.SubElement(named, f"{{{SVG}}}title").text = drawable(name)
        place = {"cx": mark.get("x", "0"), "cy": mark.get("y", "0"), "r": f"{REACH:g}"}
        ElementTree.SubElement(named, f"{{{SVG}}}circle", {**place, "fill": "none", "pointer-events": "all"})
        parent[list(parent).index(mark)] = named
        named.append(mark)


def _shorten(root: ElementTree.Element) -> None:
    for element in root.iter():
        for name in _LONG:
            value = element.get(name)
            if value is not None:
                element.set(name, _DECIMALS.sub(r"\1", value).replace("  ", " "))
        element.tail = None
        if element.tag == f"{{{SVG}}}text":
            element.set("style", element.get("style", "").replace(_FONT, _FONTS))
        elif element.text is not None and not element.text.strip():
            element.text = None


def _own_names(root: ElementTree.Element, key: str) -> None:
    """Put the key in front of every referenced identifier, and remove the others."""
    used: set[str] = set()
    for element in root.iter():
        for name, value in element.attrib.items():
            if name == HREF and value.startswith("#"):
                used.add(value[1:])
                element.set(name, f"#{key}-{value[1:]}")
            elif "url(#" in value:
                used.update(re.findall(r"url\(#([^)]+)\)", value))
                element.set(name, value.replace("url(#", f"url(#{key}-"))
    for element in root.iter():
        identifier = element.attrib.pop("id", None)
        if identifier in used:
            element.set("id", f"{key}-{identifier}")
