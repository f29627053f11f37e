"""The truth of a simulated rig: on record on request, and out of reach of the analysis."""

from __future__ import annotations

import ast
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from math import prod
from pathlib import Path

import pytest

from sim.machines.wheel_on_belt.rubbing import WheelSetting, condition_factor
from sim.physics.friction import coefficient
from sim.physics.parameters import SimParameters
from sim.physics.slip import slip_velocity
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.run.sweep.case import Unseen
from tester.store.run_reader import RunReader
from tests.test_names import names_in

ROOT = Path(__file__).parents[3]
RECIPE = """recipe: truth
specimens: [{compound: "1#"}]
measure: {wheel_speed: 0.8 m/s, repeats: 3, window: 10 rev, temperature_band: 2 degC}
grids:
  - {name: one, slip_velocity: 300 mm/s, load: 200 N, temperature: 30 degC}
"""


def run(folder: Path, *overrides: str) -> Path:
    folder.mkdir(parents=True)
    (folder / "recipe.yaml").write_text(RECIPE, encoding="utf-8")
    screen = Unseen()
    options = SessionOptions(str(folder / "recipe.yaml"), "sim", out=folder / "runs", seed=3, overrides=overrides)
    session = screen.session = Session(options, screen)
    session.run()
    assert session.folder is not None, screen.messages
    return session.folder


def truth(folder: Path) -> dict[int, dict[str, float]]:
    found: dict[int, dict[str, float]] = {}
    with closing(sqlite3.connect(folder / "run.db")) as database:
        for repeat, name, value in database.execute("SELECT repeat, name, value FROM truth ORDER BY id"):
            found.setdefault(repeat, {})[name] = value
    return found


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> Path:
    quiet = ("sim.record_truth=true", "sim.noise=0", "sim.running_in=0", "sim.variability.within=0")
    return run(tmp_path_factory.mktemp("told") / "run", *quiet)


def test_each_repeat_has_the_law_at_its_nominal_condition(told: Path) -> None:
    slip_m_s = slip_velocity(0.8, 0.5, 0.0)[2]
    found = truth(told)
    assert found.keys() >= {1, 2}
    assert {one["model"] for one in found.values()} == {coefficient("1#", 30.0, 200.0, slip_m_s)}


def test_the_factors_are_those_that_made_the_coefficients(told: Path) -> None:
    with RunReader(told) as reader:
        measured = {one.repeat: one.result.mu_resultant for one in reader.repeats()}
    for repeat, one in truth(told).items():
        made = prod(one[name] for name in ("model", "condition", "wheel", "run"))
        assert measured[repeat] == pytest.approx(made, rel=5e-3)


def test_repeats_share_condition_and_wheel_and_have_runs_of_their_own(told: Path) -> None:
    first, second = (truth(told)[repeat] for repeat in (1, 2))
    assert (first["condition"], first["wheel"]) == (second["condition"], second["wheel"])
    assert first["run"] != second["run"]


def test_the_condition_has_the_factor_of_its_setting(told: Path) -> None:
    of_setting = condition_factor(SimParameters(), 3, "1#", WheelSetting(0.3, 200.0, (0.0, 0.0), 30.0))
    assert {one["condition"] for one in truth(told).values()} == {of_setting}


def test_nothing_is_recorded_by_default_and_the_tables_are_the_same(told: Path, tmp_path: Path) -> None:
    silent = run(tmp_path / "run", "sim.noise=0", "sim.running_in=0", "sim.variability.within=0")
    assert truth(silent) == {}
    for name in ("appendix.csv", "conditions.csv", "budget.csv", "repeats.csv"):
        assert (silent / name).read_bytes() == (told / name).read_bytes()


def _names(folder: str) -> Iterator[str]:
    for path in sorted((ROOT / folder).rglob("*.py")):
        yield from (name for _, name in names_in(ast.parse(path.read_text(encoding="utf-8"))))


@pytest.mark.parametrize("folder", ["tester/analysis", "tester/results", "tester/run/sweep"])
def test_reduction_and_export_know_no_truth(folder: str) -> None:
    assert [name for name in _names(folder) if "truth" in name.lower()] == []


def test_a_reader_has_no_way_to_it() -> None:
    assert [name for name in dir(RunReader) if "truth" in name] == []
    tree = ast.parse((ROOT / "tester/store/run_reader.py").read_text(encoding="utf-8"))
    assert [name for _, name in names_in(tree) if "truth" in name] == []
