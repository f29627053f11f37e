"""The counter of the tree's figures counts correctly."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.campaigns.house import Figure, code_lines, figures, functions, in_circles, repeated

SOURCE = '''"""What a module holds."""

import os

LIMIT = 3
"""A docstring behind a constant."""


def far() -> str:
    """Return a text."""
    # a comment
    return """two
    lines"""  # with a comment
'''


def test_blank_lines_comments_and_docstrings_are_no_code() -> None:
    assert code_lines(SOURCE) == 5  # import, LIMIT, def, and a return of two lines


def test_a_function_is_as_long_as_its_text() -> None:
    assert list(functions(SOURCE)) == [("far", 5)]


@pytest.mark.parametrize(
    ("paths", "names"),
    [
        (("tester/run/plan.py", "tester/tui/plan.py"), ["plan.py"]),
        (("tester/kinds/a/recipe/steps.py", "tester/kinds/b/recipe/steps.py"), []),
        (("tester/kinds/a/recipe/steps.py", "tester/kinds/b/steps.py"), ["steps.py"]),
        (("sim/machines/a/rig.py", "sim/machines/b/rig.py", "sim/rig.py"), ["rig.py"]),
    ],
)
def test_a_name_repeats_unless_one_kind_mirrors_another(paths: tuple[str, ...], names: list[str]) -> None:
    assert list(repeated(Path(path) for path in paths)) == names


def test_long_files_and_functions_are_counted_and_small_ones_but_for_the_page_of_a_folder() -> None:
    long = "def far() -> None:\n" + "    print()\n" * 400
    counted = figures({Path("sim/far.py"): long, Path("sim/near.py"): SOURCE, Path("sim/__init__.py"): ""})
    assert [figure.count for figure in counted] == [406, 414, 3, 1, 0, 0, 1, 1]


def test_a_circle_of_imports_is_found_behind_a_function_and_for_types() -> None:
    sources = {
        Path("sim/wires.py"): "if TYPE_CHECKING:\n    from sim.rig import Rig",
        Path("sim/rig.py"): "from sim import wires, noise",
        Path("sim/noise.py"): "def late():\n    import sim.wires",
        Path("sim/__init__.py"): "from sim.rig import Rig",
    }
    assert in_circles(sources) == [Path("sim/noise.py"), Path("sim/rig.py"), Path("sim/wires.py")]


@pytest.mark.parametrize(("limit", "misses"), [(None, False), (3, False), (2, True)])
def test_a_figure_misses_above_its_limit(limit: int | None, misses: bool) -> None:
    assert Figure("files", 3, limit).misses is misses
