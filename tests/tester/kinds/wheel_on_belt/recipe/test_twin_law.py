"""Compounds of a recipe on the simulated wheel: the law of a file, an assumed one, and compounds without one."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.recipe.twin_law import twin_law
from tester.kinds.wheel_on_belt.rig import RigConfig
from tests.tester.kinds.wheel_on_belt.bench import SHORT

QUIET = ("--set", "sim.noise=0", "--set", "sim.scatter=0", "--set", "sim.running_in=0")
POWER = "name: own\nlaw: {form: power, figures: {a: 0.6, v0: 300 mm/s, n: 0.2, n0: 200 N, m: -0.1}}\n"
POINT = ("--slip", "300 mm/s", "--load", "200 N", "--temperature", "25 degC")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "compounds").mkdir()
    (tmp_path / "r.yaml").write_text(SHORT.replace('"1#"', "own"), encoding="utf-8")
    return tmp_path


def described(folder: Path, text: str) -> None:
    (folder / "compounds" / "own.yaml").write_text(text, encoding="utf-8")


def errors(capsys: pytest.CaptureFixture[str], *arguments: str, code: int) -> str:
    assert invoke([*arguments]) == code
    return capsys.readouterr().err


def measured(folder: Path) -> tuple[float, list[str]]:
    """Return the coefficient of the only run, and the doubts in its record."""
    (database,) = folder.glob("runs/*/run.db")
    (table,) = folder.glob("runs/*/appendix.csv")
    with sqlite3.connect(database) as record:
        told = [text for (text,) in record.execute("select text from event where kind = 'doubt'")]
    return float(table.read_text(encoding="utf-8").splitlines()[1].split(",")[-1]), told


def test_a_run_rubs_by_the_law_of_the_compounds_file(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    described(folder, POWER)
    assert errors(capsys, "check", "r.yaml", code=0).count("assumed") == 0
    assert invoke(["run", "r.yaml", *QUIET, "--yes"]) == 0
    assert measured(folder) == (0.6, [])


def test_a_law_that_is_assumed_is_a_doubt_on_record(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    told = errors(capsys, "check", "r.yaml", code=0)
    assert "r.yaml:3:15: compound: the simulated wheel's law of 'own' is assumed, not known: it rubs as 1# does" in told
    assert invoke(["run", "r.yaml", *QUIET, "--yes"]) == 0
    mu, doubts = measured(folder)
    law = twin_law(RigConfig.of(load_rig("sim")), "1#")
    assert mu == pytest.approx(law.mu(25.0, 200.0, 0.3), abs=0.01)
    assert len(doubts) == 1 and "assumed, not known" in doubts[0]


def test_a_name_close_to_a_known_one_is_asked_about(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "r.yaml").write_text(SHORT.replace('"1#"', '"1 #"'), encoding="utf-8")
    assert "did you mean 1#?" in errors(capsys, "check", "r.yaml", code=0)


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ("{form: power, figures: {v0: 300}}", 'figures: v0: 300 has no unit (expected a speed such as "0.8 m/s"'),
        ("{form: power, figures: {mu: 1}}", "figures: law power has no mu (expected a, v0, n, n0, m)"),
        ("{form: v2, figures: {a: 1}}", "law 'v2' takes the figures a, beta, tm, c, k, b2, a2, all of them, not a"),
        ("{form: powre, figures: {a: 1}}", "form"),
    ],
)
def test_mistakes_in_a_law_are_refused_at_their_line(
    folder: Path, capsys: pytest.CaptureFixture[str], law: str, message: str
) -> None:
    described(folder, f"name: own\nlaw: {law}\n")
    found = errors(capsys, "materials", "check", "compounds/own.yaml", code=3)
    assert ":2:" in found and message in found


def test_a_law_without_a_coefficient_somewhere_on_a_wheel_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    figures = "{a: -3, beta: 0.002 1/K2, tm: 68 degC, c: 0.3, k: -0.4, b2: 1.3, a2: 0.4}"
    described(folder, f"name: own\nlaw: {{form: v2, figures: {figures}}}\n")
    told = errors(capsys, "check", "r.yaml", code=3)
    assert "the simulated wheel has no friction" in told and "(expected at least 0)" in told


def test_friction_too_low_for_the_first_contact_is_a_doubt(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    described(folder, "name: own\nlaw: {form: power, figures: {a: 0.05, n: 0.1, m: 0}}\n")
    assert "too little for the first contact to show" in errors(capsys, "check", "r.yaml", code=0)


def test_a_law_of_materials_needs_moduli_and_a_surface(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    described(folder, "name: own\nmoduli: {constant: {G: 2 MPa, loss_factor: 0.3}}\n")
    model = ("--set", "sim.friction_model=persson")
    assert "needs a surface" in errors(capsys, "check", "r.yaml", *model, code=3)
    with (folder / "r.yaml").open("a", encoding="utf-8") as file:
        file.write("abrasive: {name: concrete}\n")
    errors(capsys, "check", "r.yaml", *model, code=0)
    described(folder, "name: own\n")
    assert "holds no moduli" in errors(capsys, "check", "r.yaml", *model, code=3)


def test_a_prediction_takes_the_law_of_a_file(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    described(folder, POWER)
    assert invoke(["predict", "--compound", "own", *POINT]) == 0
    assert capsys.readouterr().out == "0.60000\n"
    assert "no friction model for compound 'none'" in errors(capsys, "predict", "--compound", "none", *POINT, code=2)
