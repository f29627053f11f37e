"""The person who commissions: the interface of the user interfaces, and a step that walks with a person."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from drivers.ports import BusLost
from tester.machine.commission.commission_step import CommissionStep, Dialogue, Seat, Waits
from tester.machine.commission.record import RecordEntry
from tester.machine.prompts import Prompt, Prompts, Question


class Person:
    """The person who commissions: a terminal, a screen, or a script that reads a simulated rig.

    The engine calls every method in its own thread, between ticks; none may block.
    """

    time_stands: bool = True
    """Whether a simulated rig's time stops while this person thinks; a scripted person takes rig time."""
    scripted: bool = False
    """Whether the person is a script that reads a simulated rig: a recipe then mounts wheels and answers by itself."""

    def at(self, hands: Any) -> None:
        """Move to a rig with newly opened wires; ``hands``: the attendant of a simulated rig."""

    def message(self, text: str) -> None:
        """Show a message."""
        raise NotImplementedError

    def attend(self, prompts: Prompts) -> None:
        """Show the waiting question, and answer it once the answer is known."""
        raise NotImplementedError

    def commands(self) -> list[str]:
        """Return the commands that the person gave since the last call (tester.base.keys)."""
        return []

    def entered(self, entry: RecordEntry) -> None:
        """Receive an entry that was just recorded."""

    def look(self, step: CommissionStep, walk: Walk) -> None:
        """Show the rig's state in a step; called about every tester.machine.tickers.POLL_S of wall time."""


class Walk:
    """A seat and a procedure, ticked together (tester.machine.tickers.Ticked)."""

    def __init__(self, seat: Seat, procedure: Dialogue, person: Person) -> None:
        """Do nothing before the first tick."""
        self.seat = seat
        self.person = person
        self.ended = False
        """The procedure is over, successful or not."""
        self.error: Exception | None = None
        self.lost = ""
        """Why the bus is gone; "" while it works."""
        self._procedure = procedure
        self._prompts = Prompts(now_s=0.0)
        self._awaited: Waits | None = None
        self._prompt: Prompt | None = None

    @property
    def now_s(self) -> float:
        """Rig time, s."""
        return self._prompts.now_s

    @property
    def finished(self) -> bool:
        """Whether the rig is at rest, or can no longer be reached."""
        return bool(self.lost) or self.seat.finished

    @property
    def waiting(self) -> bool:
        """Whether simulated time stops while a person thinks."""
        asked = self._prompt is not None and self._prompt.answer is None and not self.ended and not self.finished
        return asked and self.person.time_stands and self.seat.ready

    def tick(self, now: float) -> float:
        """Tick the rig, then resume the procedure until it has to wait."""
        self._prompts.now_s = now
        try:
            due = self.seat.tick(now)
        except BusLost as lost:
            self.lost = str(lost)
            return now
        if self.seat.ready and not self.seat.finished and not self.ended:
            self._resume(now)
        return due

    def stop(self, why: str, *, fast: bool = False) -> None:
        """End the step: bring the rig to rest."""
        self.ended = True
        self.seat.stop(why, fast=fast)

    def _resume(self, now: float) -> None:
        """Resume the procedure until it waits for a condition that is not yet met."""
        try:
            if self._awaited is None:
                self._await(next(self._procedure))
            while not self.ended and (answer := self._answer(now)) is not None:
                self._await(self._procedure.send(answer))
        except StopIteration:
            self.stop("step done")
        except Exception as error:  # noqa: BLE001 - on any error the rig stops first; the error is raised again later
            self.error = error
            self.stop("step given up")

    def _await(self, awaited: Waits) -> None:
        self._awaited = awaited
        self._prompt = self._prompts.put(awaited) if isinstance(awaited, Question) else None

    def _answer(self, now: float) -> str | None:
        """Return the value to resume the procedure with; None while it has to wait."""
        if not isinstance(self._awaited, Question):
            return "" if self._awaited is not None and self._awaited(now) else None
        self.person.attend(self._prompts)
        return self._prompt.answer if self._prompt is not None else None


@dataclass(frozen=True, slots=True)
class CommissionPart:
    """A kind's steps in their order, and the person who does them on the simulated rig."""

    steps: tuple[CommissionStep, ...]
    compounds: tuple[str, ...]
    """Compounds that have a model of the expected coefficient; of any other only the name is known."""
    twin: Callable[[Callable[[str], None]], Person]
