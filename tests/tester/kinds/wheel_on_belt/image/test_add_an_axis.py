"""The second half of "How to add an axis", followed word by word in a copy of the tree: a drive holds the axis."""

from __future__ import annotations

import csv
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[5]
PAGE = ROOT / "docs" / "how-to" / "add-an-axis.md"
STEP = re.compile(r'<!-- before "(?P<place>[^\n]+)" in (?P<path>\S+) -->\n```\w+\n(?P<text>.*?)```', re.DOTALL)
TESTER = "from tester.cli.main import main; main()"
RECIPE = """\
recipe: toe
specimens: [{compound: "1#"}]
measure: {wheel_speed: 0.8 m/s, repeats: 3, window: 10 rev, temperature_band: 2 degC}
grids:
  - {name: toe, toe: [0 deg, 2 deg], slip_velocity: 300 mm/s, load: 200 N, temperature: 40 degC}
"""


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of the tree with the page's changes."""
    tree = tmp_path_factory.mktemp("tree")
    for name in ("tester", "drivers", "sim", "recipes"):
        shutil.copytree(ROOT / name, tree / name, ignore=shutil.ignore_patterns("__pycache__", "*.so", "*.pyd"))
    steps = list(STEP.finditer(PAGE.read_text(encoding="utf-8")))
    table = "tester/kinds/wheel_on_belt/image/axes.py"
    assert [step["path"] for step in steps] == [table, "sim/rig.yaml", "sim/rig.yaml"]
    for step in steps:
        path, place = tree / step["path"], step["place"].replace('\\"', '"').replace("\\n", "\n")
        text = path.read_text(encoding="utf-8")
        assert text.count(place) == 1, f"{place!r} stands {text.count(place)} times in {path}"
        path.write_text(text.replace(place, step["text"] + place), encoding="utf-8")
    (tree / "toe.yaml").write_text(RECIPE, encoding="utf-8")
    return tree


def said_by(tree: Path, *arguments: str) -> tuple[int, str]:
    """Run `tester` in the copy; return its exit code and all its output."""
    environment = {
        **os.environ, "PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1",
        "TESTER_RUNTIME_DIR": str(tree / "runtime"),
    }  # fmt: skip
    command = [sys.executable, "-c", TESTER, *arguments]
    done = subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def test_a_drive_holds_the_axis_and_the_tables_have_it(tree: Path) -> None:
    code, said = said_by(tree, "run", "toe.yaml", "--yes", "--out", "runs")
    assert code == 0, said
    (table,) = (tree / "runs").glob("*/appendix.csv")
    straight, turned = csv.DictReader(table.read_text(encoding="utf-8-sig").splitlines())
    assert (straight["Toe Angle /°"], turned["Toe Angle /°"]) == ("0", "2")
    (table,) = (tree / "runs").glob("*/repeats.csv")
    rows = list(csv.DictReader(table.read_text(encoding="utf-8-sig").splitlines()))
    assert {(row["toe_deg"], row["measured_toe_deg"]) for row in rows} == {("0", "0"), ("2", "2")}


def test_a_rig_without_the_drive_holds_only_zero(tree: Path) -> None:
    code, said = said_by(tree, "check", "toe.yaml", "--set", "axes.toe={manual: true}")
    assert code == 3 and "toe" in said and "drive" in said


def test_its_limit_is_the_rig_file_s(tree: Path) -> None:
    code, said = said_by(tree, "check", "toe.yaml", "--set", "limits.toe=1 deg")
    assert code == 3 and "toe: 2 deg is more than the rig allows" in said


def test_other_recipes_do_not_notice(tree: Path) -> None:
    code, said = said_by(tree, "plan", "quickstart")
    assert code == 0 and "toe" not in said
