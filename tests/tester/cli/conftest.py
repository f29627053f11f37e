"""A service played by a test, at the address of the user's service."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from pathlib import Path
from threading import Event, Thread

import pytest

from tests.tester.service.fake import FakeService
from tests.tester.service.views import hostile, state


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Put the user's service into the test's folder."""
    where = tmp_path / "runtime"
    where.mkdir(mode=0o700)
    monkeypatch.setenv("TESTER_RUNTIME_DIR", str(where))
    return where


@pytest.fixture
def fake(folder: Path) -> Iterator[FakeService]:
    """A played service in a thread of its own."""
    made = FakeService(folder)
    up, end = Event(), Event()

    async def live() -> None:
        async with made:
            made.show(hostile(state()))
            up.set()
            while not end.is_set():
                await asyncio.sleep(0.01)

    thread = Thread(target=lambda: asyncio.run(live()))
    thread.start()
    up.wait(20)
    yield made
    end.set()
    thread.join(20)
