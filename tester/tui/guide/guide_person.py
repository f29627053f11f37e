"""The person at the screen, for the engine: passes questions, answers and commands between two threads."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import inf
from queue import Empty, SimpleQueue
from threading import Lock
from typing import Final

from tester.base import clock
from tester.base.keys import FAST_STOP, STOP
from tester.machine.commission.commission_step import CommissionStep, StepReading, Walk
from tester.machine.commission.person import Question
from tester.machine.commission.record import RecordEntry

KEPT: Final = 500
"""Number of messages kept."""
LOOK_S: Final = 0.2
"""Period of readings, s of wall time."""


@dataclass(frozen=True, slots=True)
class Live:
    """The step that uses the rig: its name, its rig time, s, and the rig's readings."""

    step: str
    now_s: float
    readings: tuple[StepReading, ...]


class ScreenPerson:
    """A person for the engine (tester.machine.commission.person.Person) who also looks on (Onlooker)."""

    def __init__(self, *, time_stands: bool) -> None:
        """``time_stands``: true for a rig simulated in this process."""
        self.time_stands = time_stands
        self.said: deque[str] = deque(maxlen=KEPT)
        self.entries: deque[RecordEntry] = deque()
        """Recorded entries that are not shown yet."""
        self.live: Live | None = None
        self._lock = Lock()
        self._question: Question | None = None
        self._answer: str | None = None
        self._commands: SimpleQueue[str] = SimpleQueue()
        self._looked_s = -inf

    # -- the engine's side ------------------------------------------------------------------------------------

    def tell(self, text: str) -> None:
        """Show a message."""
        self.said.append(text)

    def put(self, question: Question) -> None:
        """Ask a question; the one before is answered or withdrawn."""
        with self._lock:
            self._question, self._answer = question, None

    def taken(self, now_s: float) -> str | None:
        """Return the answer; while a rig runs (``now_s`` finite), also remove it."""
        with self._lock:
            answer = self._answer
            if answer is not None and now_s < inf:
                self._answer = self._question = None
            return answer

    def poll(self) -> list[str]:
        """Return the commands since the last call."""
        commands: list[str] = []
        while True:
            try:
                commands.append(self._commands.get_nowait())
            except Empty:
                return commands

    def entered(self, entry: RecordEntry) -> None:
        """Note a recorded entry."""
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
        with self._lock:
            return self._question if self._answer is None else None

    def answer(self, question: Question, text: str) -> bool:
        """Answer a question; return False if it no longer waits."""
        with self._lock:
            if self._question is not question or self._answer is not None:
                return False
            self._answer = text
            return True

    def press(self, *, fast: bool = False) -> None:
        """STOP, from any thread; pressing again has no further effect."""
        self._commands.put((FAST_STOP if fast else STOP).command)

    def command(self, command: str) -> None:
        """Give another command (tester.base.keys)."""
        self._commands.put(command)

    def begin(self) -> None:
        """Discard questions and commands of an engine that has ended."""
        self.poll()
        self.live = None
        with self._lock:
            self._question = self._answer = None

    def end(self) -> None:
        """Called when the engine ends. Pending questions are dropped."""
        with self._lock:
            self._question = self._answer = None
        self.live = None
