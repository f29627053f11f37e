"""How many files an addition takes: by a maintainer inside the product, by a user outside it.

Inside: the source files that name a given axis of a condition, or a given channel, are those that one more would touch.
A name counts wherever a program sees it, as an identifier or in a text; prose (comments, docstrings) does not. Beside:
the files of each example in ``tests/extension/examples``, which are all outside the product.
``python -m tests.extension.counts`` prints the files, and fails where there are more than there are to be.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FROZEN = ("tester/kinds/wheel_on_belt/papers/machine.py",)
"""Files that a new axis or channel does not change: values from a published paper."""
SOURCES = ("tester", "drivers", "sim", "recipes")
_DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


@dataclass(frozen=True, slots=True)
class Count:
    """A name to be counted: its meaning, and the maximum number of files with it."""

    what: str
    name: str
    at_most: int


COUNTS = (Count("axis", "camber", 9), Count("channel", "moment_z_nm", 8))


EXAMPLES = ROOT / "tests" / "extension" / "examples"
AT_MOST = {"sensor": 3, "drive": 3, "axis": 2, "interlock": 1, "format": 2, "law": 1, "kind": 15}
"""Files of an example, by its folder: an axis is inside a kind, an interlock is with its fault."""


def files_of(example: str) -> list[Path]:
    """Return the files of an example, without compiled Python."""
    found = (EXAMPLES / example).rglob("*")
    return sorted(path.relative_to(EXAMPLES) for path in found if path.is_file() and path.suffix != ".pyc")


def words_in(source: str) -> Iterator[str]:
    """Yield the identifiers and texts of a Python source; docstrings, of attributes too, are left out."""
    tree = ast.parse(source)
    prose: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, _DOCUMENTED):
            prose |= {id(one.value) for one in node.body if isinstance(one, ast.Expr)}
    for node in ast.walk(tree):
        match node:
            case ast.Constant(value=str() as text) if id(node) not in prose:
                yield text
            case ast.Name(id=name) | ast.Attribute(attr=name) | ast.arg(arg=name) | ast.keyword(arg=str() as name):
                yield name
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
                yield name
            case ast.alias(name=name, asname=other):
                yield f"{name} {other or ''}"
            case _:
                pass


def files_naming(name: str, root: Path = ROOT) -> list[Path]:
    """Return the source files with a name, alone or as a part of a longer one (``camber_deg``)."""
    wanted = re.compile(rf"(?<![a-z]){re.escape(name)}(?![a-z])", re.IGNORECASE)
    found: list[Path] = []
    for folder in SOURCES:
        for path in sorted((root / folder).rglob("*.py")):
            if path.relative_to(root).as_posix() in FROZEN:
                continue
            source = path.read_text("utf-8")
            if wanted.search(source) and any(wanted.search(word) for word in words_in(source)):
                found.append(path.relative_to(root))
    return found


def main() -> int:
    """Print the counts; return 1 where a count is above its bound."""
    missed = False
    for count in COUNTS:
        files = files_naming(count.name)
        missed = missed or len(files) > count.at_most
        print(f"{count.what} {count.name}: {len(files)} files (at most {count.at_most})")
        for path in files:
            print(f"  {path.as_posix()}")
    for example, at_most in AT_MOST.items():
        files = files_of(example)
        missed = missed or not 0 < len(files) <= at_most
        print(f"example {example}: {len(files)} files (1 to {at_most})")
        for path in files:
            print(f"  {path.as_posix()}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
