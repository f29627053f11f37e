"""A kind's part for commissioning."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from tester.machine.commission.person import Person
from tester.machine.commission.step import CommissionStep


class AtTheTwin(Person, Protocol):
    """A person who reads the true values of a simulated rig."""

    def at(self, hands: Any) -> None:
        """Move to a rig with newly opened wires; ``hands``: the simulated rig."""
        ...


@dataclass(frozen=True, slots=True)
class CommissionPart:
    """The steps in their order, and the person who does them on the simulated rig."""

    steps: tuple[CommissionStep, ...]
    compounds: tuple[str, ...]
    """Compounds with a model for the expected coefficient; any other is only a name."""
    twin: Callable[[Callable[[str], None]], AtTheTwin]
