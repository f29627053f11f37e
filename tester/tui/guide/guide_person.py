"""The person at the screen, as the engine sees the person: passes questions, answers and commands between two
threads.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import inf
from queue import Empty, SimpleQueue
from typing import Final

from tester.base import clock
from tester.base.keys import FAST_STOP, STOP
from tester.machine.commission.commission_step import CommissionStep, StepReading
from tester.machine.commission.person import Person, Walk
from tester.machine.commission.record import RecordEntry
from tester.machine.prompts import Prompt, Prompts, Question

KEPT: Final = 500
"""Number of messages kept."""
LOOK_S: Final = 0.2
"""Period of updating the readings, s of wall time."""


@dataclass(frozen=True, slots=True)
class Live:
    """The step that is using the rig: its name, its rig time, s, and the rig's readings."""

    step: str
    now_s: float
    readings: tuple[StepReading, ...]


class ScreenPerson(Person):
    """The person at the screen: questions, answers, commands and readings pass between the two threads."""

    def __init__(self, *, time_stands: bool) -> None:
        """``time_stands``: whether rig time stops while a person thinks; true for a rig simulated in this process."""
        self.time_stands = time_stands
        self.messages: deque[str] = deque(maxlen=KEPT)
        self.entries: deque[RecordEntry] = deque()
        """Recorded entries that the screen has not shown yet."""
        self.live: Live | None = None
        self._prompt: Prompt | None = None
        self._commands: SimpleQueue[str] = SimpleQueue()
        self._looked_s = -inf

    # -- the engine's side ------------------------------------------------------------------------------------

    def message(self, text: str) -> None:
        self.messages.append(text)

    def attend(self, prompts: Prompts) -> None:
        self._prompt = prompts.waiting

    def commands(self) -> list[str]:
        commands: list[str] = []
        while True:
            try:
                commands.append(self._commands.get_nowait())
            except Empty:
                return commands

    def entered(self, entry: RecordEntry) -> None:
        self.entries.append(entry)

    def look(self, step: CommissionStep, walk: Walk) -> None:
        """Update the readings, at most every ``LOOK_S``."""
        wall_s = clock.monotonic()
        if wall_s - self._looked_s < LOOK_S and self.live is not None and self.live.step == step.name:
            return
        self._looked_s = wall_s
        readings = tuple(step.readings(walk.seat)) if step.readings is not None and walk.seat.ready else ()
        self.live = Live(step.name, walk.now_s, readings)

    # -- the screen's side ------------------------------------------------------------------------------------

    @property
    def asked(self) -> Question | None:
        """Return the question that waits for an answer."""
        prompt = self._prompt
        return prompt.question if prompt is not None and prompt.answer is None else None

    def answer(self, question: Question, text: str) -> bool:
        """Answer a question; return False if the question no longer waits or refuses the text."""
        prompt = self._prompt
        waits = prompt is not None and prompt.question is question and prompt.answer is None
        return waits and prompt is not None and not prompt.reply(text)

    def press(self, *, fast: bool = False) -> None:
        """STOP, from any thread; pressing again has no further effect."""
        self.command((FAST_STOP if fast else STOP).command)

    def command(self, command: str) -> None:
        """Pass another command to the engine (tester.base.keys)."""
        self._commands.put(command)

    def begin(self) -> None:
        """Discard questions and commands of an engine that has ended."""
        self.commands()
        self.end()

    def end(self) -> None:
        """Drop waiting questions; called when the engine ends."""
        self._prompt = None
        self.live = None
