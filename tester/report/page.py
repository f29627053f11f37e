"""A report as one HTML file: self-contained, without requests or scripts.

Text from people, devices and files is text everywhere: Jinja2 escapes all of it, and before that every character that
could steer a reader (control, bidirectional, invisible) becomes a question mark and very long text is cut. Only
drawings are markup of this program's making. The page forbids itself everything but its own style and its own pictures.
The markup is well-formed XML as well, which a test can check strictly.
"""

from __future__ import annotations

from importlib.resources import files
from typing import Any, Final

from tester.base.plugins import MissingExtraError, needs
from tester.base.words import harmless
from tester.report.layout import Report

POLICY: Final = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
"""Content-Security-Policy of the page: its own style and embedded pictures; no script at all."""
LONGEST: Final = 4000
"""Most characters of one text; the page gives the number of the rest."""


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
    """Return text that is safe on a page: harmless, and of at most ``LONGEST`` characters."""
    plain = harmless(text)
    if len(plain) <= LONGEST:
        return plain
    return f"{plain[:LONGEST]}… ({len(plain) - LONGEST} more characters)"


def _packaged(name: str) -> str:
    return files("tester.report").joinpath(name).read_text(encoding="utf-8")
