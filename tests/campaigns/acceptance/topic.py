"""An acceptance topic."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from tests.campaigns.acceptance.bench import Bench, ProductError, RunSpec
from tests.campaigns.acceptance.figure import Figure


def no_runs(bench: Bench) -> list[RunSpec]:
    """Name no run."""
    return []


@dataclass(frozen=True, slots=True)
class Topic:
    """One acceptance check."""

    name: str
    title: str
    figures: Callable[[Bench], Iterable[Figure]]
    """Measures; a generator, so that figures measured before a failure are still shown."""
    runs: Callable[[Bench], list[RunSpec]] = no_runs
    """Lists the runs it needs, so that they can start early."""

    def measured(self, bench: Bench) -> Iterable[Figure]:
        """Yield the figures; a failed measurement is a miss, with its reason."""
        try:
            yield from self.figures(bench)
        except (ProductError, LookupError, ValueError, OSError) as error:
            yield Figure(self.name, f"{type(error).__name__}: {error}", "can be measured", False)
