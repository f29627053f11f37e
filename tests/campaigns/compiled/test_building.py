"""How the package is built: plain unless FRICTION_TESTER_COMPILE=1 requests a compiled scan, which fails loudly."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip("setuptools", reason="setuptools builds the package, and is not in this environment")

from setuptools import Extension

from compiling import backend, command
from compiling.modules import BUSIEST
from compiling.wanted import VARIABLE, wanted

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize(("value", "compiles"), [("", False), ("0", False), ("1", True)])
def test_the_environment_says_whether_to_compile(value: str, compiles: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, value)
    assert wanted() is compiles


def test_another_value_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "yes")
    with pytest.raises(SystemExit, match="FRICTION_TESTER_COMPILE=yes: expected 1"):
        wanted()


@pytest.mark.parametrize(("value", "asked"), [("0", False), ("1", True)])
def test_only_a_compiled_wheel_asks_for_mypy(value: str, asked: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, value)
    monkeypatch.setattr(backend.build_meta, "get_requires_for_build_wheel", lambda _: ["wheel"])
    assert backend.get_requires_for_build_wheel() == ["wheel", *([backend.COMPILER] if asked else [])]


def test_an_editable_installation_is_never_compiled(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv(VARIABLE, "1")
    with pytest.raises(SystemExit, match="editable installation runs the source"):
        backend.build_editable(str(tmp_path))


def compiler(sources: list[str], *args: object, **options: object) -> list[str]:
    """Replace a compiler's ``compile``."""
    return [f"{Path(source).stem}.o" for source in sources]


@pytest.mark.parametrize("jobs", [1, 2, 5])
def test_objects_come_in_the_order_of_their_sources(
    jobs: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sources = [tmp_path / f"{letter}.c" for letter in "abc"]
    for size, source in enumerate(sources):
        source.write_text("x" * size, encoding="ascii")
    compile_all: Callable[[list[str]], list[str]] = command.side_by_side(compiler, jobs)
    assert compile_all([str(source) for source in sources]) == ["a.o", "b.o", "c.o"]
    assert "friction-tester: 3 of 3 files" in capsys.readouterr().out


def test_sources_are_joined_in_files_of_equal_size_the_busiest_by_themselves(tmp_path: Path) -> None:
    busiest = [command.c_file(name) for name in BUSIEST[: 3 * command.UNITS]]
    rest = [f"__native_{number}.c" for number in range(2 * command.UNITS)]
    for name in (*busiest, *rest, "int_ops.c", "init.c"):
        (tmp_path / name).write_text("x" * 9, encoding="ascii")
    units = [Path(name) for name in command.joined([str(path) for path in tmp_path.iterdir()])]
    included = {unit.name: re.findall(r'#include "(.*)"', unit.read_text(encoding="ascii")) for unit in units}

    def of(kind: str) -> list[list[str]]:
        return [names for unit, names in included.items() if unit.startswith(kind)]

    assert [[len(names) for names in of(kind)] for kind in ("busiest", "rest", "mypyc")] == [
        [3] * command.UNITS, [2] * command.UNITS, [2],
    ]  # fmt: skip
    assert {name for names in of("busiest") for name in names} == set(busiest)
    assert {name for names in of("rest") for name in names} == set(rest)


def test_only_the_rest_is_compiled_with_further_flags(tmp_path: Path) -> None:
    given: dict[str, object] = {}

    def remember(sources: list[str], **options: object) -> list[str]:
        given[Path(sources[0]).name] = options["extra_postargs"]
        return sources

    sources = [tmp_path / name for name in ("busiest_0.c", "rest_0.c")]
    for source in sources:
        source.write_text("", encoding="ascii")
    command.side_by_side(remember, 1, ["-Og"])([str(source) for source in sources], extra_postargs=["-O1"])
    assert given == {"busiest_0.c": ["-O1"], "rest_0.c": ["-O1", "-Og"]}


def test_modules_with_the_same_last_name_do_not_share_a_file() -> None:
    doors = [Extension(name, []) for name in ("a.rig", "a.plant", "b.rig", "c.rig", "c.plant")]
    lists = [[door.name for door in alike] for alike in command.without_namesakes(doors)]
    assert lists == [["a.rig", "a.plant"], ["b.rig", "c.plant"], ["c.rig"]]


def test_entry_functions_of_many_modules_are_in_one_file(tmp_path: Path) -> None:
    file = tmp_path / "doors.c"
    command.write_doors([str(tmp_path / "one.c"), str(tmp_path / "two.c")], file)
    text = file.read_text(encoding="utf-8")
    assert re.findall(r'#include ".*/(\w+)\.c"', text) == ["one", "two"]
    assert len(set(re.findall(r"#define PyInit___init__ (\w+)", text))) == 2


def test_without_a_compiler_the_build_ends_and_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(SystemExit, match="no C compiler") as ended:
        command.require_compiler()
    assert f"Without {VARIABLE} the same program is installed as plain Python" in str(ended.value)


def test_without_mypy_the_build_ends_and_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "mypyc.build", None)
    with pytest.raises(SystemExit, match="mypy is not there"):
        command.translated(tmp_path)


def test_the_back_end_itself_does_not_load_mypy() -> None:
    code = "import sys; from compiling import backend; print(sorted(n for n in sys.modules if n.startswith('mypy')))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
