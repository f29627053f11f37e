"""Screens that show a run, and a wrapper that stops the run when its screen is lost."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Protocol, runtime_checkable

from tester.base.trouble import in_words
from tester.machine.context import Progress
from tester.machine.prompts import Prompts
from tester.machine.time_left import RunPosition


class ReportScreen(Protocol):
    """Shows a run to people. A method raises OSError if its screen, pipe or file is gone."""

    answer_yes: bool

    @property
    def can_ask(self) -> bool:
        """Whether a person can answer prompts."""
        ...

    def begin(self, name: str) -> None:
        """Show that a run has begun."""
        ...

    def show(self, now_s: float, run: Progress, at: RunPosition) -> None:
        """Show where the run is, or one of its parts when they run side by side."""
        ...

    def attend(self, prompts: Prompts) -> None:
        """Ask and answer prompts without blocking."""
        ...

    def end(self) -> None:
        """Remove the progress display."""
        ...

    def message(self, text: str) -> None:
        """Show a message."""
        ...

    def emit(self, record: dict[str, object]) -> None:
        """Write a record for programs."""
        ...

    def result(self, line: str) -> None:
        """Write the run's folder."""
        ...


@runtime_checkable
class Commanding(Protocol):
    """A screen at which a person can give commands to the run."""

    def commands(self) -> list[str]:
        """Return the commands since the last call, out of those in ``tester.base.keys``."""
        ...


class LastingScreen:
    """A screen whose failure does not break the run.

    After its first error it shows and asks nothing more, and calls ``lost`` with the cause. It still tries messages and
    records, in case only one of two outputs is gone.
    """

    def __init__(self, screen: ReportScreen, lost: Callable[[str], None]) -> None:
        """``lost`` is called once."""
        self._screen = screen
        self._lost = lost
        self.answer_yes = screen.answer_yes
        self.gone = False

    @property
    def can_ask(self) -> bool:
        return self._screen.can_ask

    def begin(self, name: str) -> None:
        try:
            self._screen.begin(name)
        except OSError as error:
            self._lose(error)

    def show(self, now_s: float, run: Progress, at: RunPosition) -> None:
        if self.gone:
            return
        try:
            self._screen.show(now_s, run, at)
        except OSError as error:
            self._lose(error)

    def attend(self, prompts: Prompts) -> None:
        if self.gone:
            return
        try:
            self._screen.attend(prompts)
        except OSError as error:
            self._lose(error)

    def commands(self) -> list[str]:
        if self.gone or not isinstance(self._screen, Commanding):
            return []
        try:
            return self._screen.commands()
        except OSError as error:
            self._lose(error)
            return []

    def end(self) -> None:
        try:
            self._screen.end()
        except OSError as error:
            self._lose(error)

    def message(self, text: str) -> None:
        try:
            self._screen.message(text)
        except OSError as error:
            self._lose(error)

    def emit(self, record: dict[str, object]) -> None:
        try:
            self._screen.emit(record)
        except OSError as error:
            self._lose(error)

    def result(self, line: str) -> None:
        try:
            self._screen.result(line)
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
