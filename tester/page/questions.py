"""Answers questions of pages: about the page itself here, about stored runs in a process of its own."""

from __future__ import annotations

from pathlib import Path

from pydantic import JsonValue
from pydantic_core import to_json

from tester.page.answers import Tickets
from tester.page.front import PageQuestion
from tester.page.pairing import Pairing, Pairings
from tester.page.reception import AskError


class Questions:
    """Answers each question by its name."""

    def __init__(self, runs: Path, pairings: Pairings, tickets: Tickets) -> None:
        """``runs``: folder of the stored runs."""
        self._runs = runs
        self._pairings = pairings
        self._tickets = tickets

    async def __aenter__(self) -> Questions:
        return self

    async def __aexit__(self, *_: object) -> None: ...

    async def answer(self, _pairing: Pairing, question: PageQuestion) -> bytes:
        """Return the answer as JSON. Raises AskError."""
        if question.query == "pairings":
            return to_json({"pairings": self._listed()})
        raise AskError(f"no question {question.query!r}")

    def _listed(self) -> list[JsonValue]:
        return [
            {"number": one.number, "name": one.name, "role": one.role, "expires_utc": one.expires_utc}
            for one in self._pairings.listed()
        ]
