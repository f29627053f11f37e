"""What a kind brings to be commissioned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from tester.machine.commission.person import Person
from tester.machine.commission.step import CommissionStep


class AtTheTwin(Person, Protocol):
    """A person who reads the truth of a simulated rig."""

    def at(self, hands: Any) -> None:
        """Stand at a rig whose wires were opened anew; ``hands``: the simulated rig."""
        ...


@dataclass(frozen=True, slots=True)
class CommissionPart:
    """The steps in their order, and the person who does them on the simulated rig."""

    steps: tuple[CommissionStep, ...]
    compounds: tuple[str, ...]
    """For these there is a model of what their coefficient is about; another has its own name only."""
    twin: Callable[[Callable[[str], None]], AtTheTwin]
