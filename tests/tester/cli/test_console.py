"""Output of a run: data on standard output, messages for people on standard error."""

from __future__ import annotations

import io
import json
import sys

import pytest

from tester.cli import console as module
from tester.cli.command_keys import Keys
from tester.cli.console import Console, standing_words
from tester.machine.context import Progress
from tester.machine.prompts import Prompts
from tester.machine.time_left import RunPosition

Output = pytest.CaptureFixture[str]


class Typed(Keys):
    """A keyboard on which a person has typed something."""

    def __init__(self) -> None:
        self.waiting = ""

    def pressed(self) -> str:
        found, self.waiting = self.waiting, ""
        return found


@pytest.fixture
def keyboard(monkeypatch: pytest.MonkeyPatch) -> Typed:
    typed = Typed()
    monkeypatch.setattr(module, "keys_of", lambda stream: typed)  # pyright: ignore
    return typed


def asking() -> tuple[Console, Prompts]:
    prompts = Prompts()
    prompts.ask(0.0, "install wheel 1")
    return Console(as_json=False, answer_yes=False), prompts


def answered(keyboard: Typed, *pieces: str) -> tuple[str | None, list[str]]:
    """Type after the question was put; return its answer and the commands."""
    console, prompts = asking()
    commands: list[str] = []
    console.attend(prompts)
    for piece in pieces:
        keyboard.waiting = piece
        commands += console.commands()
        console.attend(prompts)
    return prompts.asked[0].answer, commands


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
        console.show(3725.0, Progress(title=title), RunPosition())
    console.end()
    assert capsys.readouterr().err == "1:02:05  heat to 40 degC\n1:02:05  1#: 300 mm/s\n"


def test_a_step_is_a_record_once(capsys: Output) -> None:
    console = Console(as_json=True, answer_yes=True)
    for _ in range(3):
        console.show(12.3456, Progress(title="heat to 40 degC"), RunPosition(2, 9, 1, 4, 0.5, 61.0))
    (line,) = capsys.readouterr().out.splitlines()
    counted = {"over": 1, "conditions": 4, "left_s": 61.0}
    assert json.loads(line) == {"event": "step", "t_s": 12.346, "step": 2, "title": "heat to 40 degC", **counted}


@pytest.mark.parametrize(
    ("at", "words"),
    [
        (RunPosition(2, 9, 1, 4, 0.5, 61.0, done_s=60.0), "1/4 done, rig 0:01:00 of 0:02:01"),
        (RunPosition(2, 9, 1, 4, 0.5, None), "1/4 done"),
        (RunPosition(1, 3, left_s=7200.0), "rig 0:00:00 of 2:00:00"),
    ],
)
def test_how_far_a_run_is_in_words(at: RunPosition, words: str) -> None:
    assert standing_words(at, None) == words


@pytest.mark.parametrize(("wall_s", "left"), [(22.0, "about 20 s"), (7100.0, "2:00:00"), (9000.0, "2:00:00")])
def test_the_time_left_is_wall_time_and_at_a_machines_pace_rig_time(wall_s: float, left: str) -> None:
    assert standing_words(RunPosition(left_s=7200.0), wall_s) == f"rig 0:00:00 of 2:00:00, {left} left"


def test_a_terminal_shows_rig_time_and_wall_time_in_place(monkeypatch: pytest.MonkeyPatch, capsys: Output) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "80")
    times = iter([0.0, 10.0])
    console = Console(as_json=False, answer_yes=True, clock=lambda: next(times))
    console.begin("short")
    for done_s in (0.0, 1000.0):
        console.show(done_s, Progress(title="heat " * 9), RunPosition(left_s=3000.0 - done_s, done_s=done_s))
    console.end()
    assert "   0 % rig 0:16:40 of 0:50:00, about 20 s left" in capsys.readouterr().err


def test_texts_from_outside_are_no_markup(capsys: Output) -> None:
    Console(as_json=False, answer_yes=True).message("[bold red]x[/]")
    assert capsys.readouterr().err == "[bold red]x[/]\n"


def test_without_a_terminal_no_question_can_be_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    assert not Console(as_json=False, answer_yes=False).can_ask


def test_the_word_answers_a_question(keyboard: Typed, capsys: Output) -> None:
    assert answered(keyboard, "ye", "s\n") == ("yes", [])
    assert capsys.readouterr().err.startswith('install wheel 1 - type "yes" and Enter')


@pytest.mark.parametrize("typed", ["\n", "y\n", "y  r\n", "yes please\n", "YES\n", "no\n", "wheel 17\n", "\x04"])
def test_nothing_else_does(keyboard: Typed, typed: str) -> None:
    assert answered(keyboard, typed)[0] is None


def test_a_mistake_can_be_taken_back(keyboard: Typed) -> None:
    assert answered(keyboard, "yex\x7fs\r")[0] == "yes"


def test_keys_typed_before_the_question_do_not_count(keyboard: Typed) -> None:
    console, prompts = asking()
    keyboard.waiting = "yes\n"
    console.attend(prompts)
    assert console.commands() == [] and prompts.asked[0].answer is None


def test_both_stops_and_hold_work_while_a_question_is_open_and_letters_go_to_it(keyboard: Typed) -> None:
    assert answered(keyboard, "yr\x18 \x06") == (None, ["stop", "hold", "fast stop"])


def test_a_question_is_put_once(keyboard: Typed, capsys: Output) -> None:
    answered(keyboard, "", "", "")
    assert capsys.readouterr().err.count("install wheel 1") == 1


def test_a_question_is_a_record(keyboard: Typed, capsys: Output) -> None:
    console, prompts = asking()
    console.as_json = True
    console.attend(prompts)
    assert json.loads(capsys.readouterr().out) == {"event": "prompt", "number": 1, "text": "install wheel 1"}


def test_questions_are_answered_in_turn(keyboard: Typed) -> None:
    console, prompts = asking()
    second = prompts.ask(0.0, "clean debris")
    for word in ("yes\n", "yes\n"):
        console.attend(prompts)
        keyboard.waiting = word
        assert second.answer is None
        console.commands()
    assert [prompt.answer for prompt in prompts.asked] == ["yes", "yes"]


class Broken(io.StringIO):
    """A pipe without a reader."""

    def __init__(self) -> None:
        super().__init__()
        self.tries = 0

    def write(self, text: str) -> int:
        self.tries += 1
        raise BrokenPipeError(32, "Broken pipe")


def test_a_closed_reader_is_an_error_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", broken := Broken())
    console = Console(as_json=True, answer_yes=True)
    with pytest.raises(BrokenPipeError):
        console.emit({})
    console.emit({})
    assert broken.tries == 1


def test_messages_still_appear_when_the_data_have_no_reader(monkeypatch: pytest.MonkeyPatch, capsys: Output) -> None:
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


def test_an_output_closed_from_the_start_is_no_error(monkeypatch: pytest.MonkeyPatch, capsys: Output) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    Console(as_json=True, answer_yes=True).result("runs/one")
    assert capsys.readouterr() == ("", "")


def test_a_broken_progress_line_is_noticed_although_a_thread_draws_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setattr(sys, "stderr", Broken())
    console = Console(as_json=False, answer_yes=True)
    console.begin("short")
    try:
        with pytest.raises(BrokenPipeError):
            console.show(0.0, Progress(), RunPosition())
    finally:
        console.end()


def test_a_question_for_a_quantity_shows_the_input_format(keyboard: Typed, capsys: Output) -> None:
    prompts = Prompts(person="anna")
    prompt = prompts.ask(0.0, "install wheel 1", unit="Shore A")
    console = Console(as_json=False, answer_yes=False)
    console.attend(prompts)
    assert 'type a number in Shore A, or with a unit (Shore A), or "yes", and Enter' in capsys.readouterr().err
    keyboard.waiting = "64.5\n"
    console.commands()
    assert (prompt.quantity, prompt.by) == (64.5, "anna")
