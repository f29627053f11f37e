"""A step of commissioning, and the parts that a kind supplies for it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from drivers.ports import BusLost
from tester.base.config_reader import as_tree
from tester.inputs.rig import Rig
from tester.machine.commission.person import Dialogue, Person, Waits
from tester.machine.prompts import Prompt, Prompts, Question
from tester.machine.rig_ports import Ports


class Seat(Protocol):
    """A rig on its wires for one step. A ticker ticks it, and a procedure uses it."""

    @property
    def ready(self) -> bool:
        """Whether the procedure may begin."""
        ...

    @property
    def finished(self) -> bool:
        """Whether everything is at rest and released."""
        ...

    @property
    def reason(self) -> str:
        """Why the seat ended by itself; "" if it ended on request."""
        ...

    def tick(self, now: float) -> float:
        """Do everything due at ``now`` s; return the time of the next call. Raises BusLost."""
        ...

    def stop(self, why: str, *, fast: bool = False) -> None:
        """Bring everything to standstill, power off; idempotent."""
        ...

    def abandon(self) -> None:
        """Send a safe state once; no tick follows."""
        ...


@dataclass(slots=True)
class Notes:
    """A procedure's output: messages to the person, and entries for the record."""

    tell: Callable[[str], None]
    read: Callable[[str, Mapping[str, Any]], object]
    """Records a reading at once."""
    done: Mapping[str, Mapping[str, Any]]
    """Values that the finished steps recorded, by step."""
    given: Mapping[str, str] = field(default_factory=dict[str, str])
    """Answers from the command line, by the question's key."""
    values: dict[str, Any] = field(default_factory=dict[str, Any])
    """Values to store in the entry that records the step's success."""
    text: str = ""


@dataclass(frozen=True, slots=True)
class StepReading:
    """A present reading of the rig, shown to a person: ``value`` in ``unit`` (NaN if it has no number), and text in
    ``words``.
    """

    label: str
    value: float
    unit: str
    decimals: int
    words: str = ""


RunRecipe = Callable[[str, str], Mapping[str, Any]]
"""Run a recipe (its name and text) on the rig as an ordinary run; return its results as plain data.

Raises StepRefused if it did not complete.
"""


@dataclass(frozen=True, slots=True)
class CommissionStep:
    """One step. ``sections``: dotted keys of the rig file that its result depends on; a change of them invalidates it.

    ``needs``: steps whose results it uses. Either ``seat`` or ``alone`` is set: with ``seat`` the step uses the rig on
    its wires; with ``alone`` it runs a recipe or uses no rig. ``readings``: returns values for the person from a seat,
    and changes nothing.
    """

    name: str
    title: str
    sections: tuple[str, ...]
    needs: tuple[str, ...] = ()
    seat: Callable[[Any, Ports, Any], Any] | None = None
    """Makes a seat from the rig, its wires and the attendant."""
    procedure: Callable[[Any, Notes], Dialogue] | None = None
    alone: Callable[[Rig, RunRecipe, Notes], None] | None = None
    readings: Callable[[Any], Sequence[StepReading]] | None = None


def sections_sha256(rig: Rig, sections: tuple[str, ...]) -> str:
    """Return the hash of a rig file's content under some dotted keys; missing keys are left out."""
    tree = as_tree(rig)
    sections_found = {key: _at(tree, key.split(".")) for key in sections}
    text = json.dumps(sections_found, sort_keys=True, ensure_ascii=False, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def _at(tree: object, keys: list[str]) -> object:
    for key in keys:
        if not isinstance(tree, Mapping):
            return None
        section: Mapping[str, object] = tree  # pyright: ignore[reportUnknownVariableType]
        tree = section.get(key)
    return tree


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
