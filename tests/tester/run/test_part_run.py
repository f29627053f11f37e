"""Work of a run before its first scan, so that no scan waits for it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.tester.kinds.wheel_on_belt.bench import AT_ONCE

ROOT = Path(__file__).parents[3]
WATCHED = """
import sys
from tester.machine.engine import Engine

tick, late = Engine.tick, set()

def watched(engine, now):
    before = set(sys.modules)
    later = tick(engine, now)
    late.update(set(sys.modules) - before)
    return later

Engine.tick = watched
from tester.cli.main import invoke
code = invoke(["run", sys.argv[1], "--yes", "--out", sys.argv[2]])
print("late:", *sorted(late))
raise SystemExit(code)
"""


def test_no_scan_loads_a_module(tmp_path: Path) -> None:
    recipe = tmp_path / "recipe.yaml"
    recipe.write_text(AT_ONCE, encoding="utf-8")
    run = subprocess.run(
        [sys.executable, "-c", WATCHED, str(recipe), str(tmp_path / "runs")],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (run.returncode, run.stdout.splitlines()[-1]) == (0, "late:")
