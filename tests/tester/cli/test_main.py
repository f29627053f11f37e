"""The root command: names, help, exit codes."""

from __future__ import annotations

import io
import sys

import click
import pytest

from tester.cli import main as cli
from tester.cli.main import COMMANDS, invoke, root


def run(*arguments: str) -> int:
    return invoke(list(arguments))


def stop_here(monkeypatch: pytest.MonkeyPatch, command: click.Command) -> None:
    """Put a command in the place of every other."""
    monkeypatch.setattr(cli.LazyGroup, "get_command", lambda *_: command)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_listed_command_is_there(name: str) -> None:
    with click.Context(root) as ctx:
        command = root.get_command(ctx, name)
    assert (isinstance(command, click.Command) and command.callback) or isinstance(command, click.Group)


def test_help_lists_every_command_with_its_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--help") == 0
    out = capsys.readouterr().out
    assert all(f"  {name} " in out and entry.help in out for name, entry in COMMANDS.items())


@pytest.mark.parametrize("name", COMMANDS)
def test_help_of_every_command_is_reached_through_the_root(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(name, "--help") == 0
    assert capsys.readouterr().out.startswith(f"Usage: tester {name} ")


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


def test_what_a_command_returns_is_the_exit_code(monkeypatch: pytest.MonkeyPatch) -> None:
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
