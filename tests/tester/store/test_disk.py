from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from threading import Event

from tester.store.disk import FreeRoom


def hanging(answer: Event) -> Callable[[Path], int]:
    """Return a disk that answers nothing until released."""

    def ask(_folder: Path) -> int:
        answer.wait()
        return 7

    return ask


def test_a_thread_reports_the_free_space(tmp_path: Path) -> None:
    room = FreeRoom(tmp_path, lambda _: 5)
    room.look()
    room.wait(10.0)
    assert room.free == 5 and not room.hangs


def test_a_hanging_disk_blocks_no_caller_and_is_reported(tmp_path: Path) -> None:
    answer = Event()
    room = FreeRoom(tmp_path, hanging(answer))
    for _ in range(3):
        room.look()
    assert room.hangs and room.free is None
    answer.set()
    room.wait(10.0)
    room.look()
    room.wait(10.0)
    assert not room.hangs and room.free == 7


def test_a_disk_that_answers_with_an_error_gives_no_value(tmp_path: Path) -> None:
    def gone(_folder: Path) -> int:
        raise OSError("stale file handle")

    room = FreeRoom(tmp_path, gone)
    room.look()
    room.wait(10.0)
    assert room.free is None and not room.hangs


def test_the_working_folder_replaces_one_that_does_not_exist_yet(tmp_path: Path) -> None:
    asked: list[Path] = []

    def ask(folder: Path) -> int:
        asked.append(folder)
        return 1

    room = FreeRoom(tmp_path / "runs", ask)
    room.look()
    room.wait(10.0)
    assert asked == [Path()]
