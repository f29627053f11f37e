"""Queries, each answered by a process: one that died, hangs, or has lost its client."""

from __future__ import annotations

import asyncio
import os
import sys
from pathlib import Path

import pytest

from tester.service import queries
from tester.service.commands import ListRuns
from tester.service.queries import Queries, QueryError


@pytest.fixture
def process(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """Replace the command by a test's program, a text to be filled in; it leaves its pid."""
    text = [""]
    note = f"import os, pathlib; pathlib.Path({str(tmp_path / 'pid')!r}).write_text(str(os.getpid())); "
    monkeypatch.setattr(queries, "tester_command", lambda *_: [sys.executable, "-I", "-c", note + text[0]])
    return text


def gone(tmp_path: Path) -> bool:
    try:
        os.kill(int((tmp_path / "pid").read_text()), 0)
    except ProcessLookupError:
        return True
    return False


def test_a_process_that_has_gone_before_it_is_made_nice_has_still_answered(
    process: list[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def too_late(which: int, who: int, nice: int) -> None:
        raise ProcessLookupError(3, "No such process")

    process[0] = "print('[1]')"
    monkeypatch.setattr(os, "setpriority", too_late, raising=False)
    assert asyncio.run(Queries(tmp_path).answer(ListRuns())) == {"runs": [1]}


def test_a_process_that_hangs_is_ended_and_the_question_has_no_answer(
    process: list[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    process[0] = "import time; time.sleep(600)"
    monkeypatch.setattr(queries, "WITHIN_S", 0.5)
    with pytest.raises(QueryError, match=r"no answer within 0\.5 s"):
        asyncio.run(Queries(tmp_path).answer(ListRuns()))
    assert not (tmp_path / "pid").exists() or gone(tmp_path)


@pytest.mark.parametrize("killed", [False, True], ids=["under way", "gone by then"])
def test_a_service_that_ends_leaves_no_process_behind_and_no_error(
    process: list[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, killed: bool
) -> None:
    process[0] = "import time; time.sleep(600)"
    if killed:
        end = asyncio.subprocess.Process.kill

        def too_late(one: asyncio.subprocess.Process) -> None:
            end(one)
            raise ProcessLookupError(3, "No such process")

        monkeypatch.setattr(asyncio.subprocess.Process, "kill", too_late)

    async def story() -> None:
        asked = asyncio.create_task(Queries(tmp_path).answer(ListRuns()))
        while not (tmp_path / "pid").exists() or not (tmp_path / "pid").read_text():
            assert not asked.done()
            await asyncio.sleep(0.01)
        asked.cancel()
        with pytest.raises(asyncio.CancelledError):
            await asked

    asyncio.run(story())
    assert gone(tmp_path)
