"""What a run shows on a terminal: a progress line, messages, prompts; or JSON lines for programs."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from errno import EPIPE
from queue import Empty, SimpleQueue
from threading import Thread
from typing import TextIO

from rich.console import Console as RichConsole
from rich.progress import BarColumn, Progress, TaskID, TextColumn
from rich.text import Text

from tester.cli.keys import HELP, commands_of, keys_of
from tester.engine.context import Progress as RunProgress
from tester.engine.prompts import Prompts


class Outlet:
    """A stream that may go away: its first failure is told, and from then on nothing is written to it."""

    def __init__(self, stream: TextIO) -> None:
        """Write through a standard stream."""
        self._stream = stream
        self.gone = False

    def write(self, text: str) -> None:
        """Write and flush. Raises OSError for what keeps it from that, once."""
        if self.gone:
            return
        try:
            self._stream.write(text)
            self._stream.flush()
        except OSError:
            self._leave()
            raise
        except ValueError as error:  # a closed file, or characters that it does not take
            self._leave()
            raise OSError(str(error)) from error

    def _leave(self) -> None:
        """Let the interpreter flush into nothing at its end: what is left in the buffer would fail once more."""
        self.gone = True
        with suppress(OSError, ValueError):
            nothing = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nothing, self._stream.fileno())
            os.close(nothing)


class Terminal(RichConsole):
    """Rich's console, which otherwise ends the process when nobody reads it."""

    def on_broken_pipe(self) -> None:
        """Raise BrokenPipeError."""
        raise BrokenPipeError(EPIPE, "Broken pipe")


class Console:
    """Standard output is data (JSON lines, the run's folder), standard error is for people."""

    def __init__(self, *, as_json: bool, answer_yes: bool) -> None:
        """``answer_yes``: prompts are answered without asking."""
        self.as_json = as_json
        self.answer_yes = answer_yes
        self._out, self._err = Outlet(sys.stdout), Outlet(sys.stderr)
        self._terminal = Terminal(file=sys.stderr)
        self._progress: Progress | None = None
        self._tasks: dict[int, TaskID] = {}
        """The progress lines by part."""
        self._answers: SimpleQueue[str] = SimpleQueue()
        self._asked = 0
        self._titles: dict[int, str] = {}
        self._keys = keys_of(sys.stdin)

    @property
    def can_ask(self) -> bool:
        """A person is there to answer."""
        return sys.stdin.isatty()

    # -- during the run ---------------------------------------------------------------------------------------

    def begin(self, name: str) -> None:
        """Show that a run has begun."""
        self.emit({"event": "begin", "run": name})
        self._keys.begin()
        if sys.stdin.isatty():
            self.message(HELP)
        if self._terminal.is_terminal:
            self._progress = Progress(
                BarColumn(bar_width=12),
                TextColumn("{task.percentage:3.0f} %"),
                TextColumn("{task.description}", markup=False),
                console=self._terminal,
                transient=True,
            )
            self._tasks[1] = self._progress.add_task(name, total=1.0)
            self._progress.start()

    def show(self, now_s: float, run: RunProgress, share: float) -> None:
        """Show where the run is, or one of its parts: ``share`` of the estimated rig time, 0..1."""
        of_part = {"part": run.part} if run.parts > 1 else {}
        label = f"part {run.part} of {run.parts}  " if run.parts > 1 else ""
        if run.title != self._titles.get(run.part):
            self._titles[run.part] = run.title
            self.emit({"event": "step", **of_part, "t_s": round(now_s, 3), "step": run.step, "title": run.title})
            if self._progress is None:
                self.message(f"{label}{_hours(now_s)}  {run.title}")
        if self._progress is not None:
            text = f"{label}{_hours(now_s)}  "
            if run.repeats:
                text += f"{run.condition}/{run.conditions} repeat {run.repeat}/{run.repeats}  "
            self._show_line(self._progress, run.part, min(share, 1.0), text + run.title)

    def _show_line(self, progress: Progress, part: int, share: float, text: str) -> None:
        """Bring a part's line up to date; it gets one when it is first heard of."""
        if part not in self._tasks:
            self._tasks[part] = progress.add_task("", total=1.0)
        progress.update(self._tasks[part], completed=share, description=text)

    def commands(self) -> list[str]:
        """Return what a person asked for by a key; none while a prompt takes a line."""
        return commands_of(self._keys.pressed())

    def end(self) -> None:
        """Take the progress line away, and give the keyboard back."""
        self._keys.end()
        if self._progress is not None:
            self._progress.stop()
            self._progress = None

    def message(self, text: str) -> None:
        """Say something to people; text from outside is shown as it is."""
        if self._progress is not None:
            self._progress.console.print(Text(text))
        else:
            self._err.write(text + "\n")

    def emit(self, record: dict[str, object]) -> None:
        """Write one JSON line, if that was asked for."""
        if self.as_json:
            self._out.write(json.dumps(record, ensure_ascii=False) + "\n")

    def result(self, line: str) -> None:
        """Write the last line of standard output."""
        self._out.write(line + "\n")

    # -- prompts ----------------------------------------------------------------------------------------------

    def attend(self, prompts: Prompts) -> None:
        """Ask what waits to be asked, and pass answers on; never blocks the scan."""
        waiting = prompts.waiting
        if waiting is None:
            return
        if waiting.number != self._asked:
            self._asked = waiting.number
            self.emit({"event": "prompt", "number": waiting.number, "text": waiting.text})
            self.message(f"{waiting.text} - done? [Enter] ")
            self._keys.end()  # a line is typed, with echo
            Thread(target=_read_line, args=(sys.stdin, self._answers.put), daemon=True).start()
            return
        try:
            answer = self._answers.get_nowait()
        except Empty:
            return
        if not answer:
            # End of input (a closed terminal, Ctrl+D) is nobody's consent.
            self.message("no answer can be read here any more: Ctrl+C stops the run")
        elif answer.strip().lower() in ("n", "no"):
            self._asked = 0
        else:
            waiting.answer = answer.strip() or "yes"
            self._keys.begin()


def _read_line(stream: TextIO, put: Callable[[str], None]) -> None:
    """Wait for one line and hand it over (a thread of its own: a terminal read cannot be polled portably)."""
    put(stream.readline())


def _hours(seconds: float) -> str:
    """Return rig time as h:mm:ss."""
    whole = int(seconds)
    return f"{whole // 3600}:{whole // 60 % 60:02d}:{whole % 60:02d}"
