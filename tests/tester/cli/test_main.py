"""The root command: names, help, exit codes."""

from __future__ import annotations

import io
import re
import sys
from collections.abc import Iterator

import click
import pytest

from tester.cli import main as cli
from tester.cli.command_table import COMMANDS, SECTIONS, CommandEntry, CommandGroup
from tester.cli.main import invoke


def run(*arguments: str) -> int:
    return invoke(list(arguments))


def stop_here(monkeypatch: pytest.MonkeyPatch, command: click.Command) -> None:
    """Replace every other command by one."""
    monkeypatch.setattr(cli.LazyGroup, "get_command", lambda *_: command)


def every_command() -> Iterator[tuple[tuple[str, ...], CommandEntry]]:
    """Yield each command that is not a group, with its words: ``("bus", "sdo")``."""
    for name, entry in COMMANDS.items():
        if isinstance(entry, CommandGroup):
            yield from (((name, inner), found) for inner, found in entry.commands.items())
        else:
            yield (name,), entry


EVERY = [words for words, _ in every_command()]


def test_help_lists_every_section_with_its_commands(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--help") == 0
    sections = dict(re.findall(r"^(\w[\w' ]*):\n((?:  .*\n)+)", capsys.readouterr().out, re.MULTILINE))
    assert list(sections) == ["Options", *SECTIONS]
    for title, listed in SECTIONS.items():
        lines = [line.split(maxsplit=1) for line in sections[title].splitlines()]
        assert lines == [[name, entry.help] for name, entry in listed.items()]


@pytest.mark.parametrize("group", [name for name, entry in COMMANDS.items() if isinstance(entry, CommandGroup)])
def test_a_group_names_its_commands_in_its_line_and_on_its_page(group: str, capsys: pytest.CaptureFixture[str]) -> None:
    entry = COMMANDS[group]
    assert isinstance(entry, CommandGroup) and run(group, "--help") == 0
    out = capsys.readouterr().out
    assert entry.help.endswith(f": {', '.join(entry.commands)}.")
    assert all(f"  {name} " in out and found.help in out for name, found in entry.commands.items())


@pytest.mark.parametrize("words", EVERY, ids=" ".join)
def test_help_of_every_command_is_reached_through_the_root(
    words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*words, "--help") == 0
    assert capsys.readouterr().out.startswith(f"Usage: tester {' '.join(words)} ")


@pytest.mark.parametrize("name", ["sdo", "params", "eds", "record", "exclude", "include", "slip-ring"])
def test_a_grouped_command_without_its_group_is_a_usage_error_that_names_both(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(name) == 2
    assert re.search(rf"Did you mean (bus|results) {name}\?", capsys.readouterr().err)


def test_version_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--version") == 0
    assert capsys.readouterr().out == "tester 0.1.0\n"


def test_unknown_command_is_a_usage_error(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("frobnicate") == 2
    captured = capsys.readouterr()
    assert captured.out == "" and "frobnicate" in captured.err


def test_unknown_option_is_a_usage_error() -> None:
    assert run("predict", "--frobnicate") == 2


def test_an_invalid_file_exits_3_with_its_problems_on_stderr(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("rig", "show", "--set", "sim.nosie=0") == 3
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.startswith("--set sim.nosie=0:1:1: unknown key")


def test_an_interrupt_exits_130(monkeypatch: pytest.MonkeyPatch) -> None:
    @click.command()
    def interrupted() -> None:
        raise KeyboardInterrupt

    stop_here(monkeypatch, interrupted)
    assert run("run") == 130


def test_the_result_of_a_command_is_the_exit_code(monkeypatch: pytest.MonkeyPatch) -> None:
    @click.command()
    def incomplete() -> int:
        return 6

    stop_here(monkeypatch, incomplete)
    assert run("run") == 6


def test_a_context_that_exits_gives_the_exit_code(monkeypatch: pytest.MonkeyPatch) -> None:
    @click.command()
    @click.pass_context
    def tripped(ctx: click.Context) -> None:
        ctx.exit(5)

    stop_here(monkeypatch, tripped)
    assert run("run") == 5


def test_an_error_of_the_program_is_not_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    @click.command()
    def broken() -> None:
        raise ZeroDivisionError

    stop_here(monkeypatch, broken)
    with pytest.raises(ZeroDivisionError):
        run("run")


def test_a_redirected_stream_is_utf_8(monkeypatch: pytest.MonkeyPatch) -> None:
    raw = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(raw, encoding="cp1252"))
    monkeypatch.setattr(sys, "argv", ["tester", "--version"])
    with pytest.raises(SystemExit):
        cli.main()
    print("Slip Velocity /mm·s⁻¹")
    sys.stdout.flush()
    assert "mm·s⁻¹".encode() in raw.getvalue()


def test_a_mistyped_command_names_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["staus"]) == 2
    assert "No such command 'staus'. Did you mean status?" in capsys.readouterr().err


def test_a_mistyped_recipe_names_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["check", "quikstart"]) == 2
    assert 'no recipe "quikstart", did you mean quickstart?' in capsys.readouterr().err
