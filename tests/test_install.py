"""How the installation is measured: what its command reads off the README and off an output."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.campaigns.acceptance.figure import Figure, equal
from tests.campaigns.install.__main__ import main
from tests.campaigns.install.place import carry_out, fresh_copy, readme_command
from tests.campaigns.install.topics import TOPICS, differing, interpreter

posix = pytest.mark.skipif(os.name != "posix", reason="the README's POSIX commands are measured, by bash")


@pytest.mark.parametrize("ends", ["run quickstart --yes", "/pytest"])
def test_the_readme_has_the_commands_that_are_measured(ends: str) -> None:
    assert readme_command(ends).startswith("python3 -m venv .venv && ")


def test_a_command_that_the_readme_lacks_is_named() -> None:
    with pytest.raises(LookupError, match="run nothing"):
        readme_command("run nothing")


def test_a_copy_has_the_sources_and_no_environment(tmp_path: Path) -> None:
    copy = fresh_copy(tmp_path / "copy")
    assert (copy / "pyproject.toml").is_file() and (copy / "compiling" / "backend.py").is_file()
    assert not (copy / ".venv").exists() and not (copy / ".git").exists()


@posix
def test_a_command_is_told_with_both_streams_and_its_exit_code(tmp_path: Path) -> None:
    told = carry_out("echo one; echo two >&2; exit 3", tmp_path)
    assert (told.code, told.text) == (3, "one\ntwo\n") and told.cpu_s > 0.0


@posix
def test_a_command_is_ended_where_enough_is_seen(tmp_path: Path) -> None:
    told = carry_out("echo begun; exec cat /dev/zero", tmp_path, until=lambda text: "begun" in text)
    assert told.code is None and told.text.startswith("begun")


@posix
def test_no_cache_and_no_wish_to_compile_is_handed_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FRICTION_TESTER_COMPILE", "1")
    told = carry_out("echo $PIP_NO_CACHE_DIR-$FRICTION_TESTER_COMPILE-", tmp_path)
    assert told.text == "1--\n"


def test_files_that_differ_are_named() -> None:
    assert differing({"a": "1", "b": "1"}, {"a": "1", "b": "2", "c": "1"}) == ["b", "c"]


@posix
def test_an_interpreter_that_is_not_there_is_none() -> None:
    assert interpreter("3.0") is None


@pytest.mark.parametrize(("value", "code", "mark"), [(1, 0, "ok"), (2, 1, "MISS")])
def test_the_exit_code_is_1_where_a_figure_misses(
    value: int, code: int, mark: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def one(_: Path) -> Iterator[Figure]:
        """One figure."""
        yield equal("figure", value, 1)

    monkeypatch.setitem(TOPICS, "main", one)
    assert main(["main"]) == code
    assert any(line.startswith(f"{mark} ".ljust(5)) for line in capsys.readouterr().out.splitlines())


def test_what_cannot_be_measured_misses(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def one(_: Path) -> Iterator[Figure]:
        """Nothing."""
        raise OSError("no package index")
        yield

    monkeypatch.setitem(TOPICS, "main", one)
    assert main(["main"]) == 1 and "no package index" in capsys.readouterr().out
