"""Packages that serve every kind of machine have no word of one in their names; each class name is unique."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tester.base.quantities import LAST, TIME
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES

ROOT = Path(__file__).parents[1]
WORDS = ("wheel", "belt", "slip", "jacket", "hub", "camber")
"""Words only of a wheel on a belt; "sideslip" is found by "slip"."""
EVERY_KIND_S = {TIME, *LAST, "surface_c"}
"""Channels that the types also name; the surface's temperature shows a soak (tester.base.screen.SoakView)."""
CHANNELS = frozenset(QUANTITIES.names) - EVERY_KIND_S
"""The others come from the table, or from their roles in it."""
KINDLESS = (
    "tester/results/catalogue",
    "tester/results",
    "tester/analysis/fit",
    "tester/machine",
    "tester/inputs/recipe",
    "tester/queue",
    "tester/report",
    "tester/service",
    "tester/store",
    "tester/run/sweep",
    "tester/tui",
)
"""Folders that hold no such word. Add a folder once it is clean."""
NAMED_SO = ("tester/results/formats.py", "tester/store/record_schema.py")
"""``wheel.csv`` is the name of a table that a run's folder gets; a soak's ``hub_c`` is a column of its record."""


def names_in(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield line and text of every name and string of a module; docstrings are left out."""
    prose = {
        id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    for node in ast.walk(tree):
        line = getattr(node, "lineno", 0)
        match node:
            case ast.Name(id=text) | ast.Attribute(attr=text) | ast.arg(arg=text) | ast.MatchAs(name=str(text)):
                yield line, text
            case ast.MatchStar(name=str(text)) | ast.MatchMapping(rest=str(text)) | ast.ExceptHandler(name=str(text)):
                yield line, text
            case ast.MatchClass(kwd_attrs=names) | ast.Global(names=names) | ast.Nonlocal(names=names):
                yield from ((line, text) for text in names)
            case ast.FunctionDef(name=text) | ast.AsyncFunctionDef(name=text) | ast.ClassDef(name=text):
                yield line, text
            case ast.keyword(arg=str(text)):
                yield node.value.lineno, text
            case ast.alias(name=text, asname=alias):
                yield line, f"{text} {alias or ''}"
            case ast.ImportFrom(module=str(text)):
                yield line, text
            case ast.Constant(value=str(text)) if id(node) not in prose:
                yield line, text
            case _:
                pass


def wheely(name: str) -> bool:
    """Return whether a name or a text is one of a wheel on a belt."""
    return name in CHANNELS or any(word in name.lower() for word in WORDS)


def test_names_and_strings_are_found_but_no_prose() -> None:
    text = '''
"""A wheel."""
from hubs import one as jacket
class Belt:
    """A belt."""
    slip_m_s: float = 0.0
    """The slip."""
    def turn(self, wheel: int) -> str:
        global belt_mm
        match wheel:
            case Pair(slip_mm=[*hubs_c]):
                return f"camber {self.hub} {call(sideslip_deg=3)}"
'''
    found = {name for _, name in names_in(ast.parse(text)) if wheely(name)}
    assert found == {
        "hubs", "one jacket", "Belt", "slip_m_s", "wheel", "camber ", "hub", "sideslip_deg", "belt_mm", "slip_mm",
        "hubs_c",
    }  # fmt: skip


def test_a_channel_of_the_wheel_is_found_where_it_is_the_whole_name() -> None:
    assert wheely("force_z_n") and not wheely("force_z_n of it") and not wheely("surface_c")


@pytest.mark.parametrize("folder", KINDLESS)
def test_a_package_for_every_machine_names_nothing_of_one(folder: str) -> None:
    wrong = [
        f"{path.relative_to(ROOT)}:{line}: {name}"
        for path in sorted((ROOT / folder).rglob("*.py"))
        if path.relative_to(ROOT).as_posix() not in NAMED_SO
        for line, name in [(0, path.stem), *names_in(ast.parse(path.read_text(encoding="utf-8")))]
        if wheely(name)
    ]
    assert wrong == []


def defined_twice(root: Path, folders: tuple[str, ...] = ("tester", "drivers", "sim")) -> dict[str, list[str]]:
    """Return the class names that are defined more than once in the packages, private ones too, with their places."""
    found: dict[str, list[str]] = {}
    for folder in folders:
        for path in sorted((root / folder).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.ClassDef):
                    found.setdefault(node.name, []).append(f"{path.relative_to(root).as_posix()}:{node.lineno}")
    return {name: places for name, places in sorted(found.items()) if len(places) > 1}


def test_a_class_that_is_defined_twice_is_found_nested_or_private_or_not(tmp_path: Path) -> None:
    (tmp_path / "sim").mkdir()
    (tmp_path / "sim" / "one.py").write_text("class A: ...\nclass _B: ...\nclass C: ...\n", encoding="utf-8")
    (tmp_path / "sim" / "two.py").write_text(
        "class A: ...\ndef f():\n    class _B: ...\n    return C\n", encoding="utf-8"
    )
    assert defined_twice(tmp_path) == {"A": ["sim/one.py:1", "sim/two.py:1"], "_B": ["sim/one.py:2", "sim/two.py:3"]}


def test_class_names_are_unique() -> None:
    assert defined_twice(ROOT) == {}
