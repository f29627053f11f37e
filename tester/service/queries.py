"""Questions that take computing (check, plan, lists) are answered by a short-lived process each, beside the scan."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from collections.abc import Coroutine
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from pydantic import Field, JsonValue, TypeAdapter

from tester.service.commands import Query

AT_ONCE = 2
"""More questions wait their turn."""
WITHIN_S = 120.0
"""A plan of 100,000 conditions takes some seconds; what takes longer is given up, s [A]."""

QUERY: TypeAdapter[Query] = TypeAdapter(Annotated[Query, Field(discriminator="command")])
RESULT: TypeAdapter[JsonValue] = TypeAdapter(JsonValue)


class QueryError(Exception):
    """A question that has no answer; the message says why."""


@dataclass(slots=True)
class Queries:
    """Runs `python -m tester.service.query` for each question. ``runs``: folder of the stored runs."""

    runs: Path
    rig: str = "sim"
    _turns: asyncio.Semaphore = field(default_factory=lambda: asyncio.Semaphore(AT_ONCE))
    _tasks: set[asyncio.Task[None]] = field(default_factory=set[asyncio.Task[None]])

    def start(self, work: Coroutine[None, None, None]) -> None:
        """Work on something without waiting for it."""
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def answer(self, question: Query) -> JsonValue:
        """Return the answer; raises QueryError."""
        async with self._turns:
            process = await asyncio.create_subprocess_exec(
                sys.executable, "-m", "tester.service.query", str(self.runs), self.rig,
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            )  # fmt: skip
            try:
                async with asyncio.timeout(WITHIN_S):
                    out, err = await process.communicate(QUERY.dump_json(question))
            except TimeoutError:
                process.kill()
                await process.wait()
                raise QueryError(f"no answer within {WITHIN_S:g} s") from None
        if process.returncode:
            raise QueryError(err.decode(errors="replace").strip()[-2000:] or "the question failed")
        return RESULT.validate_json(out)
