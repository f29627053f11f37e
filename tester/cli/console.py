"""A run on a terminal: a progress line, messages, prompts; or JSON lines for programs."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from errno import EBADF
from pathlib import Path
from typing import TextIO, cast

from rich.console import Console as RichConsole
from rich.progress import BarColumn, Progress, TaskID, TextColumn
from rich.table import Column
from rich.text import Text

from tester.base.clock import monotonic
from tester.base.keys import FAST_STOP, HELP, HOLD, STOP, Meaning, commands_of, pieces_of
from tester.base.words import about, conditions_done, duration
from tester.cli.command_keys import keys_of
from tester.cli.ending import ending_lines
from tester.machine.context import Progress as RunProgress
from tester.machine.prompts import DONE, Prompt, Prompts, Question
from tester.machine.time_left import RunPosition
from tester.run.reporter import ReportScreen
from tester.run.wall_time import WallTime

ASKED = f'type "{DONE}" and Enter when it is done'
MOST_TYPED = 200
FASTER = 0.9
"""A run whose wall time left is below this share of its rig time left is simulated faster than a machine's pace."""
END_OF_INPUT = "\x04"
"""Ctrl+D."""


class Outlet:
    """A standard stream that may go away while it is written to, by another thread too (rich's).

    Writing never fails: the first failure is kept, ``check`` raises it once, and nothing is written from then on. A
    stream that was closed from the start is not reported.
    """

    def __init__(self, stream: TextIO | None) -> None:
        """``stream``: None where the process was started without it."""
        self._stream = stream
        self._error: OSError | None = None
        self._reported = False
        self.encoding = stream.encoding if stream is not None else "utf-8"

    def isatty(self) -> bool:
        """Return whether it is a terminal."""
        return self._stream is not None and self._stream.isatty()

    def fileno(self) -> int:
        """Return the descriptor. Raises OSError where there is none."""
        if self._stream is None:
            raise OSError(EBADF, "no such stream")
        return self._stream.fileno()

    def write(self, text: str) -> int:
        """Write, if the stream is still there; return the number of characters."""
        return self._try(lambda stream: stream.write(text)) or len(text)

    def flush(self) -> None:
        """Flush."""
        self._try(lambda stream: stream.flush())

    def line(self, text: str) -> None:
        """Write a line and flush it. Raises OSError, once, if the stream cannot be written."""
        self.write(text + "\n")
        self.flush()
        self.check()

    def check(self) -> None:
        """Raise the error that ended writing to this stream, if any; later calls do not raise it again."""
        if self._error is not None and not self._reported:
            self._reported = True
            raise self._error

    def _try(self, work: Callable[[TextIO], int | None]) -> int | None:
        if self._stream is None or self._error is not None:
            return None
        try:
            return work(self._stream)
        except OSError as error:
            self._leave(error)
        except ValueError as error:  # a closed file, or characters that it does not take
            self._leave(OSError(str(error)))
        return None

    def _leave(self, error: OSError) -> None:
        """Redirect the stream to nothing. Otherwise the interpreter's last flush of its buffer would fail again."""
        self._error = error
        with suppress(OSError, ValueError):
            nothing = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nothing, self.fileno())
            os.close(nothing)


class Console(ReportScreen):
    """Standard output is data (JSON lines, the run's folder), standard error is for people."""

    always: tuple[Meaning, ...] = (STOP, FAST_STOP, HOLD)
    """Keys that keep their meaning while a question waits: all others belong to its answer."""

    def __init__(self, *, as_json: bool, answer_yes: bool, clock: Callable[[], float] = monotonic) -> None:
        """``answer_yes``: prompts are answered without asking. ``clock``: wall time, s."""
        self.as_json = as_json
        self.answer_yes = answer_yes
        self.can_ask = _is_terminal(sys.stdin)
        self._out, self._err = Outlet(sys.stdout), Outlet(sys.stderr)
        self._terminal = RichConsole(file=cast("TextIO", self._err))
        self._progress: Progress | None = None
        self._tasks: dict[int, TaskID] = {}
        """The progress lines by part."""
        self._clock = clock
        self._walls: dict[int, WallTime] = {}
        """The wall time left, by progress line."""
        self._question: Prompt | None = None
        """The newest that was put."""
        self._typed = ""
        self._titles: dict[int, str] = {}
        self._keys = keys_of(sys.stdin)

    # -- during the run ---------------------------------------------------------------------------------------

    def begin(self, name: str) -> None:
        """Show that a run has begun."""
        self.emit({"event": "begin", "run": name})
        self._keys.begin()
        if self.can_ask:
            self.message(HELP)
        if self._terminal.is_terminal:
            self._progress = Progress(
                BarColumn(bar_width=12),
                TextColumn("{task.percentage:3.0f} %"),
                # The text gets what the bar and the share leave, and only the text is cut.
                TextColumn("{task.description}", markup=False, table_column=Column(ratio=1, no_wrap=True)),
                expand=True,
                console=self._terminal,
                transient=True,
            )
            self._tasks[1] = self._progress.add_task(name, total=1.0)
            self._progress.start()

    def show(self, now_s: float, run: RunProgress, at: RunPosition) -> None:
        """Show the progress of the run, or of one of several parallel parts."""
        of_part = {"part": at.part} if at.parts > 1 else {}
        label = f"part {at.part} of {at.parts}  " if at.parts > 1 else ""
        if run.title != self._titles.get(at.part):
            self._titles[at.part] = run.title
            where = {"t_s": round(now_s, 3), "step": at.step, "title": run.title}
            counted = {"over": at.over, "conditions": at.conditions, "left_s": at.left_s}
            self.emit({"event": "step", **of_part, **where, **counted})
            if self._progress is None:
                self.message(f"{label}{duration(now_s)}  {run.title}")
        if self._progress is not None:
            line = at.part if at.beside else 1
            wall = self._walls.setdefault(line, WallTime(self._clock))
            text = label + standing_words(at, wall.left_s(at.done_s, at.left_s or 0.0))
            if run.repeats:
                text += f"  repeat {run.repeat}/{run.repeats}"
            self._show_line(self._progress, line, at.share, f"{text}  {run.title}")
            self._err.check()

    def _show_line(self, progress: Progress, part: int, share: float, text: str) -> None:
        """Bring a part's line up to date; the first call for a part adds one."""
        if part not in self._tasks:
            self._tasks[part] = progress.add_task("", total=1.0)
        progress.update(self._tasks[part], completed=share, description=text)

    def commands(self) -> list[str]:
        """Return the commands of the pressed keys; while a question waits, letters belong to its answer."""
        pressed = self._keys.pressed()
        if self._question is None or self._question.answer is not None:
            return commands_of(pressed)
        commands: list[str] = []
        for piece, meaning in pieces_of(pressed):
            if meaning in self.always:
                commands.append(meaning.command)
            elif piece in ("\r", "\n"):
                typed, self._typed = self._typed, ""
                self.answer(self._question, typed)
            elif piece in ("\b", "\x7f"):
                self._typed = self._typed[:-1]
            elif piece == END_OF_INPUT:
                self.message("that is no answer: Ctrl+C stops the run")
            elif piece.isprintable():
                self._typed = (self._typed + piece)[:MOST_TYPED]
        return commands

    def end(self) -> None:
        """Take the progress line away, and give the keyboard back."""
        self._keys.end()
        if self._progress is not None:
            self._progress.stop()
            self._progress = None

    def message(self, text: str) -> None:
        """Show people a message; text from outside is shown as it is."""
        if self._progress is not None:
            self._progress.console.print(Text(text))
            self._err.check()
        else:
            self._err.line(text)

    def emit(self, record: dict[str, object]) -> None:
        """Write one JSON line, if that was asked for."""
        if self.as_json:
            self._out.line(json.dumps(record, ensure_ascii=False))

    def result(self, line: str) -> None:
        """Show people the results and the next commands; write the folder, the last line of standard output."""
        if not self.as_json:
            for text in ending_lines(Path(line)):
                self.message(text)
        self._out.line(line)

    # -- prompts ----------------------------------------------------------------------------------------------

    def attend(self, prompts: Prompts) -> None:
        """Ask the waiting question without blocking the scan. Keys typed before the question do not answer it."""
        waiting = prompts.waiting
        if waiting is None or waiting is self._question:
            return
        self._question = waiting
        self._keys.pressed()
        self._typed = ""
        unit = {"unit": waiting.question.unit} if waiting.question.unit else {}
        self.emit({"event": "prompt", "number": waiting.number, "text": waiting.text, **unit})
        self.put(waiting.question)

    def put(self, question: Question) -> None:
        """Show a question."""
        how = f'type {question.hint}, or "{DONE}", and Enter' if question.unit else ASKED
        self.message(f"{question.text} - {how}")

    def answer(self, prompt: Prompt, typed: str) -> None:
        """Take a typed line as the answer, if it is one."""
        if prompt.reply(typed):
            self.put(prompt.question)
        else:
            self.message(f"answered: {prompt.answer}")


def standing_words(at: RunPosition, wall_s: float | None) -> str:
    """Return how far a run is: its conditions that are done, its rig time, and the wall time left (``wall_s``, if
    known), which at a machine's own pace is the rig time left.
    """
    words = [conditions_done(at.over, at.conditions, short=True)] if at.conditions else []
    if at.left_s is not None:
        words.append(f"rig {duration(at.done_s)} of {duration(at.done_s + at.left_s)}")
        if wall_s is not None:
            words.append(f"{about(wall_s) if wall_s < FASTER * at.left_s else duration(at.left_s)} left")
    return ", ".join(words)


def _is_terminal(stream: TextIO | None) -> bool:
    """Return whether a stream is a terminal; None: the process was started without it."""
    return stream is not None and stream.isatty()
