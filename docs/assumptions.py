"""Print every engineering assumption of the code, marked [A] there, with its place, name and value.

``python docs/assumptions.py > FILE`` makes a page of them.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("tester", "drivers", "sim")
MARK = "[A]"
HEAD = f"""# Assumptions

Every engineering assumption in the code, marked {MARK} there: plausible, not measured on this machine. Those of a rig
file are beside its keys.

"""


def page_text() -> str:
    """Return the page."""
    lines: list[str] = []
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*.py")):
            found = list(marked(path.read_text(encoding="utf-8")))
            if found:
                lines += [f"## {path.relative_to(ROOT).as_posix()}", "", "| name | value | text |", "|---|---|---|"]
                lines += [f"| {' | '.join(map(cell, one))} |" for one in found] + [""]
    return HEAD + "\n".join(lines)


def marked(source: str) -> Iterator[tuple[str, str, str]]:
    """Yield name, value and the line of text of every assumption of a module, in its order."""
    if MARK not in source:
        return
    statements = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.stmt)]
    for number, line in enumerate(source.splitlines(), start=1):
        if MARK in line:
            name, value = named(statements, source, number)
            yield name, value, line.strip().removeprefix('"""').removesuffix('"""').rpartition("  # ")[2]


def named(statements: list[ast.stmt], source: str, line: int) -> tuple[str, str]:
    """Return what a line speaks of: the assignment it is part of, or the one that its text stands below."""
    here = [one for one in statements if one.lineno <= line <= (one.end_lineno or one.lineno)]
    inner = min(here, key=lambda one: (one.end_lineno or one.lineno) - one.lineno, default=None)
    if isinstance(inner, ast.Expr) and isinstance(inner.value, ast.Constant):  # the text below
        before = [one for one in statements if one.end_lineno is not None and one.end_lineno < inner.lineno]
        inner = max(before, key=lambda one: (one.end_lineno or 0, one.lineno), default=None)
    if isinstance(inner, ast.AnnAssign | ast.Assign):
        target = inner.target if isinstance(inner, ast.AnnAssign) else inner.targets[0]
        value = ast.get_source_segment(source, inner.value) if inner.value is not None else None
        return ast.unparse(target), " ".join((value or "").split())[:60]
    return getattr(inner, "name", ""), ""


def cell(text: str) -> str:
    """Return a text as a cell of a table."""
    return text.replace("|", "\\|")


if __name__ == "__main__":
    sys.stdout.reconfigure(encoding="utf-8")
    print(page_text(), end="")
