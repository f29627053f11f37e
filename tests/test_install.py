"""How the installation is measured: what its command reads from the README and from an output."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.campaigns.acceptance.figure import Figure, equal
from tests.campaigns.install import topics
from tests.campaigns.install.__main__ import main
from tests.campaigns.install.place import PASS_S, carry_out, fresh_copy, readme_command
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
def test_a_command_is_reported_with_both_streams_and_its_exit_code(tmp_path: Path) -> None:
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


@posix
def test_an_output_is_read_piece_by_piece_with_its_time(tmp_path: Path) -> None:
    pieces: list[tuple[str, float]] = []
    told = carry_out("echo one; echo two", tmp_path, on_output=lambda piece, at_s: pieces.append((piece, at_s)))
    assert "".join(piece for piece, _ in pieces) == told.text == "one\ntwo\n"
    assert all(0.0 < at_s <= told.wall_s for _, at_s in pieces)


_A_RUN_OF_TESTS = "echo Successfully installed; printf '..F\\n'; exit {}"


@posix
@pytest.mark.parametrize(("code", "missed"), [(0, 0), (1, 1)])
def test_whole_tests_miss_where_one_fails_and_their_output_is_shown(
    code: int, missed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(topics, "fresh_copy", lambda to: tmp_path)
    monkeypatch.setattr(topics, "readme_command", lambda ends: _A_RUN_OF_TESTS.format(code))
    monkeypatch.setattr(topics, "pass_s", lambda interpreter: PASS_S)
    assert main(["tests", "--keep", str(tmp_path / "kept")]) == missed
    printed = capsys.readouterr().out
    assert "Successfully installed\n..F\n" in printed and "ok   tests begin after: 0 s" in printed


@posix
def test_whole_tests_without_a_result_never_began(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(topics, "fresh_copy", lambda to: tmp_path)
    monkeypatch.setattr(topics, "readme_command", lambda ends: "echo Successfully installed")
    monkeypatch.setattr(topics, "pass_s", lambda interpreter: PASS_S)
    (*_, begins) = topics.whole_test_command(tmp_path)
    assert not begins.ok


def test_a_copy_that_is_there_already_is_not_measured_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "tests").mkdir()
    with pytest.raises(SystemExit):
        main(["tests", "--keep", str(tmp_path)])
    assert "it has tests already" in capsys.readouterr().err


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


def test_unmeasurable_figures_miss(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def one(_: Path) -> Iterator[Figure]:
        """Nothing."""
        raise OSError("no package index")
        yield

    monkeypatch.setitem(TOPICS, "main", one)
    assert main(["main"]) == 1 and "no package index" in capsys.readouterr().out
