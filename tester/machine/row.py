"""A row of the interlock table: one object with what is watched, for how long, and what follows.

``tester.machine.watches`` makes what a row watches. This module is not compiled: mypyc makes no dataclass of a generic
class. A scan calls the functions of the rows, which are.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from math import nan
from typing import Any, Final, Generic, TypeVar

from tester.inputs.rig.parameter import Parameter, Values

V = TypeVar("V", contravariant=True)
"""What the kind's rows look at: a class that inherits from ``ScanInputs``."""



@dataclass(frozen=True, slots=True)
class Compared:
    """A number beyond its limit, as a trip records it. NaN where it is not known, or where the row watches a state."""

    value: float
    limit: float
    unit: str


NOTHING_COMPARED: Final = Compared(nan, nan, "")


class Reaction(Enum):
    """The consequence of a condition that has held for its delay, from the mildest to the hardest."""

    WARN = "warning"
    """An event in the journal."""
    REFUSE = "neither armed nor acknowledged"
    """Nothing is left to stop; nothing may begin."""
    CONTROLLED = "controlled stop"
    FAST = "fast stop"
    POWER_OFF = "power off"
    """A fast stop that has not worked: every power stage off."""
    EMERGENCY = "emergency stop mirrored"


class When(Enum):
    """The scans in which a row is evaluated; its condition need not test for that again."""

    ALWAYS = "always"
    LOADED = "loaded"
    """Contact is wanted or cannot be excluded, and the drives of a run are not off."""
    ENDING = "ending"
    """A stop or a hold is under way, everything is to rest, or a run has its drives off."""


WARN: Final = Reaction.WARN
CONTROLLED: Final = Reaction.CONTROLLED
FAST: Final = Reaction.FAST
REFUSE: Final = Reaction.REFUSE
POWER_OFF: Final = Reaction.POWER_OFF
EMERGENCY: Final = Reaction.EMERGENCY

ALWAYS: Final = When.ALWAYS
LOADED: Final = When.LOADED
ENDING: Final = When.ENDING

ACK: Final = "cause gone, acknowledged"
REPAIR: Final = "repaired, acknowledged"


class Form(Enum):
    """The comparison of a row's number."""

    STATE = "state"
    AT_MOST = "at most"
    AT_LEAST = "at least"
    WITHIN = "within"


@dataclass(frozen=True, slots=True)
class Watch(Generic[V]):
    """What a row watches: made by ``at_most``, ``at_least``, ``within`` and ``condition``."""

    level: str
    """In words for the safety page; names such as ``stale_cell`` are keys of the rig file's section."""
    holds: Callable[[V], bool]
    compared: Callable[[V], Compared]
    """Value and limit of a trip, for the record; called when the row trips."""
    parameters: tuple[Parameter, ...] = ()
    """The limit, where it is a parameter."""
    form: Form = Form.STATE
    parts: tuple[Callable[[V], Any], ...] = ()
    """What ``holds`` is made of: number and limit, or the span. The table compares them without a call of ``holds``."""


@dataclass(frozen=True, slots=True)
class Interlock(Generic[V]):
    """One row. Where it does not say otherwise, its reaction and its reset are the strict ones."""

    name: str
    cause: str
    """Text for the operator when it trips."""
    watch: Watch[V]
    reaction: Reaction = FAST
    reset: str = REPAIR
    """Condition for the next run to begin."""
    parameters: tuple[Parameter, ...] = ()
    """What the row compares with beside the limit of its watch, in the order of the rig file (which may name the limit
    too, to place it); a parameter that several rows use is listed once in the section, with the first of them."""
    applies: Callable[[V], bool] | None = None
    """Whether the row applies in a scan, called only where the watch is beyond its limit. None: always."""
    delay: Parameter | None = None
    """How long the row must hold; None: it trips in its first scan."""
    channels: tuple[str, ...] = ()
    """Channels of further sensors that the row looks at (``ScanInputs.further``), by their names in the record. A rig
    file without such a sensor is refused."""
    when: When = ALWAYS
    unseen: Callable[[V], bool] | bool = False
    """For a row that is watched only while something is wanted (drives, load, heat): is its cause still there? Called
    before a trip of this row is acknowledged. True: its watch, whether or not the row applies."""
    at_rest: Callable[[V], bool] | None = None
    """Whether the row also trips in idle: nothing is left to stop then, but some power to take off."""
    ends_lease: bool = False
    """A device that is still on when it trips is left to its lease: its setpoint is not renewed any more."""

    def holds(self, v: V) -> bool:
        """Return whether the row holds in a scan."""
        return self.watch.holds(v) and (self.applies is None or self.applies(v))

    def still_there(self) -> Callable[[V], bool] | None:
        """Return what an acknowledgement asks of the row's cause; None: only whether the row holds."""
        return self.unseen if callable(self.unseen) else self.watch.holds if self.unseen else None

    def delay_s(self, values: Values) -> float:
        """Return how long the row must hold on a rig, s."""
        return values[self.delay] if self.delay is not None else 0.0

    def declared(self) -> tuple[Parameter, ...]:
        """Return every parameter of the row: its limit first where ``parameters`` has it nowhere, its delay last."""
        limit = tuple(one for one in self.watch.parameters if one not in self.parameters)
        return (*limit, *self.parameters, *([self.delay] if self.delay is not None else []))


def always(_: Any) -> bool:
    """Hold."""
    return True
