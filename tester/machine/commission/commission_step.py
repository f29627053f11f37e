"""A step of commissioning: what a procedure can ask a person, and the parts that a kind supplies for a step."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, isfinite, nan
from statistics import fmean
from typing import Any, Protocol

from tester.base.config_reader import as_tree
from tester.inputs.rig import Rig
from tester.machine.prompts import GO, Asks, Question
from tester.machine.rig_ports import Ports


class StepRefused(Exception):  # noqa: N818 - a finding for a person
    """A step does not pass. The text gives the finding and the remedy, for people and for the record."""

    again: object = None
    """The stage from which to measure again (tester.machine.commission.stages); None: the last one."""


class StepLeft(StepRefused):
    """A person leaves a step."""


Until = Callable[[float], bool]
"""A condition to wait for: called once a tick with rig time, s."""
Waits = Question | Until
"""What a procedure can wait for: a valid answer, or a condition."""
Dialogue = Generator[Waits, str, None]
Measured = Generator[Waits, str, float]


def choose(key: str, text: str, *choices: str) -> Generator[Waits, str, str]:
    """Ask for one of several words."""
    return (yield Question(key, text, Asks.CHOICE, choices))


def measure(key: str, text: str, unit: str) -> Measured:
    """Ask for a quantity; return it in ``unit``."""
    question = Question(key, text, Asks.QUANTITY, unit=unit)
    return question.value((yield question))


def line(key: str, text: str) -> Generator[Waits, str, str]:
    """Ask for a line of text."""
    return (yield Question(key, text, Asks.TEXT))


def press(key: str, text: str, guarded: Callable[[], bool] = lambda: True) -> Dialogue:
    """Ask for the word that starts a motion; ask again while ``guarded`` reports that guard or safety chain is open.

    Raises StepLeft if the answer is "no".
    """
    asked = text
    while (yield Question(key, asked, Asks.KEY)) == GO:
        if guarded():
            return
        asked = f"the guard or the safety chain is open: close it, and again; {text}"
    raise StepLeft(f"left by the person at: {asked}")


def wait(seconds: float) -> Dialogue:
    """Wait for some seconds of rig time."""
    until_s = inf

    def over(now_s: float) -> bool:
        nonlocal until_s
        until_s = min(until_s, now_s + seconds)
        return now_s >= until_s - 1e-9

    yield over


def mean_of(reading: Callable[[], float], seconds: float) -> Generator[Waits, str, float]:
    """Wait for some seconds of rig time; return the mean of the valid readings, NaN where there was none."""
    values, until_s = list[float](), inf

    def over(now_s: float) -> bool:
        nonlocal until_s
        until_s = min(until_s, now_s + seconds)
        value = reading()
        if isfinite(value):
            values.append(value)
        return now_s >= until_s - 1e-9

    yield over
    return fmean(values) if values else nan


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
    required: bool = False
    """Whether a run on a real rig needs it on record: a wrong scale may harm before anything else contradicts it."""


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
