"""A row of the interlock table: one object that says what is watched, for how long, and what follows.

A condition is a plain function over the kind's inputs, evaluated in every scan in which it can apply (``When``). It is
written so that NaN and missing data fall on the tripped side: ``not (x <= limit)``, never ``x > limit``. It changes
nothing and may be asked more than once in a scan. A condition that has held for the row's delay trips.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from math import nan
from typing import Any, Final, TypeAlias

from tester.inputs.rig.parameter import Parameter, Values

Condition: TypeAlias = Callable[[Any], bool]
"""Over what the kind's rows look at: a class that inherits from ``ScanInputs``."""


@dataclass(frozen=True, slots=True)
class Compared:
    """What a row has found beyond its limit, as a person is told it. NaN where it is not known, or no one number."""

    value: float
    limit: float
    unit: str


NOTHING_COMPARED: Final = Compared(nan, nan, "")


class Reaction(Enum):
    """What a condition leads to that has held for its delay. From the mildest to the hardest."""

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
    """In which scans a row is evaluated; its condition need not ask for that again."""

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


@dataclass(frozen=True, slots=True)
class Interlock:
    """One row."""

    name: str
    cause: str
    """What an operator reads when it trips."""
    level: str
    """The condition in words for docs/safety.md; names such as ``stale_cell`` are keys of the rig file's section."""
    condition: Condition
    reaction: Reaction
    reset: str
    """What has to be the case before a run may begin again."""
    parameters: tuple[Parameter, ...] = ()
    """What the condition compares with, in the order of the rig file; a parameter that several rows use stands in the
    section once, with the first of them."""
    delay: Parameter | None = None
    """How long the condition must hold; None: it trips in its first scan."""
    channels: tuple[str, ...] = ()
    """Channels of further sensors that the condition looks at (``ScanInputs.further``), by their names in the record. A
    rig file without such a sensor is refused."""
    when: When = ALWAYS
    compared: Callable[[Any], Compared] | None = None
    """Value and limit of a trip, for the record; asked when the row trips. None: what it looks at is no number."""
    unseen: Condition | None = None
    """For a condition that is only looked at while something is wanted (drives, load, heat): is its cause still there?
    Asked before a trip of this row is acknowledged."""
    at_rest: Condition | None = None
    """Tells whether the row trips in idle, too: nothing is left to stop then, but something to take the power off."""
    ends_lease: bool = False
    """A device that is still on when it trips is left to its lease: its setpoint is not renewed any more."""

    def delay_s(self, values: Values) -> float:
        """Return how long the condition must hold on a rig, s."""
        return values[self.delay] if self.delay is not None else 0.0

    def declared(self) -> tuple[Parameter, ...]:
        """Return every parameter of the row, its delay last."""
        return self.parameters if self.delay is None else (*self.parameters, self.delay)


def always(_: Any) -> bool:
    """Hold."""
    return True
