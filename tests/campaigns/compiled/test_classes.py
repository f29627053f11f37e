"""A Python class inherits from a compiled one only where that is allowed: the plain source would never show an
error."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import NamedTuple

from compiling.modules import HOT

ROOT = Path(__file__).parents[3]
STAYS_PYTHON = {"Protocol", "Enum", "IntEnum", "IntFlag", "Flag", "NamedTuple", "TypedDict", "Exception"}
"""Bases that keep a class of a compiled module a Python class, so that others may inherit from it."""
ALLOWED = "mypyc_attr(allow_interpreted_subclasses=True)"
"""The mark of the bases of kinds of rigs of a laboratory's own."""


def compiled() -> set[str]:
    """Return the names of the modules that are compiled."""
    return {module_of(ROOT / name) for name in HOT}


def test_every_module_that_is_named_is_there() -> None:
    assert [name for name in HOT if not (ROOT / name).is_file()] == []


def module_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


class Found(NamedTuple):
    """A class of the product; bases as they are imported: module.name."""

    module: str
    bases: list[str]
    marks: list[str]


def classes() -> dict[str, Found]:
    """Return every class of the product."""
    found: dict[str, Found] = {}
    for folder in ("tester", "drivers", "sim", "recipes"):
        for path in (ROOT / folder).rglob("*.py"):
            tree, module = ast.parse(path.read_text(encoding="utf-8")), module_of(path)
            names = {
                alias.asname or alias.name: f"{node.module}.{alias.name}"
                for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module
                for alias in node.names
            }  # fmt: skip
            for node in ast.walk(tree):
                if isinstance(node, ast.ClassDef):
                    bases = [base.value if isinstance(base, ast.Subscript) else base for base in node.bases]
                    written = [names.get(b, f"{module}.{b}") for b in map(ast.unparse, bases)]
                    found[f"{module}.{node.name}"] = Found(module, written, list(map(ast.unparse, node.decorator_list)))
    return found


def from_compiled() -> list[tuple[str, str, dict[str, Found]]]:
    """Return each Python class with a compiled base."""
    known, hot = classes(), compiled()
    motions = "tester.machine.motions"
    assert motions in hot and f"{motions}.Move" in known

    def native(name: str) -> bool:
        one = known.get(name)
        return one is not None and one.module in hot and not STAYS_PYTHON & {b.rpartition(".")[2] for b in one.bases}

    return [(name, base, known) for name, one in known.items() if one.module not in hot for base in one.bases
            if native(base)]  # fmt: skip


def test_a_class_that_stays_python_inherits_from_a_compiled_one_only_where_that_is_allowed() -> None:
    found = from_compiled()
    assert "tester.machine.plain.control.PlainControl" in {name for name, _, _ in found}
    assert [f"{name} from {base}" for name, base, known in found if ALLOWED not in known[base].marks] == []


def test_a_dataclass_of_a_compiled_one_does_not_hide_its_fields() -> None:
    made = {name: marks for name, _, known in from_compiled() if (marks := known[name].marks)}
    assert made["tester.machine.plain.image.PlainReadings"] == ["derivable"]
    assert {name: marks for name, marks in made.items() if any(mark.startswith("dataclass") for mark in marks)} == {}
