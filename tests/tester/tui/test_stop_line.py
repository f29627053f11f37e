"""STOP past a frozen screen."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from textual.driver import Driver
from textual.events import Key
from textual.message import Message

from tester.service.address import UnixAddress
from tester.service.stop_call import NotTakenError
from tester.service.stop_lane import StopLane
from tester.service.stop_line import StopLine
from tester.tui.stop_line import stopping


class Silent(Driver):
    """A driver that keeps what it is given."""

    def __init__(self) -> None:
        self.given: list[Message] = []

    def process_message(self, message: Message) -> None:
        self.given.append(message)

    def write(self, data: str) -> None: ...

    def start_application_mode(self) -> None: ...

    def disable_input(self) -> None: ...

    def stop_application_mode(self) -> None: ...


class Pressed(StopLine):
    """Keeps each press, and whether it was for a fast stop."""

    def __init__(self, address: UnixAddress, name: str) -> None:
        super().__init__(address, name)
        self.pressed: list[bool] = []

    def press(self, *, fast: bool = False) -> None:
        self.pressed.append(fast)


@pytest.mark.parametrize(
    ("key", "pressed"),
    [("f12", [False]), ("ctrl+x", [False]), ("f9", [True]), ("ctrl+f", [True]), ("f2", []), ("x", [])],
)
def test_only_the_keys_of_stop_press_it_and_they_also_reach_the_screen(
    key: str, pressed: list[bool], tmp_path: Path
) -> None:
    line = Pressed(UnixAddress(tmp_path / "s"), "tui")
    driver: Driver = stopping(Silent, line)()  # type: ignore[call-arg]
    driver.process_message(Key(key, None))
    assert line.pressed == pressed and len(driver.given) == 1  # type: ignore[attr-defined]


@pytest.mark.parametrize("fast", [False, True])
def test_it_arrives_over_the_lane_for_stop_and_is_answered(fast: bool, lane: StopLane, tmp_path: Path) -> None:
    line = StopLine(UnixAddress(tmp_path / "service.sock"), "tui of process 7")
    line.press(fast=fast)
    sent = line.take()
    assert sent is not None and line.take() is None
    sent.result(10.0)
    (wish,) = lane.taken()
    assert wish.name.startswith("tui of process 7 (user id ") and (wish.fast, wish.number) == (fast, 0)
    line.close()


@pytest.fixture
def lane(tmp_path: Path) -> Iterator[StopLane]:
    made = StopLane()
    made.open(UnixAddress(tmp_path / "service.sock"))
    yield made
    made.close()


def test_a_missing_service_is_reported(tmp_path: Path) -> None:
    line = StopLine(UnixAddress(tmp_path / "none.sock"), "tui")
    line.press()
    sent = line.take()
    assert sent is not None
    with pytest.raises(NotTakenError):
        sent.result(10.0)
