"""Questions over a page's socket: answered by separate processes; only the role control may write."""

from __future__ import annotations

import asyncio
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tester.page.answers import Tickets
from tester.page.data_worker import DataWorker
from tester.page.pairing import Pairings
from tester.page.questions import Questions
from tests.tester.page.stage import PageStage
from tests.tester.page.test_reception import play
from tests.tester.service.views import state
from tests.tester.store.build import RUN, small_run

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the fake service listens at a Unix socket")
FOUR = ([0.90, 0.91, 0.89], [0.70, 0.74, 0.72])


@pytest.fixture
def there(tmp_path: Path) -> Path:
    """Make a run where the page looks for runs."""
    return small_run(tmp_path / "runs" / RUN.name, FOUR, rows=0)


def test_a_page_that_looks_reads_and_does_not_write(tmp_path: Path, there: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("look")
        found = (await page.ask("runs"))["result"]["runs"]
        assert [run["run"] for run in found] == [RUN.name]
        stored = (await page.ask("run", run=RUN.name))["result"]
        assert len(stored["conditions"]) == 2
        for query, keys in (("note", {"text": "x"}), ("exclude", {"n": 1, "repeat": 1, "reason": "x"})):
            assert "needs the role control" in (await page.ask(query, run=RUN.name, **keys))["reason"]
        assert (await page.ask("run", run=RUN.name))["result"]["notes"] == []

    play(tmp_path, story)


def test_a_page_that_controls_writes_under_its_name(tmp_path: Path, there: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("control")
        assert (await page.ask("note", run=RUN.name, text="seen"))["type"] == "accepted"
        (note,) = (await page.ask("run", run=RUN.name))["result"]["notes"]
        assert (note["by"], note["text"]) == ("page 1: Anna's phone", "seen")

    play(tmp_path, story)


@pytest.mark.parametrize(
    ("query", "keys"),
    [
        ("run", {"run": "../../etc"}), ("prepare", {"run": RUN.name}), ("ticket", {"run": "../x", "what": "csv"}),
        ("sudo", {}), ("ticket", {"run": RUN.name, "what": "exe"}), ("ticket", {"run": "--help", "what": "csv"}),
    ],
)  # fmt: skip
def test_a_bad_question_is_refused(query: str, keys: dict[str, Any], tmp_path: Path, there: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("control")
        assert (await page.ask(query, **keys))["type"] == "refused"

    play(tmp_path, story)


def test_a_download_is_the_table_of_the_command_and_is_fetched_once(tmp_path: Path, there: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("look")
        answer = await page.ask("ticket", run=RUN.name, what="csv")
        assert answer["type"] == "accepted", answer
        request = f"GET {answer['result']['path']} HTTP/1.1\nHost: 127.0.0.1:{stage.port}\n\n"
        head, _, body = (await stage.http(request)).partition(b"\r\n\r\n")
        assert b"attachment" in head and body.startswith(b"level,condition,") and body.count(b"\n") == 3
        assert b" 404 " in (await stage.http(request)).partition(b"\r\n")[0]

    play(tmp_path, story)


def test_a_run_that_ends_is_prepared_for_its_first_picture(
    tmp_path: Path, there: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []
    monkeypatch.setattr(Questions, "prepare", lambda _self, run: asked.append(run))

    async def story(stage: PageStage) -> None:
        page = await stage.paired("look")
        run = state().run
        assert run is not None
        stage.fake.show(replace(state(), run=replace(run, name="first", folder="runs/first", exit=None)))
        assert (await page.service("snapshot"))["state"]["run"]["name"] == "first"
        asked.clear()  # of the previous run, where its state had arrived
        stage.fake.show(replace(state(), run=replace(run, name="first", folder="runs/first", exit=0)))
        await page.service("snapshot")
        assert asked == ["first"]

    play(tmp_path, story)


def test_the_newest_run_is_prepared_by_the_reading_process_when_the_page_starts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[str, object]] = []

    async def played(_self: DataWorker, query: str, keys: dict[str, Any], _by: str) -> bytes:
        asked.append((query, keys))
        return b"{}"

    monkeypatch.setattr(DataWorker, "answer", played)
    for day in (1, 2, 3):
        small_run(tmp_path / f"2024-02-0{day}-run", FOUR, rows=0)

    async def story() -> None:
        async with Questions(tmp_path, Pairings("control"), Tickets()) as questions:
            questions.warm()
            await asyncio.sleep(0)

    asyncio.run(story())
    assert asked == [("prepare", {"run": "2024-02-03-run"})]


def test_pages_see_paired_devices(tmp_path: Path) -> None:
    async def story(stage: PageStage) -> None:
        await stage.paired("control", "Ben's tablet")
        page = await stage.paired("look")
        listed = (await page.ask("pairings"))["result"]["pairings"]
        assert [(one["name"], one["role"]) for one in listed] == [("Ben's tablet", "control"), ("Anna's phone", "look")]
        assert "secret" not in str(listed)

    play(tmp_path, story)


def test_a_reader_that_died_is_started_again(tmp_path: Path, there: Path) -> None:
    async def story(stage: PageStage) -> None:
        page = await stage.paired("look")
        assert (await page.ask("run", run=RUN.name))["type"] == "accepted"
        (reader,) = [p for p in Path("/proc").glob("[0-9]*") if _is_reader_of_this_process(p)]
        os.kill(int(reader.name), 9)
        answers = [(await page.ask("run", run=RUN.name))["type"] for _ in range(2)]
        assert answers == ["refused", "accepted"]

    if not Path("/proc/self/stat").exists():
        pytest.skip("needs /proc")
    play(tmp_path, story)


def _is_reader_of_this_process(folder: Path) -> bool:
    try:
        command = (folder / "cmdline").read_bytes()
        parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
    except (OSError, ValueError):
        return False
    return b"tester.page.data_process" in command and parent == os.getpid()
