"""The belts of a run: which one is on, and how far each has travelled under load, which wears it."""

from __future__ import annotations

from collections.abc import Mapping


class Belts:
    """The history of each belt of a run; the name is "" where the recipe names no belts, as it then has only one."""

    def __init__(self, on: str = "", travels_m: Mapping[str, float] | None = None) -> None:
        """``on``: the belt that is on; ``travels_m``: travel of each under load since the run began, m."""
        self.on = on
        self._travels_m = dict(travels_m or {})
        self._travels_m.setdefault(on, 0.0)

    @property
    def travel_m(self) -> float:
        """Return how far the belt that is on has travelled under load since the run began, m."""
        return self._travels_m[self.on]

    @property
    def travels_m(self) -> Mapping[str, float]:
        """Return the travel of every belt that was on, m, by name."""
        return self._travels_m

    def travelled(self, travel_m: float) -> None:
        """Add travel under load, m, to the belt that is on."""
        self._travels_m[self.on] += travel_m

    def put_on(self, belt: str) -> None:
        """Use another belt from now on, with the history that it has."""
        self.on = belt
        self._travels_m.setdefault(belt, 0.0)
