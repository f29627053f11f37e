"""An item of the queue: a recipe, frozen when a person adds it, and what it ran into. Plain data that JSON holds."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from tester.base.units import UnitError, parse
from tester.base.words import rough_duration

MOST_COPIES = 50
"""Most copies of an item that are added at once [A]."""
LEAST_WAIT_S, MOST_WAIT_S = 60.0, 604_800.0
"""Limits of a question's time, s [A]: a person can be called and come; no item blocks a rig for more than a week."""


class End(StrEnum):
    """How an item ended."""

    DONE = "done"
    SHORT = "short"
    """The run completed its plan, and at least one condition has no trustworthy value."""
    FAILED = "failed"
    TRIPPED = "tripped"
    STOPPED = "stopped"


GO_ON = (End.DONE, End.SHORT)
"""Ends after which the next item begins, if the item does not choose otherwise."""
MAY_GO_ON = (End.DONE, End.SHORT, End.FAILED)
"""Ends that an item may choose to go on after. A trip, and a stop by a person, always make the queue stand."""


class ItemState(StrEnum):
    """State of an item."""

    WAITING = "waiting"
    SKIPPED = "skipped"
    """A person passed over it: it stays in the list and does not run until it is moved."""
    STARTING = "starting"
    """Its start is on record; its run has no folder yet."""
    RUNNING = "running"
    ENDED = "ended"
    DROPPED = "dropped"

    @property
    def under_way(self) -> bool:
        """Return whether the rig belongs to the item."""
        return self in (ItemState.STARTING, ItemState.RUNNING)

    @property
    def over(self) -> bool:
        """Return whether nothing more happens to the item."""
        return self in (ItemState.ENDED, ItemState.DROPPED)


@dataclass(frozen=True, slots=True)
class Hashes:
    """SHA-256, hexadecimal, of what a run of the item depends on beside its recipe.

    ``materials``: role with name, and hash; "" where no file describes the name.
    """

    rig: str
    calibration: str
    materials: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class PersonAsk:
    """A question that an item asks a person, ``at_s`` seconds of rig time after its start."""

    at_s: float
    text: str


@dataclass(frozen=True, slots=True)
class Needs:
    """What an item takes, by its plan. Times in s of rig time; 95 % of runs take ``low_s`` to ``high_s``.

    ``bytes``: disk space of the record; ``worn_mm``: wear over all specimens.
    """

    seconds: float
    low_s: float
    high_s: float
    conditions: int
    bytes: int
    worn_mm: float = 0.0
    specimens: int = 1
    asks: tuple[PersonAsk, ...] = ()


@dataclass(frozen=True, slots=True)
class Unanswered:
    """An item is stopped in a controlled way once a question has waited for ``within_s``, s of wall time.

    ``skip``: then the queue continues if the next item asks nothing of a person; otherwise it waits for a person.
    """

    within_s: float
    skip: bool = False

    def words(self) -> str:
        """Return it in words."""
        return f"stopped after {rough_duration(self.within_s)} without an answer"


def wait_typed(text: str) -> float:
    """Return the time for which a question waits, s, of a text such as ``2 h``; raises ValueError."""
    try:
        within_s = parse(text, "s")
    except UnitError as error:
        raise ValueError(str(error)) from error
    if not LEAST_WAIT_S <= within_s <= MOST_WAIT_S:
        raise ValueError(f"expected 1 min to 7 days, so that a person can be called, got {text}")
    return within_s


@dataclass(frozen=True, slots=True)
class QueueItem:
    """A frozen recipe with its options. ``id`` counts from 1 and is used once.

    ``origin``: where the recipe was read, whose folder is searched for materials; "" for a text. ``rig``: the rig's
    name. ``speed``: rig seconds per second of a simulated rig, None = as fast as possible. ``yes``: prompts are
    answered without a person, on a simulated rig only. ``by``: who added it. ``after``: ends after which the queue
    continues. ``unanswered``: what ends a question that a person does not answer; None: it waits as long as it takes.
    """

    id: int
    name: str
    recipe: str
    sha256: str
    origin: str
    rig: str
    simulated: bool
    hashes: Hashes
    needs: Needs
    by: str
    utc: str
    overrides: tuple[str, ...] = ()
    seed: int = 0
    speed: float | None = 1.0
    yes: bool = False
    operator: str = ""
    notes: str = ""
    after: tuple[End, ...] = GO_ON
    unanswered: Unanswered | None = None
