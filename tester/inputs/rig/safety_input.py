"""A safety input of a rig file: a contact on any wire that must be closed, by the name of what it watches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Final, Literal

from tester.base.config_reader import LEFT_OUT
from tester.inputs.rig.key_classes import Held

CLOSED: Final = 1.0
"""Value of a channel whose contact is closed. Any other, and none, counts as open: so does a broken wire."""
_CONTACT: Final = Held("the contact: no run starts while it reads open, and the list before a start shows it")


@dataclass(frozen=True, slots=True)
class SafetyInput:
    """A contact: a channel of a further sensor or node, and what the rig does when it opens."""

    channel: Annotated[str, _CONTACT]
    reaction: Annotated[Literal["fast", "controlled"], _CONTACT] = "fast"
    """The stop that it begins."""
    open_at_rest: Annotated[bool, _CONTACT] = field(default=False, metadata=LEFT_OUT)
    """Whether it may be open while the drives have no power, as a door may."""


SafetyInputs = Mapping[str, SafetyInput]


def title_of_input(name: str) -> str:
    """Return the name of a safety input for people: that of its interlock."""
    return name.replace("_", " ")
