"""Made-up sets of references, by the model of ``tester.analysis.reference`` and with its own distributions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import exp, log, sqrt
from random import Random

from tester.analysis.reference import PIECE_PER_M, CounterfaceDrift, KnownScatter, Reference, counterface_drift

LOSS, OVER_M = 0.10, 2000.0
BETWEEN, REPEATS = 0.03, 0.02
SLID_OF_TRAVEL = 0.05
"""Metres of sliding per metre of the belt's travel under load, which is mostly rolling [A]."""


@dataclass(frozen=True, slots=True)
class Way:
    """How references are made: on several wheels in turn, or on a reserved one; number on each."""

    name: str
    wheels: int
    each: int
    reserved: bool = False
    separable: bool = True
    """Whether belt and wheel can be separated."""


WAYS = (
    Way("six wheel changes, a reference each", 7, 1),
    Way("eight wheel changes, two references each", 9, 2),
    Way("a reserved wheel, 7 references", 1, 7, reserved=True),
    Way("one wheel, 7 references", 1, 7, separable=False),
)


def made(way: Way, random: Random, repeats: int = 3) -> list[Reference]:
    """Return references over OVER_M of a belt that loses LOSS, on wheels that wear."""
    count = way.wheels * way.each
    own_m = 10.0 if way.reserved else SLID_OF_TRAVEL * OVER_M / (count - 1)
    per_wheel_m = random.gauss(0.0, PIECE_PER_M)
    found: list[Reference] = []
    for wheel in range(way.wheels):
        level = log(0.73) + log(1.0 + random.gauss(0.0, BETWEEN))
        for place in range(way.each):
            number = len(found) + 1
            travel_m, slid_m = OVER_M * (number - 1) / (count - 1), own_m * place
            value = level + log(1.0 - LOSS) * travel_m / OVER_M + per_wheel_m * slid_m
            u = REPEATS / sqrt(repeats)
            value += random.gauss(0.0, u)
            found.append(Reference(number, number, 0.0, "1#", wheel, exp(value), u, travel_m, slid_m))
    return found


def drifts(way: Way, sets: int) -> Iterator[CounterfaceDrift]:
    """Yield the results of so many sets."""
    for number in range(sets):
        found = counterface_drift(made(way, Random(f"{way.name} {number}")), KnownScatter(60.0, BETWEEN, way.reserved))
        assert found is not None
        yield found
