"""The topics by name."""

from __future__ import annotations

from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import Protocol

from tests.campaigns.acceptance.figure import Figure
from tests.campaigns.screens import cpu, kill, operator, reattach, stop, unread
from tests.campaigns.screens.recipes import MISTAKEN, SHORT, SLIDING
from tests.campaigns.screens.seat import Seat


class Figures(Protocol):
    """Measures, and yields each figure as soon as it is known."""

    def __call__(self, seat: Seat, *, quick: bool) -> AsyncIterator[Figure]:
        """Measure at a seat of its own."""
        ...


@dataclass(frozen=True, slots=True)
class Topic:
    """One check. ``recipe``: text of recipes/mine.yaml at its seat."""

    name: str
    title: str
    figures: Figures
    recipe: str = ""


TOPICS = {
    topic.name: topic
    for topic in (
        Topic("stop", "STOP from a key to the service", stop.figures, SLIDING),
        Topic("kill", "SIGKILL of the screen leaves the run's tables alone", kill.figures, SHORT),
        Topic("unread", "a terminal that nobody reads leaves the scan alone", unread.figures, SLIDING),
        Topic("reattach", "a new screen shows the run", reattach.figures, SLIDING),
        Topic("cpu", "CPU time of screen and service", cpu.figures, SLIDING),
        Topic("operator", "an afternoon at the rig, in tmux", operator.figures, MISTAKEN),
    )
}
