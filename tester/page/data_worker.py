"""The page process's end of a process that reads stored runs: a limited number of questions, one at a time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from pydantic import JsonValue

from tester.page.reception import AskError
from tester.service.asked_process import AskedProcess, RefusedQuestionError

WITHIN_S = 120.0
"""Time for an answer, s [A]: the tables of a run of 1,000 conditions take 10 s."""
MOST_ASKED = 32
"""Questions that wait for this process; a further one is refused."""


class DataWorker(AskedProcess):
    """Asks the process about the runs in a folder."""

    def __init__(self, runs: Path) -> None:
        """``runs``: folder of the stored runs."""
        super().__init__("tester.page.data_process", str(runs), WITHIN_S)
        self._waiting = 0

    async def answer(self, query: str, keys: Mapping[str, JsonValue], by: str) -> bytes:
        """Return the answer as JSON. Raises AskError, TimeoutError."""
        if self._waiting >= MOST_ASKED:
            raise AskError("too many questions at once: ask again later")
        self._waiting += 1
        try:
            return await self.ask({"query": query, "keys": dict(keys), "by": by})
        except RefusedQuestionError as error:
            raise AskError(str(error)) from error
        finally:
            self._waiting -= 1
