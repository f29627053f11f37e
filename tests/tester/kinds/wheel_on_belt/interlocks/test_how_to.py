"""The page "How to add an interlock" is followed word by word in a copy of the tree, and the row works there."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[5]
PAGE = ROOT / "docs" / "how-to" / "add-an-interlock.md"
STEP = re.compile(r'<!-- before "(?P<place>[^\n]+)" in (?P<path>\S+) -->\n```python\n(?P<text>.*?)```', re.DOTALL)
ROW = "rubber hotter than hub"


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of the tree with the page's changes; skip where the tree has them already."""
    if ROW in (ROOT / "tester/kinds/wheel_on_belt/interlocks/surface.py").read_text(encoding="utf-8"):
        pytest.skip("the page has been followed in this tree")
    tree = tmp_path_factory.mktemp("tree")
    for name in ("tester", "drivers", "sim", "recipes", "tests", "docs"):
        shutil.copytree(ROOT / name, tree / name, ignore=shutil.ignore_patterns("__pycache__", "golden", "pictures"))
    shutil.copy(ROOT / "pyproject.toml", tree)
    steps = list(STEP.finditer(PAGE.read_text(encoding="utf-8")))
    assert len({step["path"] for step in steps}) == 3 and len(steps) == 5
    for step in steps:
        path, place = tree / step["path"], step["place"].replace('\\"', '"')
        text = path.read_text(encoding="utf-8")
        assert text.count(place) == 1, f"{place!r} stands {text.count(place)} times in {path}"
        path.write_text(text.replace(place, step["text"] + place), encoding="utf-8")
    run(tree, "docs/interlocks.py")
    return tree


def run(tree: Path, *arguments: str) -> str:
    """Run Python in the copy; return its output."""
    environment = {**os.environ, "PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, *arguments], cwd=tree, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_tables_and_rig_file_have_the_row(tree: Path) -> None:
    assert f"| {ROW} |" in (tree / "docs" / "kinds" / "wheel-on-belt.md").read_text(encoding="utf-8")
    assert "  surface_excess: 20 K  " in (tree / "sim" / "rig.yaml").read_text(encoding="utf-8")


def test_the_tests_of_rows_hold_for_it(tree: Path) -> None:
    here = "tests/tester/kinds/wheel_on_belt"
    which = (f"{here}/interlocks/test_table.py", f"{here}/control/test_interlocks.py")
    mine = "hotter or surface_excess or every_row or jacket"
    said = run(tree, "-m", "pytest", "-p", "no:cacheprovider", *which, "-k", mine)
    assert "passed" in said


@pytest.mark.campaign
def test_its_fault_trips_it_first(tree: Path) -> None:
    module = "tests.campaigns.faults.first_up"
    look = f"from {module} import *; print(*conduct(r for r in FIRST if r.interlock == {ROW!r}).values())"
    assert run(tree, "-c", look).strip() == ROW
