"""Ending a service that a screen started: on request, only while nothing runs, and no other process."""

from __future__ import annotations

import os
import signal
from dataclasses import replace
from pathlib import Path

import pytest

from tester.base.lock import ExclusiveUse
from tester.tui import own_service
from tester.tui.own_service import LOCK, STARTED, end_service
from tests.tester.service.views import state
from tests.tester.tui.stage import House, Stage


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder of the service played by this process."""
    monkeypatch.setattr(own_service, "service_folder", lambda: tmp_path)
    return tmp_path


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, int]]:
    """Return the processes to be ended, each with the signal."""
    found: list[tuple[int, int]] = []
    monkeypatch.setattr(own_service.os, "kill", lambda pid, number: found.append((pid, number)))
    return found


@pytest.mark.skipif(os.name != "posix", reason="a process is asked to end by a signal")
def test_a_service_that_a_screen_started_is_asked_to_end(place: Path, asked: list[tuple[int, int]]) -> None:
    (place / STARTED).write_text(f"{os.getpid()}\n")
    with ExclusiveUse() as use:
        use.lock_file("the service here", place / LOCK, "", lasting=False)
        assert end_service() == ""
    assert asked == [(os.getpid(), signal.SIGTERM)]


def test_a_number_that_is_left_over_ends_no_process(place: Path, asked: list[tuple[int, int]]) -> None:
    (place / STARTED).write_text(f"{os.getpid()}\n")
    assert end_service() == "no service is running here"
    assert not asked


@pytest.mark.parametrize("left", ["", "17\n", "no number"])
def test_a_service_that_no_screen_started_is_not_ended(place: Path, asked: list[tuple[int, int]], left: str) -> None:
    if left:
        (place / STARTED).write_text(left)
    with ExclusiveUse() as use:
        use.lock_file("the service here", place / LOCK, "", lasting=False)
        assert f"end process {os.getpid()} where it was started" in end_service()
    assert not asked


def test_a_process_started_by_a_screen_is_recorded(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Started:
        pid = 4711

    monkeypatch.setattr(own_service.subprocess, "Popen", lambda *_, **__: Started())
    own_service.start_service("sim", place)
    assert (place / STARTED).read_text() == "4711\n"


def test_the_end_is_offered_only_here_and_while_nothing_runs(house: House, monkeypatch: pytest.MonkeyPatch) -> None:
    ended: list[str] = []
    monkeypatch.setattr("tester.tui.dialogs.confirm.end_service", lambda: ended.append("asked") or "")

    async def act(on: Stage) -> None:
        on.app.action_end_service()
        await on.until(lambda: "end the service where it was started" in on.text(), "elsewhere is refused")
        there, on.app.options = on.app.options, replace(on.app.options, address=None)
        try:
            on.app.action_end_service()
            await on.until(lambda: "the rig is in use" in on.text(), "a run is refused")
            await on.show(state("OFFLINE"))
            on.app.action_end_service()
            await on.until(lambda: "End the service (Enter)" in on.text(), "the question is asked")
            assert not ended
            await on.pilot.press("enter")
            await on.until(lambda: "the service is asked to end" in on.text(), "it is asked to end")
        finally:
            on.app.options = there
        assert ended == ["asked"]

    house.play(act)
