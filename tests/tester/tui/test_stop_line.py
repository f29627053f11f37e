"""STOP past a screen that stands still."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest
from textual.driver import Driver
from textual.events import Key
from textual.message import Message

from tester.service.address import UnixAddress
from tester.service.commands import Stop
from tester.tui.stop_line import NotTakenError, StopLine, stopping
from tests.tester.service.fake import FakeService


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
    """Counts."""

    count = 0

    def press(self) -> None:
        self.count += 1


@pytest.mark.parametrize(("key", "count"), [("f12", 1), ("ctrl+x", 1), ("f2", 0), ("x", 0)])
def test_the_keys_of_stop_and_no_others_press_it_and_go_on_to_the_screen(key: str, count: int, tmp_path: Path) -> None:
    line = Pressed(UnixAddress(tmp_path / "s"), "tui")
    driver: Driver = stopping(Silent, line)()  # type: ignore[call-arg]
    driver.process_message(Key(key, None))
    assert line.count == count and len(driver.given) == 1  # type: ignore[attr-defined]


def test_it_arrives_as_a_viewers_stop_and_is_answered(tmp_path: Path) -> None:
    async def act() -> None:
        async with FakeService(tmp_path) as fake:
            line = StopLine(fake.address, "tui of process 7")
            line.press()
            sent = line.take()
            assert sent is not None and line.take() is None
            await asyncio.wrap_future(sent)
            assert [(order.name, order.action) for order in fake.orders] == [("tui of process 7", Stop())]

    asyncio.run(act())


def test_where_there_is_no_service_it_says_so(tmp_path: Path) -> None:
    line = StopLine(UnixAddress(tmp_path / "none.sock"), "tui")
    line.press()
    sent = line.take()
    assert sent is not None
    with pytest.raises(NotTakenError):
        sent.result(10.0)
