"""What every screen has: its keys, its help, and a way to the host."""

from __future__ import annotations

from typing import ClassVar

from textual.containers import Vertical

from tester.tui.host import HostApp, host_of
from tester.tui.scene import ScreenScene
from tester.tui.widgets.panel import Panel

Keys = tuple[tuple[str, str], ...]


class View(Vertical):
    """A screen between the fixed lines. ``KEYS``: what the last line names; ``HELP``: what F1 shows."""

    KEYS: ClassVar[Keys] = ()
    HELP: ClassVar[str | None] = ""

    @property
    def host(self) -> HostApp:
        """Return the application."""
        return host_of(self)

    def show(self, scene: ScreenScene) -> None:
        """Show the scene as it is now."""
        for panel in self.query(Panel):
            panel.show(scene)

    def enter(self) -> None:
        """Become the screen that is shown, once each time."""
        self.take_focus()

    def take_focus(self) -> None:
        """Have the keys go to where they are wanted first."""
        self.focus()

    def leave(self) -> None:
        """Another screen is shown from now on."""
