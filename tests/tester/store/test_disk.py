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


def test_the_room_is_told_by_a_thread(tmp_path: Path) -> None:
    room = FreeRoom(tmp_path, lambda _: 5)
    room.look()
    room.wait(10.0)
    assert room.free == 5 and not room.hangs


def test_a_disk_that_hangs_keeps_nobody_waiting_and_is_told(tmp_path: Path) -> None:
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


def test_a_disk_that_answers_with_an_error_tells_nothing(tmp_path: Path) -> None:
    def gone(_folder: Path) -> int:
        raise OSError("stale file handle")

    room = FreeRoom(tmp_path, gone)
    room.look()
    room.wait(10.0)
    assert room.free is None and not room.hangs


def test_the_working_folder_stands_in_for_one_that_is_not_there_yet(tmp_path: Path) -> None:
    asked: list[Path] = []

    def ask(folder: Path) -> int:
        asked.append(folder)
        return 1

    room = FreeRoom(tmp_path / "runs", ask)
    room.look()
    room.wait(10.0)
    assert asked == [Path()]
