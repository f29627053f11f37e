"""The person who commissions a rig: the interface of the user interfaces, and what a procedure can ask a person."""

from __future__ import annotations

from collections.abc import Callable, Generator
from math import inf
from typing import TYPE_CHECKING, Any

from tester.machine.prompts import GO, Asks, Prompts, Question

if TYPE_CHECKING:
    from tester.machine.commission.commission_step import CommissionStep, Walk
    from tester.machine.commission.record import RecordEntry


class Person:
    """The person who commissions: a terminal, a screen, or a script that reads a simulated rig.

    The engine calls every method in its own thread, between ticks; none may block.
    """

    time_stands: bool = True
    """Whether a simulated rig's time stops while this person thinks; a scripted person takes rig time."""
    scripted: bool = False
    """Whether the person is a script that reads a simulated rig: a recipe then mounts wheels and answers by itself."""

    def at(self, hands: Any) -> None:
        """Move to a rig with newly opened wires; ``hands``: the attendant of a simulated rig."""

    def message(self, text: str) -> None:
        """Show a message."""
        raise NotImplementedError

    def attend(self, prompts: Prompts) -> None:
        """Show the waiting question, and answer it once the answer is known."""
        raise NotImplementedError

    def commands(self) -> list[str]:
        """Return the commands that the person gave since the last call (tester.base.keys)."""
        return []

    def entered(self, entry: RecordEntry) -> None:
        """Receive an entry that was just recorded."""

    def look(self, step: CommissionStep, walk: Walk) -> None:
        """Show the rig's state in a step; called about every tester.machine.tickers.POLL_S of wall time."""


class StepRefused(Exception):  # noqa: N818 - a finding for a person
    """A step does not pass. The text gives the finding and the remedy, for people and for the record."""


Until = Callable[[float], bool]
"""A condition to wait for: called once a tick with rig time, s."""
Waits = Question | Until
"""What a procedure can wait for: a valid answer, or a condition."""
Dialogue = Generator[Waits, str, None]
Measured = Generator[Waits, str, float]


def choose(key: str, text: str, *choices: str) -> Generator[Waits, str, str]:
    """Ask for one of several words."""
    return (yield Question(key, text, Asks.CHOICE, choices))


def measure(key: str, text: str, unit: str) -> Measured:
    """Ask for a quantity; return it in ``unit``."""
    question = Question(key, text, Asks.QUANTITY, unit=unit)
    return question.value((yield question))


def line(key: str, text: str) -> Generator[Waits, str, str]:
    """Ask for a line of text."""
    return (yield Question(key, text, Asks.TEXT))


def press(key: str, text: str, guarded: Callable[[], bool] = lambda: True) -> Dialogue:
    """Ask for the word that starts a motion; ask again while ``guarded`` reports that guard or safety chain is open.

    Raises StepRefused if the answer is "no".
    """
    asked = text
    while (yield Question(key, asked, Asks.KEY)) == GO:
        if guarded():
            return
        asked = f"the guard or the safety chain is open: close it, and again; {text}"
    raise StepRefused(f"left by the person at: {asked}")


def wait(seconds: float) -> Dialogue:
    """Wait for some seconds of rig time."""
    until_s = inf

    def over(now_s: float) -> bool:
        nonlocal until_s
        until_s = min(until_s, now_s + seconds)
        return now_s >= until_s - 1e-9

    yield over
