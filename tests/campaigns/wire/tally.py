"""The results of spoiled frames, and the loop that spoils and counts them."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from tests.campaigns.acceptance.figure import Figure, at_least, equal


@dataclass
class Tally:
    """Counts of one wire; ``kinds``: how often each spoiling was done."""

    frames: int = 0
    accepted: int = 0
    wrong: int = 0
    exceptions: int = 0
    kinds: Counter[str] = field(default_factory=Counter[str])
    first: str = ""
    """The first failure, to reproduce it."""

    def blame(self, what: str) -> None:
        """Store the first failure."""
        self.first = self.first or what


def spoiled(name: str, wire: Callable[[random.Random, Tally], None], count: int, seed: int) -> Iterator[Figure]:
    """Spoil ``count`` frames of a wire; yield its figures."""
    source, tally = random.Random(f"{seed} {name}"), Tally()
    while tally.frames < count:
        tally.frames += 1
        try:
            wire(source, tally)
        except Exception as error:  # noqa: BLE001 - the figure counts any exception
            tally.exceptions += 1
            tally.blame(f"frame {tally.frames}: {type(error).__name__}: {error}")
    if tally.first:
        print(f"     {name}: {tally.first}", flush=True)
    print(f"     {name}: {', '.join(f'{kind} {n}' for kind, n in sorted(tally.kinds.items()))}", flush=True)
    yield equal(f"{name}: wrong values of {tally.frames} spoiled frames", tally.wrong, 0)
    yield equal(f"{name}: exceptions", tally.exceptions, 0)
    # Spoilings that preserve the value (split, duplicated, late but in time) must pass.
    yield at_least(f"{name}: values taken", tally.accepted, count // 50)
