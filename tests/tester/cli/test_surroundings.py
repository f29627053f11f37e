"""The commands where something around them is missing: files, permissions, room, a reader, a locale, a terminal."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tester.base.processes import EXIT_READER_GONE
from tester.cli.main import invoke
from tests.tester.store.build import small_run

MAIN = "from tester.cli.main import main; main()"


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder whose runs/ holds one finished run, ``one``, and that has a file and a recipe."""
    monkeypatch.chdir(tmp_path)
    small_run(tmp_path / "runs" / "one")
    (tmp_path / "file").write_text("x")
    return tmp_path


def told(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    """Return exit code and standard error of a command; they contain no errno and no traceback."""
    code = invoke(list(arguments))
    err = capsys.readouterr().err
    assert "[Errno" not in err and "Traceback" not in err
    return code, err


# -- files and permissions ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["export", "one", "--format", "repeats", "--out", "none/a.csv"], 1, "none/a.csv.part: there is no such file"),
        (["export", "one", "--format", "repeats", "--out", "file/a.csv"], 1, "a part of the name is a file"),
        (["run", "quickstart", "--yes", "--out", "file"], 1, "file: it is there already"),
        (["run", "quickstart", "--yes", "--out", "file/runs"], 1, "a part of the name is a file"),
        (["sweep", "quickstart", "--out", "file", "--jobs", "1"], 1, "file: it is there already"),
        (["run", "runs", "--yes"], 2, 'no recipe "runs"'),
        (["check", "none.yaml"], 2, 'no recipe "none.yaml"'),
        (["plan", "quickstart", "--rig", "none.yaml"], 3, "no such file"),
        (["plan", "quickstart", "--rig", "runs"], 3, "not a file"),
        (["rig", "init", "none/rig.yaml"], 2, "there is no such file or folder"),
        (["rig", "init", "file"], 2, "--force replaces it"),
        (["resume", "none"], 2, "no run none"),
        (["verify", "file"], 2, "no run file"),
    ],
)
def test_a_wrong_file_is_reported_with_a_remedy(
    home: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], code: int, words: str
) -> None:
    found, err = told(capsys, *arguments)
    assert (found, words in err) == (code, True), err


def refusing(number: int) -> Callable[..., None]:
    """Return an ``os.mkdir`` that creates nothing."""

    def refuse(path: object, *_arguments: object, **_named: object) -> None:
        raise OSError(number, os.strerror(number), str(path))

    return refuse


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (errno.EACCES, "permission denied: choose a folder of your own"),
        (errno.EROFS, "it lies on a read-only file system: choose another folder"),
        (errno.ENOSPC, "the disk is full: make room"),
    ],
)
def test_a_folder_that_takes_no_run_is_reported(
    home: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, number: int, words: str
) -> None:
    monkeypatch.setattr(os, "mkdir", refusing(number))
    code, err = told(capsys, "run", "quickstart", "--yes", "--out", "locked")
    assert code == 1 and f"locked: {words}" in err


# -- streams ------------------------------------------------------------------------------------------------------


def called(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    """Run a command in a process of its own."""
    command = [sys.executable, "-c", MAIN, *arguments]
    return subprocess.run(command, text=True, timeout=120, check=False, **options)  # type: ignore[call-overload,no-any-return]


@pytest.mark.parametrize("arguments", [["runs"], ["show", "one"], ["plan", "quickstart"], ["schema"]])
def test_a_reader_that_is_gone_ends_a_command_without_a_word(home: Path, arguments: list[str]) -> None:
    read, write = os.pipe()
    os.close(read)
    try:
        done = called(*arguments, stdout=write, stderr=subprocess.PIPE)
    finally:
        os.close(write)
    assert (done.returncode, done.stderr) == (EXIT_READER_GONE, "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize("arguments", [["runs"], ["plan", "quickstart"], ["export", "one", "--format", "repeats"]])
def test_a_disk_that_is_full_under_the_output_fails(home: Path, arguments: list[str]) -> None:
    with Path("/dev/full").open("w") as full:
        done = called(*arguments, stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 1 and "the disk is full: make room" in done.stderr
    assert "Errno" not in done.stderr and "Traceback" not in done.stderr


C_LOCALE = {"LC_ALL": "C", "LANG": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


@pytest.mark.parametrize(
    "arguments", [["show", "one"], ["plan", "quickstart"], ["export", "one", "--format", "appendix"]]
)
def test_a_locale_without_utf_8_changes_no_output(home: Path, arguments: list[str]) -> None:
    usual = {key: value for key, value in os.environ.items() if key != "PYTHONIOENCODING"}
    plain = called(*arguments, capture_output=True, encoding="utf-8", env=usual)
    in_c = called(*arguments, capture_output=True, encoding="utf-8", env=usual | C_LOCALE)
    assert plain.returncode == in_c.returncode == 0
    assert in_c.stdout == plain.stdout and in_c.stdout


def test_a_file_whose_name_is_no_utf_8_is_named(home: Path) -> None:
    done = called("show", os.fsdecode(b"caf\xe9"), capture_output=True, errors="surrogateescape")
    assert done.returncode == 2 and "no run caf" in done.stderr


@pytest.mark.parametrize("arguments", [["runs"], ["show", "one"], ["plan", "quickstart"]])
def test_closed_streams_are_no_trouble(home: Path, arguments: list[str]) -> None:
    def close() -> None:
        for number in (0, 1, 2):
            os.close(number)

    assert called(*arguments, preexec_fn=close).returncode == 0


# -- terminals ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("arguments", [["tui"], ["replay", "one"]])
def test_a_screen_without_a_terminal_is_refused_with_an_alternative(home: Path, arguments: list[str]) -> None:
    done = called(*arguments, capture_output=True, stdin=subprocess.DEVNULL)
    assert done.returncode == 2 and "needs a terminal, and there is none here; `tester s" in done.stderr
    assert "\x1b" not in done.stdout + done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="no pseudo-terminals")
def test_a_terminal_that_places_no_text_is_refused(home: Path) -> None:
    outer, inner = os.openpty()
    try:
        done = called("tui", stdin=inner, stdout=subprocess.PIPE, stderr=inner, env=os.environ | {"TERM": "dumb"})
        assert done.returncode == 2 and b"TERM is dumb" in os.read(outer, 10_000)
    finally:
        os.close(inner)
        os.close(outer)
