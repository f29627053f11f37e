"""No class that stays Python inherits from a compiled one: a test that runs the source would never see it."""

from __future__ import annotations

import ast
from pathlib import Path

from compiling.modules import HOT

ROOT = Path(__file__).parents[3]
STAYS_PYTHON = {"Protocol", "Enum", "IntEnum", "IntFlag", "Flag", "NamedTuple", "TypedDict", "Exception"}
"""Bases that keep a class of a compiled module a Python class, which may be inherited from."""
FOR_STRANGERS = "tester.machine.plain."
"""What kinds of rigs of a laboratory's own inherit from: they need an uncompiled installation (decision 19)."""


def compiled() -> set[str]:
    """Return the names of the modules that are compiled."""
    return {module_of(path) for pattern in HOT for path in ROOT.glob(pattern)}


def test_every_module_that_is_named_is_there() -> None:
    assert [pattern for pattern in HOT if not list(ROOT.glob(pattern))] == []


def module_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


def classes() -> dict[str, tuple[str, list[str]]]:
    """Return (module, bases) of every class of the product, bases as they are imported: module.name."""
    found: dict[str, tuple[str, list[str]]] = {}
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
                    written = [ast.unparse(base) for base in bases]
                    found[f"{module}.{node.name}"] = (module, [names.get(b, f"{module}.{b}") for b in written])
    return found


def test_no_class_that_stays_python_inherits_from_a_compiled_one() -> None:
    known, hot = classes(), compiled()
    motions = "tester.machine.motions"
    assert motions in hot and f"{motions}.Move" in known

    def native(name: str) -> bool:
        module, bases = known.get(name, ("", []))
        return module in hot and not any(base.rpartition(".")[2] in STAYS_PYTHON for base in bases)

    wrong = [
        f"{name} ({module}) inherits from {base}"
        for name, (module, bases) in known.items() if module not in hot and not module.startswith(FOR_STRANGERS)
        for base in bases if native(base)
    ]  # fmt: skip
    assert wrong == []
