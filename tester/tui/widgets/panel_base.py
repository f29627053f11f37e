"""A panel draws a part of the scene as styled text; it is drawn again only if that text has changed."""

from __future__ import annotations

from typing import TypeAlias

from textual.content import Content
from textual.widgets import Static

from tester.tui.screen_scene import ScreenScene

Part: TypeAlias = "str | tuple[str, str]"
"""A text, or a text with its style."""
Parts: TypeAlias = "list[Part]"

ABNORMAL = "bold reverse $error"
WARNING = "bold reverse $warning"
NOTICE = "bold underline"
FAINT = "dim"


def plain(parts: Parts) -> str:
    """Return the text without styles."""
    return "".join(part if isinstance(part, str) else part[0] for part in parts)


class Panel(Static):
    """Shows what ``picture`` makes of the scene in the available space. Text is never interpreted as markup."""

    def __init__(self, *, id: str | None = None, classes: str | None = None, title: str = "") -> None:  # noqa: A002
        """Begin empty until the first scene. ``id``, ``classes``: as in Textual; ``title``: text in the border."""
        super().__init__("", markup=False, id=id, classes=classes)
        if title:
            self.border_title = title
        self.scene: ScreenScene | None = None
        self._drawn: Parts | None = None
        self._entitled: str = ""

    def show(self, scene: ScreenScene) -> None:
        """Draw the scene as it is now."""
        self.scene = scene
        self.redraw()

    def redraw(self) -> None:
        """Draw again, if the text has changed and the panel is visible."""
        size = self.content_size
        if self.scene is None or not size.width or not size.height:
            return
        parts = self.picture(self.scene, size.width, size.height)
        if parts != self._drawn:
            self._drawn = parts
            self.update(Content.assemble(*parts), layout=False)

    def entitle(self, title: str) -> None:
        """Put a title into the border, if it differs from the present one; it is never interpreted as markup."""
        if title != self._entitled:
            self._entitled = title
            self.border_title = Content(title)

    def on_resize(self) -> None:
        """Draw for the new size."""
        self.redraw()

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return the content for ``width`` columns and ``height`` rows."""
        return []

    @property
    def text(self) -> str:
        """Return the displayed text, without styles."""
        return plain(self._drawn or [])


def rows(lines: list[Parts]) -> Parts:
    """Return the lines one below the other."""
    joined: Parts = []
    for number, line in enumerate(lines):
        if number:
            joined.append("\n")
        joined.extend(line)
    return joined
