"""The section ``interlocks``: made from the rows, so the program's attribute names are checked here."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path

from tester.inputs.rig.config import values_of
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.interlocks.table import PARAMETERS
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.rig.sections import InterlocksConfig

SOURCE = Path(__file__).parents[4] / "tester"
OTHER_KIND = SOURCE / "kinds" / "specimen_on_track"


def asked(tree: ast.AST) -> Iterator[str]:
    """Return the fields of the section that a module reads: directly, or through a name in the same function."""
    for scope in ast.walk(tree):
        if not isinstance(scope, ast.FunctionDef | ast.Module):
            continue
        nodes = list(ast.walk(scope))
        short = {name for node in nodes if isinstance(node, ast.Assign) for name in aliases(node)}
        for node in nodes:
            if isinstance(node, ast.Attribute) and isinstance(scope, ast.FunctionDef):
                of = node.value
                if is_section(of) or (isinstance(of, ast.Name) and of.id in short):
                    yield node.attr


def is_section(node: ast.expr) -> bool:
    """Return whether an expression is a rig's section of interlocks, and not a kind's table."""
    if not (isinstance(node, ast.Attribute) and node.attr == "interlocks"):
        return False
    called = node.value.func if isinstance(node.value, ast.Call) else None
    return called is None or (isinstance(called, ast.Attribute) and called.attr == "of")


def aliases(node: ast.Assign) -> Iterator[str]:
    """Return the names that an assignment gives to the section."""
    for target in node.targets:
        if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
            pairs = zip(target.elts, node.value.elts, strict=True)
            yield from (one.id for one, value in pairs if isinstance(one, ast.Name) and is_section(value))
        elif isinstance(target, ast.Name) and is_section(node.value):
            yield target.id


def test_every_field_that_the_program_asks_for_is_a_parameter() -> None:
    found = {
        (name, path.relative_to(SOURCE).as_posix())
        for path in SOURCE.rglob("*.py") if not path.is_relative_to(OTHER_KIND)
        for name in asked(ast.parse(path.read_text(encoding="utf-8")))
    }
    assert {name for name, _ in found} >= {"max_slip_m_s", "least_diameter_mm", "zero_warn_n", "speeds_old_s"}
    known = {one.name for one in PARAMETERS}
    assert [(name, path) for name, path in sorted(found) if name not in known] == []


def test_the_section_has_a_field_for_every_parameter() -> None:
    assert [one.name for one in fields(InterlocksConfig)] == [one.name for one in PARAMETERS]


def test_the_packaged_file_agrees_with_the_rows() -> None:
    assert values_of(RigConfig.of(load_rig("sim")).interlocks, PARAMETERS) == {one: one.value for one in PARAMETERS}
