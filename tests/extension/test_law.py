"""A laboratory's friction law, one module, named in the rig file."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tester.base.plugins import ALLOW_VARIABLE, plugins
from tester.cli.main import invoke
from tester.kinds import load_rig
from tests.extension.installing import installed
from tests.tester.kinds.wheel_on_belt.bench import SHORT

LAW = "sim.friction_model=lab_law:schallamach"
QUIET = ("--set", "sim.noise=0", "--set", "sim.scatter=0", "--set", "sim.running_in=0")
MU_200_N = 1.1 * 2.0 ** (-1.0 / 9.0)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A laboratory's folder; its module is installed."""
    (tmp_path / "short.yaml").write_text(SHORT, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    with installed("law", tmp_path / "site", monkeypatch):
        yield tmp_path


def test_the_simulated_rig_rubs_by_it(folder: Path) -> None:
    assert invoke(["run", "short.yaml", "--set", LAW, *QUIET, "--yes"]) == 0
    (table,) = folder.glob("runs/*/conditions.csv")
    with table.open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    assert float(row["mu"]) == pytest.approx(MU_200_N, rel=0.01)


def test_it_is_predicted_with(capfd: pytest.CaptureFixture[str]) -> None:
    point = ["--compound", "1#", "--slip", "300 mm/s", "--load", "200 N", "--temperature", "25 degC", "--json"]
    assert invoke(["predict", *point, "--model", "lab_law:schallamach"]) == 0
    assert json.loads(capfd.readouterr().out)["mu"] == pytest.approx(MU_200_N)


def test_a_plan_is_computed_with_the_law(capfd: pytest.CaptureFixture[str]) -> None:
    assert invoke(["plan", "short.yaml", "--set", LAW]) == 0
    own = capfd.readouterr().out
    assert invoke(["plan", "short.yaml"]) == 0
    assert own and own != capfd.readouterr().out


def test_a_rig_file_that_names_it_reads_back_as_the_same() -> None:
    rig = load_rig("sim", [LAW])
    assert rig.sim.friction_model == "lab_law:schallamach"


def test_a_law_that_was_not_allowed_is_refused(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(ALLOW_VARIABLE, "")
    plugins.cache_clear()
    unseen = "sim.friction_model=lab_law:Schallamach"  # no test has loaded this name
    assert invoke(["check", "short.yaml", "--set", unseen]) == 3
    assert "not allowed here" in capfd.readouterr().err
