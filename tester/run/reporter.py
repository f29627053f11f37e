"""Screens that show a run, and a wrapper that stops the run when its screen is lost."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import ParamSpec

from tester.base.trouble import in_words
from tester.machine.context import Progress
from tester.machine.prompts import Prompts
from tester.machine.time_left import RunPosition

P = ParamSpec("P")


class ReportScreen:
    """Shows a run to people; this class shows nothing. A method raises OSError if its screen, pipe or file has gone."""

    answer_yes: bool = False
    """Whether prompts are answered without asking."""
    can_ask: bool = False
    """Whether a person can answer prompts."""

    def begin(self, name: str) -> None:
        """Show that a run has begun."""

    def show(self, now_s: float, run: Progress, at: RunPosition) -> None:
        """Show the progress of the run, or of one of several parallel parts."""

    def attend(self, prompts: Prompts) -> None:
        """Ask and answer prompts without blocking."""

    def commands(self) -> list[str]:
        """Return a person's commands since the last call, from those in ``tester.base.keys``."""
        return []

    def end(self) -> None:
        """Remove the progress display."""

    def message(self, text: str) -> None:
        """Show a message."""

    def emit(self, record: dict[str, object]) -> None:
        """Write a record for other programs to read."""

    def result(self, line: str) -> None:
        """Write the path of the run's folder."""


class LastingScreen(ReportScreen):
    """A screen whose failure does not break the run.

    After its first error it shows nothing and asks nothing more, and calls ``lost`` with the cause. It still tries to
    write messages and records, because only one of two outputs may have gone.
    """

    def __init__(self, screen: ReportScreen, lost: Callable[[str], None]) -> None:
        """``lost`` is called once, with the text of the first error."""
        self._screen = screen
        self._lost = lost
        self.answer_yes = screen.answer_yes
        self.can_ask = screen.can_ask
        self.gone = False

    def begin(self, name: str) -> None:
        self._try(self._screen.begin, name)

    def show(self, now_s: float, run: Progress, at: RunPosition) -> None:
        if not self.gone:
            self._try(self._screen.show, now_s, run, at)

    def attend(self, prompts: Prompts) -> None:
        if not self.gone:
            self._try(self._screen.attend, prompts)

    def commands(self) -> list[str]:
        pressed: list[str] = []
        if not self.gone:
            self._try(lambda: pressed.extend(self._screen.commands()))
        return pressed

    def end(self) -> None:
        self._try(self._screen.end)

    def message(self, text: str) -> None:
        self._try(self._screen.message, text)

    def emit(self, record: dict[str, object]) -> None:
        self._try(self._screen.emit, record)

    def result(self, line: str) -> None:
        self._try(self._screen.result, line)

    def _try(self, show: Callable[P, None], *args: P.args, **kwargs: P.kwargs) -> None:
        try:
            show(*args, **kwargs)
        except OSError as error:
            self._lose(error)

    def _lose(self, error: OSError) -> None:
        if self.gone:
            return
        self.gone = True
        text = f"the run can no longer be shown: {in_words(error)}"
        self._lost(text)
        with suppress(OSError):
            self._screen.message(text)
