"""`tester predict` of a specimen on a track: laws of figures and of materials, their parts, their tables."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from sim.physics import tabulated
from sim.physics.lookup import TableSpan, TabulatedLaw
from tester.cli.main import invoke

POINT = ["predict", "--compound", "SBR", "--slip", "10 mm/s", "--load", "40 N", "--temperature", "20 degC"]
ON_S0 = [*POINT, "--law", "persson", "--surface", "S0"]

HEAD = "    columns: [temperature degC, frequency Hz, E' Pa, E'' Pa]\n    rows:\n"


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    assert invoke(list(words)) == 0, capsys.readouterr().err
    return capsys.readouterr().out


def refused(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    assert invoke(list(words)) == 2
    found = capsys.readouterr()
    assert found.out == ""
    return found.err


def test_persson_of_a_packaged_compound_on_a_packaged_surface(capsys: pytest.CaptureFixture[str]) -> None:
    # 40 N on 100 mm2 are 4e5 Pa.
    assert float(printed(capsys, *ON_S0)) == pytest.approx(1.0469, rel=5e-3)


def test_components_are_printed_below_the_coefficient(capsys: pytest.CaptureFixture[str]) -> None:
    assert printed(capsys, *ON_S0, "--components") == "1.04691\nadhesion 0.00000\nhysteresis 1.04691\n"


def test_components_in_json_add_up(capsys: pytest.CaptureFixture[str]) -> None:
    words = [*POINT, "--law", "greta", "--surface", "road", "--components", "--json"]
    words[2] = "tread"
    found = json.loads(printed(capsys, *words))
    assert found["adhesion"] > 0.0 < found["hysteresis"]
    assert found["mu"] == pytest.approx(found["adhesion"] + found["hysteresis"])


def test_the_area_makes_the_pressure(capsys: pytest.CaptureFixture[str]) -> None:
    wide = [*ON_S0, "--area", "2 cm2"]
    wide[wide.index("40 N")] = "80 N"
    assert printed(capsys, *wide) == printed(capsys, *ON_S0)


def test_a_law_of_materials_of_an_installed_package(capsys: pytest.CaptureFixture[str]) -> None:
    words = [*POINT, "--law", "tests.sim.physics.materials_example:HARD", "--surface", "S0", "--components"]
    assert printed(capsys, *words) == "0.27500\nadhesion 0.02500\nhysteresis 0.25000\n"


def test_model_is_another_word_for_law(capsys: pytest.CaptureFixture[str]) -> None:
    other = [word.replace("--law", "--model") for word in ON_S0]
    assert printed(capsys, *other) == printed(capsys, *ON_S0)


def test_a_law_of_figures_takes_those_of_the_simulated_track(capsys: pytest.CaptureFixture[str]) -> None:
    sbr = float(printed(capsys, *POINT, "--law", "wlf_bell"))
    nbr = [*POINT, "--law", "wlf_bell"]
    nbr[2] = "NBR"
    assert sbr != float(printed(capsys, *nbr))
    assert float(printed(capsys, *POINT, "--law", "power")) > 0.0 < float(printed(capsys, *POINT, "--law", "arrhenius"))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([*POINT, "--law", "persson"], "expected --surface NAME"),
        ([*POINT, "--law", "persson", "--surface", "nowhere"], 'no file of a surface has the name "nowhere"'),
        ([*POINT, "--law", "persson", "--surface", "road"], "has no spectrum of heights"),
        ([*POINT, "--law", "greta", "--surface", "road"], "needs its shear"),
        ([*ON_S0, "--area", "0 mm2"], "area of contact must be finite and above 0"),
        ([*ON_S0, "--sideslip", "5 deg"], "--sideslip: law persson is of a specimen on a track"),
        ([*POINT, "--law", "wlf_bell", "--components"], "does not know adhesion from hysteresis"),
        ([*POINT, "--law", "wlf_bell", "--table"], "needs no table"),
        (["predict", "--compound", "1#", *POINT[3:], "--components"], "law paper has neither parts nor a table"),
    ],
)
def test_impossible_options_are_usage_errors(
    capsys: pytest.CaptureFixture[str], words: list[str], message: str
) -> None:
    assert message in refused(capsys, *words)


def test_moduli_held_beyond_their_table_are_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "compounds").mkdir()
    rows = "".join(
        f"      - [{t}, 1, {10 ** (9.3 - 0.02 * (t + 60)):.6g}, {10 ** (8.3 - 0.02 * (t + 60)):.6g}]\n"
        for t in range(-60, 101, 10)
    )
    text = "name: measured\nsource: made up\ndecade_k: 8\nmoduli:\n  beyond: hold\n  table:\n" + HEAD + rows
    (tmp_path / "compounds" / "measured.yaml").write_text(text, encoding="utf-8")
    words = [*ON_S0]
    words[2] = "measured"
    assert invoke(words) == 0
    assert capsys.readouterr().err == ""
    words[words.index("20 degC")] = "-60 degC"
    assert invoke(words) == 0
    assert "extrapolated" in capsys.readouterr().err


def test_a_table_reports_its_size_and_its_error(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def at_once(slow: tabulated.LawOfParts, span: TableSpan) -> tuple[TabulatedLaw, object, object]:
        return tabulated.build_at(slow, span, (8, 6, 5))

    assert "greatest error 0." in printed(capsys, *ON_S0, "--table")
    monkeypatch.setattr(tabulated, "build", at_once)
    assert invoke([*ON_S0, "--table"]) == 1
    assert "table of 240 points" in capsys.readouterr().out


WARNED = ("--compound", "SBR", "--load", "20 N")


@pytest.mark.parametrize(
    ("words", "warning"),
    [
        (("--law", "wlf_bell", "--slip", "1 mm/s", "--temperature", "60 degC"), "60 degC is outside -53 to 47 degC"),
        (("--law", "wlf_bell", "--slip", "300 mm/s", "--temperature", "20 degC"), "above 10 mm/s friction heats"),
        (("--law", "arrhenius", "--slip", "300 mm/s", "--temperature", "20 degC"), "above 10 mm/s friction heats"),
        (("--law", "power", "--slip", "1 mm/s", "--temperature", "20 degC"), "the law power knows no temperature"),
        (("--law", "persson", "--surface", "S0", "--slip", "1 mm/s", "--temperature=-60 degC"),
         "-60 degC is below the glass transition of SBR"),
    ],
)  # fmt: skip
def test_outside_the_range_of_a_law_a_warning_names_the_bound(
    capsys: pytest.CaptureFixture[str], words: tuple[str, ...], warning: str
) -> None:
    assert invoke(["predict", *WARNED, *words]) == 0
    (line,) = [one for one in capsys.readouterr().err.splitlines() if warning in one]
    assert line.startswith("warning: ")


def test_inside_the_range_of_a_law_nothing_is_printed_beside_the_value(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["predict", *WARNED, "--law", "wlf_bell", "--slip", "1 mm/s", "--temperature", "20 degC"]) == 0
    assert capsys.readouterr().err == ""


def test_a_full_contact_is_outside_the_range_of_greta(capsys: pytest.CaptureFixture[str]) -> None:
    at = ["--compound", "tread", "--law", "greta", "--surface", "road", "--slip", "1 m/s", "--temperature", "25 degC"]
    assert invoke(["predict", *at, "--load", "20 N"]) == 0
    assert "the contact is full" not in capsys.readouterr().err
    assert invoke(["predict", *at, "--load", "100 kN", "--area", "10 mm2"]) == 0
    assert "the contact is full" in capsys.readouterr().err
