"""What a run shows: data on standard output, everything for people on standard error."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Callable

import pytest

from tester.cli import console as module
from tester.cli.console import Console
from tester.engine.context import Progress
from tester.engine.prompts import Prompts

Output = pytest.CaptureFixture[str]


class AtOnce:
    """A thread that has ended when it has been started."""

    def __init__(self, target: Callable[..., None], args: tuple[object, ...], daemon: bool) -> None:
        self.target, self.args = target, args

    def start(self) -> None:
        self.target(*self.args)


@pytest.fixture
def answers(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Give what a person types, read at once."""
    monkeypatch.setattr(module, "Thread", AtOnce)
    return lambda text: monkeypatch.setattr(sys, "stdin", io.StringIO(text))


def asking() -> tuple[Console, Prompts]:
    prompts = Prompts()
    prompts.ask(0.0, "install wheel 1")
    return Console(as_json=False, answer_yes=False), prompts


def attend(console: Console, prompts: Prompts, times: int = 4) -> str | None:
    for _ in range(times):
        console.attend(prompts)
    return prompts.asked[0].answer


def test_the_folder_is_the_last_line_of_standard_output(capsys: Output) -> None:
    Console(as_json=False, answer_yes=True).result("runs/one")
    assert capsys.readouterr() == ("runs/one\n", "")


def test_messages_are_for_standard_error(capsys: Output) -> None:
    Console(as_json=True, answer_yes=True).message("condition 1: not reached")
    assert capsys.readouterr() == ("", "condition 1: not reached\n")


def test_without_json_no_records_are_written(capsys: Output) -> None:
    Console(as_json=False, answer_yes=True).emit({"event": "end"})
    assert capsys.readouterr().out == ""


def test_records_are_one_line_of_json_each(capsys: Output) -> None:
    console = Console(as_json=True, answer_yes=True)
    console.emit({"event": "step", "title": "25 °C\nheat"})
    console.emit({"event": "end"})
    assert [json.loads(line)["event"] for line in capsys.readouterr().out.splitlines()] == ["step", "end"]


def test_without_a_terminal_every_step_is_a_line(capsys: Output) -> None:
    console = Console(as_json=False, answer_yes=True)
    console.begin("short")
    for title in ("heat to 40 degC", "heat to 40 degC", "1#: 300 mm/s"):
        console.show(3725.0, Progress(title=title), 0.5)
    console.end()
    assert capsys.readouterr().err == "1:02:05  heat to 40 degC\n1:02:05  1#: 300 mm/s\n"


def test_a_step_is_a_record_once(capsys: Output) -> None:
    console = Console(as_json=True, answer_yes=True)
    for _ in range(3):
        console.show(12.3456, Progress(step=2, title="heat to 40 degC"), 0.5)
    (line,) = capsys.readouterr().out.splitlines()
    assert json.loads(line) == {"event": "step", "t_s": 12.346, "step": 2, "title": "heat to 40 degC"}


def test_texts_from_outside_are_no_markup(capsys: Output) -> None:
    Console(as_json=False, answer_yes=True).message("[bold red]x[/]")
    assert capsys.readouterr().err == "[bold red]x[/]\n"


def test_nobody_can_be_asked_where_there_is_no_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    assert not Console(as_json=False, answer_yes=False).can_ask


def test_enter_answers_a_question(answers: Callable[[str], None], capsys: Output) -> None:
    answers("\n")
    assert attend(*asking()) == "yes"
    assert capsys.readouterr().err == "install wheel 1 - done? [Enter] \n"


def test_what_is_typed_is_the_answer(answers: Callable[[str], None]) -> None:
    answers("  wheel 17  \n")
    assert attend(*asking()) == "wheel 17"


@pytest.mark.parametrize("text", ["n\n", "No\n"])
def test_no_asks_again(answers: Callable[[str], None], capsys: Output, text: str) -> None:
    answers(text)
    console, prompts = asking()
    assert attend(console, prompts, times=3) is None
    assert capsys.readouterr().err.count("install wheel 1") == 2


def test_the_end_of_input_is_no_answer(answers: Callable[[str], None], capsys: Output) -> None:
    answers("")
    assert attend(*asking(), times=10) is None
    assert capsys.readouterr().err.count("no answer can be read") == 1


def test_a_question_is_asked_once(answers: Callable[[str], None], capsys: Output) -> None:
    answers("")
    attend(*asking(), times=10)
    assert capsys.readouterr().err.count("install wheel 1") == 1


def test_a_question_is_a_record(answers: Callable[[str], None], capsys: Output) -> None:
    answers("\n")
    console, prompts = asking()
    console.as_json = True
    attend(console, prompts)
    assert json.loads(capsys.readouterr().out) == {"event": "prompt", "number": 1, "text": "install wheel 1"}


def test_questions_are_answered_in_turn(answers: Callable[[str], None]) -> None:
    answers("first\nsecond\n")
    console, prompts = asking()
    prompts.ask(0.0, "clean debris")
    attend(console, prompts, times=6)
    assert [prompt.answer for prompt in prompts.asked] == ["first", "second"]


class Broken(io.StringIO):
    """A pipe that nobody reads."""

    def __init__(self) -> None:
        super().__init__()
        self.tries = 0

    def write(self, text: str) -> int:
        self.tries += 1
        raise BrokenPipeError(32, "Broken pipe")


def test_what_is_not_read_any_more_is_an_error_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", broken := Broken())
    console = Console(as_json=True, answer_yes=True)
    with pytest.raises(BrokenPipeError):
        console.emit({})
    console.emit({})
    assert broken.tries == 1


def test_people_are_still_told_when_nobody_reads_the_data(monkeypatch: pytest.MonkeyPatch, capsys: Output) -> None:
    monkeypatch.setattr(sys, "stdout", Broken())
    console = Console(as_json=True, answer_yes=True)
    with pytest.raises(BrokenPipeError):
        console.emit({})
    console.message("stopped")
    assert capsys.readouterr().err == "stopped\n"


def test_a_closed_file_is_an_error_like_any_other(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", closed := io.StringIO())
    console = Console(as_json=False, answer_yes=True)
    closed.close()
    with pytest.raises(OSError, match="closed"):
        console.message("condition 1")


def test_an_output_closed_from_the_start_is_missed_by_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    Console(as_json=True, answer_yes=True).result("runs/one")


def test_a_broken_progress_line_is_noticed_although_a_thread_draws_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setattr(sys, "stderr", Broken())
    console = Console(as_json=False, answer_yes=True)
    console.begin("short")
    try:
        with pytest.raises(BrokenPipeError):
            console.show(0.0, Progress(), 0.0)
    finally:
        console.end()
