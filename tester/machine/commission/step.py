"""Steps of a commissioning as data, the rig as a step sees it, and the walk of one procedure between ticks."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import Any, Protocol

from tester.base.config_reader import as_tree
from tester.inputs.rig import Rig
from tester.machine.commission.person import AskPerson, Dialogue, Person
from tester.machine.ports import Ports


class Seat(Protocol):
    """A rig on its wires for one step: what a ticker drives, and what a procedure is handed."""

    @property
    def ready(self) -> bool:
        """The procedure may begin."""
        ...

    @property
    def finished(self) -> bool:
        """At rest, everything released."""
        ...

    @property
    def reason(self) -> str:
        """Why it ended by itself; "" where it was told to."""
        ...

    def tick(self, now: float) -> float:
        """Do what is due at ``now`` s; return when to be called again."""
        ...

    def stop(self, why: str, *, fast: bool = False) -> None:
        """Bring everything to standstill, power off; idempotent."""
        ...

    def abandon(self) -> None:
        """Send what is safe once: nobody ticks after this."""
        ...


@dataclass(slots=True)
class Notes:
    """What a procedure leaves: told to the person, and on record."""

    tell: Callable[[str], None]
    read: Callable[[str, Mapping[str, Any]], object]
    """Put a reading on record at once."""
    done: Mapping[str, Mapping[str, Any]]
    """Values of the steps that stand, by step."""
    given: Mapping[str, str] = field(default_factory=dict[str, str])
    """What the command line has said already, by the key of the question."""
    values: dict[str, Any] = field(default_factory=dict[str, Any])
    """Of the entry by which the step passes."""
    text: str = ""


@dataclass(frozen=True, slots=True)
class StepReading:
    """What the rig shows at present, for a person: ``value`` in ``unit``, NaN where there is none; ``words`` beside."""

    label: str
    value: float
    unit: str
    decimals: int
    words: str = ""


@dataclass(frozen=True, slots=True)
class Alone:
    """What a step without a seat may use."""

    rig: Rig
    person: Person
    run_recipe: Callable[[str, str], Mapping[str, Any]]
    """Run a recipe (its name and text) on the rig as a run like any other; return its results as plain data. Raises
    StepRefused where it did not go through."""


@dataclass(frozen=True, slots=True)
class CommissionStep:
    """One step. ``sections``: dotted keys of the rig file on which its result depends; a change of them undoes it.

    ``needs``: steps whose results it takes. Of ``seat`` and ``alone`` one: whether it has the rig on its wires, or
    runs a recipe or nothing. ``readings``: from a seat, what a person wants to see meanwhile; looks only.
    """

    name: str
    title: str
    sections: tuple[str, ...]
    needs: tuple[str, ...] = ()
    seat: Callable[[Any, Ports, Any], Any] | None = None
    """From rig, wires and the hands at the rig."""
    procedure: Callable[[Any, Notes], Dialogue] | None = None
    alone: Callable[[Alone, Notes], None] | None = None
    readings: Callable[[Any], Sequence[StepReading]] | None = None


def sections_sha256(rig: Rig, sections: tuple[str, ...]) -> str:
    """Return the hash of what stands in a rig file under some dotted keys; what is not there counts as nothing."""
    tree = as_tree(rig)
    found = {key: _at(tree, key.split(".")) for key in sections}
    text = json.dumps(found, sort_keys=True, ensure_ascii=False, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def _at(tree: object, keys: list[str]) -> object:
    for key in keys:
        if not isinstance(tree, Mapping):
            return None
        here: Mapping[str, object] = tree  # pyright: ignore[reportUnknownVariableType]
        tree = here.get(key)
    return tree


class Walk:
    """A seat and a procedure, ticked together (tester.machine.tickers.Ticked)."""

    def __init__(self, seat: Seat, procedure: Dialogue, person: Person) -> None:
        """Nothing happens before the first tick."""
        self.seat = seat
        self.person = person
        self.ended = False
        """The procedure came to its end, or gave up."""
        self.error: Exception | None = None
        self.now_s = 0.0
        self._procedure = procedure
        self._awaited: Any = None
        self._begun = False

    @property
    def finished(self) -> bool:
        """The rig is at rest."""
        return self.seat.finished

    @property
    def waiting(self) -> bool:
        """Simulated time stands still while a person thinks."""
        asked = isinstance(self._awaited, AskPerson) and not self.ended and not self.seat.finished
        return asked and self.person.time_stands and self.seat.ready and self.person.taken(inf) is None

    def tick(self, now: float) -> float:
        """Tick the rig, then go on with the procedure as far as it goes."""
        self.now_s = now
        due = self.seat.tick(now)
        if self.seat.ready and not self.seat.finished and not self.ended:
            self._go_on(now)
        return due

    def stop(self, why: str, *, fast: bool = False) -> None:
        """Give the step up."""
        self.ended = True
        self.seat.stop(why, fast=fast)

    def _go_on(self, now: float) -> None:
        """Wake the procedure for as long as what it waits for is there already."""
        try:
            if not self._begun:
                self._begun = True
                self._await(next(self._procedure))
            while not self.ended and (answer := self._answer(now)) is not None:
                self._await(self._procedure.send(answer))
        except StopIteration:
            self._end("step done")
        except Exception as error:  # noqa: BLE001 - whatever a procedure raises, the rig is stopped first; raised again later
            self.error = error
            self._end("step given up")

    def _await(self, awaited: Any) -> None:
        self._awaited = awaited
        if isinstance(awaited, AskPerson):
            self.person.put(awaited.question)

    def _answer(self, now: float) -> str | None:
        """Return what the procedure is woken with; None while it has to wait."""
        if not isinstance(self._awaited, AskPerson):
            return "" if self._awaited(now) else None
        answer = self.person.taken(now)
        if answer is None:
            return None
        refusal = self._awaited.question.refusal(answer)
        if refusal:
            self.person.tell(refusal)
            self.person.put(self._awaited.question)
            return None
        return answer

    def _end(self, why: str) -> None:
        self.ended = True
        self.seat.stop(why)
