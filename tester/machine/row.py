"""A row of the interlock table: one object with its condition, its delay and its reaction.

``tester.machine.watches`` makes the watch of a row. This module is not compiled, because mypyc cannot compile a
dataclass of a generic class; the functions of the rows, which a scan calls, are compiled.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from math import nan
from typing import Any, Final, Generic, TypeVar

from tester.inputs.rig.parameter import Parameter, Values

V = TypeVar("V", contravariant=True)
"""Type of the kind's inputs that its rows read: a class that inherits from ``ScanInputs``."""



@dataclass(frozen=True, slots=True)
class Compared:
    """A number beyond its limit, as a trip records it. NaN where it is unknown, or where the row watches a state."""

    value: float
    limit: float
    unit: str


NOTHING_COMPARED: Final = Compared(nan, nan, "")


class Reaction(Enum):
    """The consequence of a condition that has held for its delay, from the mildest to the most severe."""

    WARN = "warning"
    """Record an event in the journal, and stop nothing."""
    REFUSE = "neither armed nor acknowledged"
    """Nothing is left to stop; nothing may begin."""
    CONTROLLED = "controlled stop"
    FAST = "fast stop"
    POWER_OFF = "power off"
    """Switch every power stage off, because a fast stop has failed."""
    EMERGENCY = "emergency stop mirrored"


class When(Enum):
    """The scans in which a row is evaluated; the row's condition need not test for this again."""

    ALWAYS = "always"
    LOADED = "loaded"
    """Contact is wanted or cannot be excluded, and the run's drives are not off."""
    SELDOM = "seldom"
    """After a change of ``ScanInputs.seldom``: the row reads nothing else, and no time."""
    ENDING = "ending"
    """A stop or a hold is under way, everything should be at rest, or a run has its drives off."""


WARN: Final = Reaction.WARN
CONTROLLED: Final = Reaction.CONTROLLED
FAST: Final = Reaction.FAST
REFUSE: Final = Reaction.REFUSE
POWER_OFF: Final = Reaction.POWER_OFF
EMERGENCY: Final = Reaction.EMERGENCY

ALWAYS: Final = When.ALWAYS
LOADED: Final = When.LOADED
SELDOM: Final = When.SELDOM
ENDING: Final = When.ENDING

ACK: Final = "cause gone, acknowledged"
REPAIR: Final = "repaired, acknowledged"


class Form(Enum):
    """How a row compares its number."""

    STATE = "state"
    AT_MOST = "at most"
    AT_LEAST = "at least"
    WITHIN = "within"


@dataclass(frozen=True, slots=True)
class Watch(Generic[V]):
    """What a row watches. ``at_most``, ``at_least``, ``within`` and ``condition`` make it."""

    level: str
    """The condition in words, for the safety page; names such as ``stale_cell`` are keys of the rig file's section."""
    holds: Callable[[V], bool]
    compared: Callable[[V], Compared]
    """Returns the value and limit of a trip, for the record; called when the row trips."""
    parameters: tuple[Parameter, ...] = ()
    """The limit, if it is a parameter."""
    form: Form = Form.STATE
    parts: tuple[Callable[[V], Any], ...] = ()
    """The functions from which ``holds`` is made: number and limit, or the span. The table compares their values
    without a call of ``holds``.
    """
    limit: Parameter | float | None = None
    """The limit, if it is a parameter or a constant; None where the inputs determine it."""

    def fixed(self, values: Values) -> float | None:
        """Return the value of such a limit on a rig, None where the inputs determine it."""
        return values[self.limit] if isinstance(self.limit, Parameter) else self.limit


@dataclass(frozen=True, slots=True)
class Interlock(Generic[V]):
    """One row of the table. The default reaction and reset are the strict ones."""

    name: str
    cause: str
    """Text for the operator when it trips."""
    watch: Watch[V]
    reaction: Reaction = FAST
    reset: str = REPAIR
    """Condition that must be met before the next run may begin."""
    parameters: tuple[Parameter, ...] = ()
    """Parameters that the row uses besides the limit of its watch, in the order of the rig file (the limit may be among
    them, to fix its place). A parameter of several rows appears once in the section, with the first of these rows.
    """
    applies: Callable[[V], bool] | None = None
    """Whether the row applies in a scan; None: always. It may be called before or after the condition."""
    delay: Parameter | None = None
    """How long the row must hold before it trips; None: it trips in its first scan."""
    channels: tuple[str, ...] = ()
    """Channels of further sensors that the row reads (``ScanInputs.further``), by their names in the record. A rig file
    without one of these sensors is refused.
    """
    when: When = ALWAYS
    unseen: Callable[[V], bool] | bool = False
    """Whether the cause is still present, for a row that applies only while something is wanted (drives, load, heat).
    Called before a trip of this row is acknowledged. True: use the row's watch, whether or not the row applies.
    """
    at_rest: Callable[[V], bool] | None = None
    """Whether the row also trips at rest, where nothing is left to stop but some power can be switched off."""
    ends_lease: bool = False
    """Whether a trip leaves a device that is still on to its lease: its setpoint is then no longer renewed."""

    def holds(self, v: V) -> bool:
        """Return whether the row holds in a scan."""
        return self.watch.holds(v) and (self.applies is None or self.applies(v))

    def still_there(self) -> Callable[[V], bool] | None:
        """Return the function with which an acknowledgement tests the row's cause; None: it only tests whether the row
        holds.
        """
        return self.unseen if callable(self.unseen) else self.watch.holds if self.unseen else None

    def delay_s(self, values: Values) -> float:
        """Return how long the row must hold on a rig, s."""
        return values[self.delay] if self.delay is not None else 0.0

    def declared(self) -> tuple[Parameter, ...]:
        """Return every parameter of the row: its limit first unless ``parameters`` contains it, its delay last."""
        limit = tuple(one for one in self.watch.parameters if one not in self.parameters)
        return (*limit, *self.parameters, *([self.delay] if self.delay is not None else []))


def always(_: Any) -> bool:
    """Return True: the row applies in every scan."""
    return True
