"""A law kept by a fit: its file, and the commands that take it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tester.analysis.fit.fit_law import FitError, FitPoint, Source
from tester.analysis.fit.joint import fit_group
from tester.cli.keep_law import data_hash, kept_model
from tester.cli.main import invoke
from tester.inputs.kept_laws.law_value import KeptLaw, load_law
from tester.kinds.wheel_on_belt.fit.fits import FITS
from tester.kinds.wheel_on_belt.fit.laws import PAPER, V2_LAW
from tester.kinds.wheel_on_belt.fit.run_data import run_points
from tests.campaigns.fit.synthetic import DESIGN
from tests.tester.inputs.kept_laws.kept_example import example_text
from tests.tester.kinds.specimen_on_track.fit.made import made_track_run
from tests.tester.kinds.wheel_on_belt.bench import SHORT
from tests.tester.kinds.wheel_on_belt.fit.made import made_run

pytest.importorskip("scipy", reason="needs the extra `report`")
POINT = ("--slip", "300 mm/s", "--load", "200 N", "--temperature", "40 degC")


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    made_run(tmp_path / "runs" / "one")
    return tmp_path


def done(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> tuple[str, str]:
    found = invoke([*arguments])
    captured = capsys.readouterr()
    assert found == code, captured.err
    return captured.out, captured.err


def keep(capsys: pytest.CaptureFixture[str], *more: str) -> KeptLaw:
    done(capsys, "fit", "one", "-o", "law.yaml", *more)
    return load_law(Path("law.yaml"))


def test_a_kept_law_holds_parameters_range_source_and_hash(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kept = keep(capsys, "--area", "540 mm2")
    model = kept.model
    assert (model.form, model.kind, model.compound, model.describes) == ("v2", "wheel_on_belt", "1#", "yes")
    assert [*model.parameters] == [*V2_LAW.names] and model.parameters["beta"].unit == "1/K2"
    points = run_points(home / "runs" / "one").points
    (data,) = model.data
    assert (data.source, data.table, data.rows) == ("one", "conditions", len(DESIGN))
    assert data.sha256 == data_hash(points) != data_hash(points[1:])
    assert model.degrees_of_freedom == len(DESIGN) - 7 and model.area == 540.0 and "--area" in model.area_source
    assert model.range.load == pytest.approx([min(x[1] for x in DESIGN) - 3.0, max(x[1] for x in DESIGN)])
    assert kept.doubts == () and model.hash() == model.content


def test_it_is_not_overwritten_and_an_unknown_law_is_not_kept(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    keep(capsys)
    assert "exists already" in done(capsys, "fit", "one", "-o", "law.yaml", code=2)[1]
    done(capsys, "fit", "one", "-o", "law.yaml", "--force", "--law", "paper", code=1)
    assert load_law(Path("law.yaml")).model.describes == "no"
    fit = fit_group(V2_LAW, "1#", run_points(home / "runs" / "one").points, FITS.cells, count=20)
    with pytest.raises(FitError, match="the law new is not kept"):
        kept_model(replace(fit, law=replace(V2_LAW, name="new")), "wheel_on_belt", FITS)
    made_track_run(home / "runs" / "track", metadata={"abrasive": "S0"})
    assert invoke(["fit", "track", "-o", "bell.yaml"]) == 0
    capsys.readouterr()
    assert load_law(Path("bell.yaml")).model.interface == "dry" and load_law(Path("bell.yaml")).model.surface == "S0"


def test_several_compounds_are_kept_in_a_file_each(capsys: pytest.CaptureFixture[str]) -> None:
    told = done(capsys, "fit", "appendix-a", "-o", "law.yaml")[1]
    assert [line for line in told.splitlines() if line.startswith("kept")] == [
        "kept: law-1.yaml", "kept: law-2.yaml", "kept: law-3.yaml"
    ]  # fmt: skip
    assert load_law(Path("law-2.yaml")).model.compound == "2#"


def test_predict_gives_the_interval_and_states_an_extrapolation(capsys: pytest.CaptureFixture[str]) -> None:
    kept = keep(capsys)
    found = json.loads(done(capsys, "predict", "--law", "law.yaml", *POINT, "--json")[0])
    assert (found["mu"], found["low"], found["high"]) == kept.predict(40.0, 200.0, 0.3)
    assert found["extrapolated"] == found["doubts"] == []
    printed, told = done(capsys, "predict", "--law", "law.yaml", *POINT[:4], "--temperature", "120 degC")
    assert "(95 %" in printed and "beyond the fitted" in told
    assert "not of '2#'" in done(capsys, "predict", "--law", "law.yaml", "--compound", "2#", *POINT, code=2)[1]
    assert "--compound" in done(capsys, "predict", *POINT, code=2)[1]


def test_compare_puts_a_runs_conditions_beside_it(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    keep(capsys)
    rows = json.loads(done(capsys, "compare", "one", "law.yaml", "--json")[0])
    assert len(rows) == len(DESIGN) and all(row["inside"] and not row["extrapolated"] for row in rows)
    printed, _ = done(capsys, "compare", "one", "law.yaml")
    assert printed.splitlines()[-1] == f"{len(DESIGN)} of {len(DESIGN)} inside the 95 % interval of law.yaml"
    made_run(home / "runs" / "other", compound="2#")
    assert "no condition of 1#" in done(capsys, "compare", "other", "law.yaml", code=1)[1]
    made_track_run(home / "runs" / "track")
    assert "is a law of the kind wheel_on_belt" in done(capsys, "compare", "track", "law.yaml", code=2)[1]


def test_figures_draw_it(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    keep(capsys)
    done(capsys, "figure", "one", "--law", "law.yaml", "--name", "load-by-temperature")
    made_track_run(home / "runs" / "track")
    assert "not specimen_on_track" in done(capsys, "figure", "track", "--law", "law.yaml", code=2)[1]


def test_a_simulated_wheel_rubs_by_it_and_keeps_its_file(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (home / "law.yaml").write_text(example_text(compound="1#"), encoding="utf-8")
    (home / "r.yaml").write_text(SHORT, encoding="utf-8")
    quiet = [f"--set=sim.{name}=0" for name in ("noise", "scatter", "running_in")]
    done(capsys, "run", "r.yaml", "--set", "sim.friction_model=law.yaml", *quiet, "--yes")
    run = json.loads(done(capsys, "show", "latest", "--json")[0])
    (law,) = (one for one in run["materials"] if one["role"] == "law")
    assert (law["name"], law["file"]) == ("1#", "laws/law.yaml")
    (table,) = home.glob("runs/*/appendix.csv")
    assert table.read_text(encoding="utf-8").splitlines()[1].endswith(",0.60")
    (home / "r.yaml").write_text(SHORT.replace("1#", "2#"), encoding="utf-8")
    told = done(capsys, "check", "r.yaml", "--set", "sim.friction_model=law.yaml", code=3)[1]
    assert "law.yaml is the law of '1#', not of '2#'" in told


def test_a_schema_for_editors(capsys: pytest.CaptureFixture[str]) -> None:
    schema: dict[str, Any] = json.loads(done(capsys, "schema", "--of", "law")[0])
    assert {"form", "parameters", "covariance", "range", "data", "content"} <= {*schema["properties"]}


@pytest.mark.parametrize("law", [V2_LAW, PAPER], ids=lambda law: law.name)
def test_the_interval_contains_held_out_conditions(law: Any) -> None:
    """Over many sets, 95 % of held-out conditions are inside; the binomial deviation of 375 is 1.1 %."""
    random, inside, count = np.random.default_rng(7), 0, 0
    warm = (25.0, 40.0, 55.0, 70.0, 85.0)
    x = np.array([(t, n, v) for t in warm for n in (100.0, 200.0, 400.0) for v in (0.1, 0.2, 0.4)])
    true = law.value(np.array(law.published["1#"]), x)
    for _ in range(25):
        measured = true * np.exp(0.03 * random.standard_normal(len(x)))
        points = [
            FitPoint(str(i), "1#", tuple(at), tuple(at), float(mu), Source("made"), 0.01, 30.0, 0.0, 0.028)
            for i, (at, mu) in enumerate(zip(x.tolist(), measured.tolist(), strict=True))
        ]
        held_out = [int(i) for i in random.permutation(len(points))[:15]]
        fitted = [point for i, point in enumerate(points) if i not in held_out]
        fit = fit_group(law, "1#", fitted, FITS.cells, count=20)
        kept = KeptLaw(kept_model(fit, "wheel_on_belt", FITS), "law.yaml")
        for i in held_out:
            t, n, v = points[i].measured
            predicted = kept.predict(t, n, v)
            inside += predicted.low <= points[i].value <= predicted.high
            count += 1
    assert count == 375 and 0.92 <= inside / count <= 0.98, inside / count
