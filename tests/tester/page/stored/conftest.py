"""A short run on the simulated rig, made once."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.cli.main import invoke

RECIPE = """\
recipe: short
specimens: [{compound: "1#"}]
measure: {wheel_speed: 0.8 m/s, repeats: 3, window: 5 rev, temperature_band: 2 degC}
grids:
  - {name: one, slip_velocity: [200 mm/s, 300 mm/s], load: [100 N], temperature: [25 degC]}
"""


@pytest.fixture(scope="package")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with one run."""
    folder = tmp_path_factory.mktemp("page")
    (folder / "short.yaml").write_text(RECIPE, encoding="utf-8")
    invoke(["run", str(folder / "short.yaml"), "--yes", "--seed", "1", "--out", str(folder / "runs")])
    return folder / "runs"


@pytest.fixture(scope="package")
def run(runs: Path) -> Path:
    """Return the run's folder."""
    return next(runs.glob("2*"))
