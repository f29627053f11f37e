"""Kept laws: written and read back, evaluated with interval and range, refused where something is wrong."""

from __future__ import annotations

from math import exp, log, sqrt
from pathlib import Path
from typing import Any

import pytest

from sim.physics import laws
from tester.analysis.quantiles import t_quantile
from tester.base.source import InvalidSource
from tester.inputs.kept_laws.law_schema import OF_FIGURES
from tester.inputs.kept_laws.law_value import KeptLaw, load_law
from tester.inputs.materials.stated_law import units_of
from tester.kinds import load_rig
from tests.tester.inputs.kept_laws.kept_example import example, example_text

AT = 40.0, 200.0, 0.3


def kept(folder: Path, text: str) -> KeptLaw:
    (folder / "law.yaml").write_text(text, encoding="utf-8")
    return load_law(folder / "law.yaml")


def test_a_law_is_read_back_as_written(tmp_path: Path) -> None:
    model = example(area="540 mm2", area_source="footprint, ink", interface="dry", surface='a "belt"')
    from tester.inputs.kept_laws.law_schema import law_text

    found = kept(tmp_path, law_text(model))
    assert found.model == model and found.doubts == () and found.name == "law.yaml"


def test_the_coefficient_is_that_of_the_law_with_the_files_figures(tmp_path: Path) -> None:
    found = kept(tmp_path, example_text())
    expected = laws.make("power", "own", {"a": 0.6, "n": 0.2, "m": -0.1, "v0": 0.3, "n0": 200.0})
    assert found.mu(25.0, 100.0, 0.2) == expected.mu(25.0, 100.0, 0.2)


def test_the_interval_is_of_covariance_and_scatter(tmp_path: Path) -> None:
    found = kept(tmp_path, example_text())
    for slip_m_s in (0.3, 0.1):
        slope = log(slip_m_s / 0.3)  # d ln mu / dn; d ln mu / d ln a is 1
        off = t_quantile(0.975, 10.0) * sqrt(0.0004 + 0.0009 * slope**2 + 0.03**2)
        mu, low, high = found.predict(40.0, 200.0, slip_m_s)
        assert (low, high) == pytest.approx((mu * exp(-off), mu * exp(off)), rel=1e-6)


def test_beyond_the_range_is_stated_and_within_it_nothing(tmp_path: Path) -> None:
    found = kept(tmp_path, example_text())
    assert [*found.caveats(*AT)] == []
    (warm,) = found.caveats(90.0, 200.0, 0.3)
    assert warm == "temperature 90 degC is beyond the fitted 25 to 85 degC of law.yaml: an extrapolation"
    assert [one.split(" is")[0] for one in found.caveats(20.0, 500.0, 0.05)] == [
        "temperature 20 degC", "load 500 N", "speed 50 mm/s"
    ]  # fmt: skip
    assert [*found.caveats(25.0 - 1.0, 200.0, 0.3)] == []  # a rig holds a temperature within a band


def test_a_file_that_was_edited_is_named_and_comments_do_not_count(tmp_path: Path) -> None:
    text = example_text()
    assert kept(tmp_path, f"# mine\n{text}").doubts == ()
    (doubt,) = kept(tmp_path, text.replace("value: 0.6", "value: 0.7")).doubts
    assert "law.yaml was edited after its fit" in doubt


@pytest.mark.parametrize(("word", "message"), [("no", "does not describe"), ("unknown", "is unknown")])
def test_a_law_that_does_not_describe_its_data_is_doubted(tmp_path: Path, word: str, message: str) -> None:
    (doubt,) = kept(tmp_path, example_text(describes=word)).doubts
    assert message in doubt


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("form: power", "form: persson", "form"),
        ("scatter: 0.03", "scater: 0.03", "did you mean scatter"),
        ("100 N", "100", "100 has no unit"),
        ("[100 N, 400 N]", "[400 N, 100 N]", "expected the least value first"),
        ("  - [0.0004, 0.0]\n", "", "covariance: 1 rows of 2 numbers (expected 2 by 2: a, n)"),
        ("[0.0004, 0.0]", "[0.0004, 0.1]", "row 1, number 2: 0.1 (expected a covariance)"),
        ("value: 0.6", "value: -0.6", "expected above 0"),
        ("n0: 200.0", "n9: 200.0", "power has no n9"),
        ("kept_law: 1", "kept_law: 2", "kept_law"),
        ('content: "', 'content: "x', "content"),
    ],
)
def test_mistakes_are_refused_at_their_place(tmp_path: Path, old: str, new: str, message: str) -> None:
    text = example_text()
    assert old in text
    with pytest.raises(InvalidSource) as raised:
        kept(tmp_path, text.replace(old, new))
    problems = [str(one) for one in raised.value.problems]
    assert all("law.yaml:" in one for one in problems) and any(message in one for one in problems), problems


def test_a_file_that_is_no_law_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidSource, match="a kept law is a list of keys"):
        kept(tmp_path, "- 1\n")
    with pytest.raises(InvalidSource, match="no such file"):
        load_law(tmp_path / "none.yaml")


def test_it_is_the_law_of_its_own_compound_alone(tmp_path: Path) -> None:
    found = kept(tmp_path, example_text())
    assert found.of("own") is found
    with pytest.raises(ValueError, match=r"law.yaml is the law of 'own', not of '1#'"):
        found.of("1#")
    with pytest.raises(ValueError, match="expected dry"):
        kept(tmp_path, example_text(interface="wet")).of("own")


@pytest.mark.parametrize("form", OF_FIGURES)
def test_every_form_is_a_law_with_figures(form: str) -> None:
    assert units_of(form)


def test_a_rig_file_and_an_override_name_it_and_it_is_absolute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "law.yaml"
    path.write_text(example_text(), encoding="utf-8")
    rig: Any = load_rig("sim", ("sim.friction_model=law.yaml",))
    assert rig.sim.friction_model == str(path.resolve())
    path.write_text(example_text(scatter=0.04), encoding="utf-8")
    made: Any = laws.make(rig.sim.friction_model, "own")
    assert made.model.scatter == 0.04  # a file is read anew
    with pytest.raises(InvalidSource, match="no such file"):
        load_rig("sim", ("sim.friction_model=none.yaml",))
