"""A screen that fails: further attempts, and its report."""

from __future__ import annotations

import pytest

from tester.machine.context import Progress
from tester.machine.prompts import Prompts
from tester.machine.time_left import RunPosition
from tester.run.reporter import LastingScreen, ReportScreen


class Failing(ReportScreen):
    """A screen whose named methods fail; keeps its calls."""

    answer_yes = False
    can_ask = True

    def __init__(self, *failing: str) -> None:
        self.failing = failing
        self.called: list[str] = []

    def _do(self, name: str) -> None:
        self.called.append(name)
        if name in self.failing:
            raise BrokenPipeError(32, "Broken pipe")

    def begin(self, name: str) -> None:
        self._do("begin")

    def show(self, now_s: float, run: Progress, at: RunPosition) -> None:
        self._do("show")

    def attend(self, prompts: Prompts) -> None:
        self._do("attend")

    def end(self) -> None:
        self._do("end")

    def message(self, text: str) -> None:
        self._do(f"message {text}")

    def emit(self, record: dict[str, object]) -> None:
        self._do("emit")

    def result(self, line: str) -> None:
        self._do("result")

    def commands(self) -> list[str]:
        self._do("commands")
        return ["hold"]


def everything(screen: LastingScreen) -> None:
    screen.begin("x")
    screen.show(0.0, Progress(), RunPosition())
    screen.attend(Prompts())
    screen.commands()
    screen.emit({})
    screen.end()
    screen.message("bye")
    screen.result("runs/x")


@pytest.mark.parametrize("name", ["begin", "show", "attend", "commands", "emit", "end", "message bye", "result"])
def test_a_failure_is_reported_once_with_its_cause(name: str) -> None:
    told: list[str] = []
    everything(LastingScreen(Failing(name), told.append))
    assert told == ["the run can no longer be shown: its reader is gone"]


def test_nothing_more_is_shown_or_asked_after_a_failure() -> None:
    inner = Failing("show")
    screen = LastingScreen(inner, lambda _: None)
    everything(screen)
    everything(screen)
    assert inner.called.count("show") == 1 and "attend" not in inner.called and "commands" not in inner.called


def test_messages_and_records_are_still_tried_after_a_failure() -> None:
    inner = Failing("show")
    everything(LastingScreen(inner, lambda _: None))
    assert inner.called[-4:] == ["emit", "end", "message bye", "result"]


def test_a_screen_that_works_passes_commands_on() -> None:
    assert LastingScreen(Failing(), lambda _: None).commands() == ["hold"]
