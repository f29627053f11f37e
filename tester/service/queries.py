"""Answers questions that need computing (check, plan, lists), each in a short-lived process, so that the scan is not
delayed.

That process is the command of the same name with ``--json``, so that a question has the same answer everywhere.
"""

from __future__ import annotations

import asyncio
import os
import subprocess
import tempfile
from collections.abc import Coroutine
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from pydantic import JsonValue
from pydantic_core import from_json

import recipes
from tester.base.processes import EXIT_INVALID, tester_command
from tester.service.commands import CheckRecipe, ListRecipes, ListRuns, Query, ShowPlan

AT_ONCE = 2
"""Number of questions answered at the same time; further ones wait."""
WITHIN_S = 120.0
"""Time limit of an answer, s [A]: a plan of 100,000 conditions takes some seconds."""
MOST = 32_000_000
"""Longest answer, bytes."""
NICE = 10
"""Lower priority: the scan comes first."""


class QueryError(Exception):
    """A question could not be answered; the message gives the reason."""


@dataclass(slots=True)
class Queries:
    """Answers questions.

    ``runs``: folder of the stored runs; ``rig``: the default rig file, with the risks that its service accepted.
    """

    runs: Path
    rig: str = "sim"
    accept_risk: str = ""
    _turns: asyncio.Semaphore = field(default_factory=lambda: asyncio.Semaphore(AT_ONCE))
    _tasks: set[asyncio.Task[None]] = field(default_factory=set[asyncio.Task[None]])

    def start(self, work: Coroutine[None, None, None]) -> None:
        """Start a task without waiting for it."""
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def answer(self, question: Query) -> JsonValue:
        """Return the answer; raises QueryError."""
        if isinstance(question, ListRecipes):
            return {"recipes": _recipes()}
        async with self._turns:
            if isinstance(question, ListRuns):
                return {"runs": await _ask(["runs", "--out", str(self.runs), "--json"])}
            return await self._of_recipe(question)

    async def _of_recipe(self, question: CheckRecipe | ShowPlan) -> JsonValue:
        options = ["--rig", question.rig or self.rig, "--json"]
        if self.accept_risk and not question.rig:
            options += [f"--accept-risk={self.accept_risk}"]
        for override in question.overrides:
            options += ["--set", override]
        if not question.text:
            return await _ask([question.command, *options, "--", question.recipe])
        with tempfile.TemporaryDirectory(prefix="friction-tester-") as folder:
            file = Path(folder) / "recipe.yaml"
            file.write_text(question.text, encoding="utf-8")
            return await _ask([question.command, *options, "--", str(file)])


def _recipes() -> JsonValue:
    """Return the shipped recipes and the files in ``recipes`` below the service's folder."""
    entries: list[JsonValue] = []
    for name in recipes.names():
        entries.append({"name": name, "path": name, "shipped": True})
    here = Path("recipes")
    if here.is_dir() and here.resolve() != recipes.FOLDER.resolve():
        for file in sorted(here.glob("*.yaml")):
            entries.append({"name": file.stem, "path": str(file), "shipped": False})
    return entries


async def _ask(arguments: list[str]) -> JsonValue:
    """Return the JSON output of `tester ARGUMENTS`; raises QueryError with its error message."""
    process = await asyncio.create_subprocess_exec(
        *tester_command(*arguments),
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    try:
        with suppress(ProcessLookupError):  # it may be gone already
            if hasattr(os, "setpriority"):
                os.setpriority(os.PRIO_PROCESS, process.pid, NICE)
        async with asyncio.timeout(WITHIN_S):
            out, err = await process.communicate()
    except TimeoutError:
        raise QueryError(f"no answer within {WITHIN_S:g} s") from None
    finally:
        if process.returncode is None:  # timed out, or the client has disconnected
            with suppress(ProcessLookupError):
                process.kill()
            await process.wait()
    if process.returncode not in (0, EXIT_INVALID) or not out.strip():
        raise QueryError(err.decode(errors="replace").strip()[-2000:] or f"exit code {process.returncode}")
    if len(out) > MOST:
        raise QueryError(f"the answer is longer than {MOST / 1e6:g} MB")
    result: JsonValue = from_json(out)
    return result
