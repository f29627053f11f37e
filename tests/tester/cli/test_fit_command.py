"""``tester fit`` and ``tester paper``."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

import pytest

from sim.physics.greta import greta
from tester.cli.main import invoke
from tester.inputs.materials.library import Library
from tester.kinds.wheel_on_belt.fit import published
from tests.campaigns.fit.synthetic import DESIGN
from tests.tester.kinds.specimen_on_track.fit.made import law, made_track_run
from tests.tester.kinds.wheel_on_belt.fit.made import made_run

pytest.importorskip("scipy", reason="needs the extra `report`")


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path / "runs"


def out(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> str:
    found = invoke([*arguments])
    captured = capsys.readouterr()
    assert found == code, captured.err
    return captured.out if not code or captured.out else captured.err


def data(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> dict[str, Any]:
    return json.loads(out(capsys, *arguments, "--json", code=code))


def test_the_papers_table_is_printed_and_met(capsys: pytest.CaptureFixture[str]) -> None:
    told = out(capsys, "paper").splitlines()
    assert any(line.split()[-5:] == ["10.62", "5.90", "50.1", "36", "54"] for line in told)
    assert sum(line.startswith("  ok") for line in told) == 2


def test_a_figure_that_misses_is_reported_and_sets_the_exit_code(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(published, "V2_MEAN", 0.06)
    found = data(capsys, "paper", code=1)
    assert found["missed"] == ["v2, fitted to appendix A"]
    assert data(capsys, "fit", "appendix-a", "--validate", "appendix-b", "--check", code=1)["check"] == found


def test_a_fit_to_appendix_a_is_seen_on_b(capsys: pytest.CaptureFixture[str]) -> None:
    found = data(capsys, "fit", "appendix-a", "--validate", "appendix-b")
    assert [one["group"] for one in found["groups"]] == ["1#", "2#", "3#"]
    seen = found["all"]["validation"]
    assert (seen["rows"], seen["near"], seen["far"]) == (79, 35, 63)
    assert seen["mean"] == pytest.approx(0.0645, abs=1e-4)
    tm = found["groups"][1]["parameters"]["tm"]
    assert tm["interval"] is None and "nothing is known of the repeatability" in tm["no_interval"]


def test_it_ends_with_peaks_exponents_and_signs(capsys: pytest.CaptureFixture[str]) -> None:
    told = out(capsys, "fit", "appendix-a", "appendix-b")
    end = told.partition("consequences:")[2]
    assert end.count("rises to a peak, then falls") == 3
    assert end.count("no peak between 0 mm/s and 400 mm/s; exponent +0.") == 3
    assert end.count("no peak between 100 N and 400 N; exponent -0.") == 3


def test_the_papers_law_is_printed_as_table_3_with_the_caution(capsys: pytest.CaptureFixture[str]) -> None:
    told = out(capsys, "fit", "appendix-a", "--law", "paper")
    assert "as Table 3" in told and "a1 is an extrapolation to 1 N: compare predictions, never a1" in told


def test_a_run_is_fitted_with_the_scatter_of_its_repeats(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made_run(home / "one")
    (group,) = data(capsys, "fit", "one", "--validate", "appendix-b")["groups"]
    assert group["conditions"] == len(DESIGN)
    assert group["parameters"]["tm"]["value"] == pytest.approx(66.701, abs=0.05)
    assert group["lack_of_fit"]["repeats"] == pytest.approx(0.01 / 3.0**0.5, rel=1e-3)
    assert group["lack_of_fit"]["between_conditions"] == pytest.approx(0.032) and group["lack_of_fit"]["shown"] is False
    assert group["validation"]["rows"] == 26


def falling(temperature_c: float, speed_m_s: float) -> float:
    return law(temperature_c, speed_m_s) * (1.0 - 0.003 * (temperature_c - 10.0))


def test_a_law_that_does_not_describe_is_refused_first_and_force_shows_the_rest(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made_track_run(home / "one", mu=falling)
    printed = out(capsys, "fit", "one", code=1)
    assert printed.splitlines()[1] == "SBR, dry: this law does not describe these data"
    assert "size of the residuals more than chance" in printed and "judged together at 1 %" in printed
    assert "t_ref" in printed and " to " not in next(one for one in printed.splitlines() if one.startswith("  t_ref "))
    assert "nothing, for the law does not describe these data" in printed
    forced = out(capsys, "fit", "one", "--force", code=1)
    assert " to " in next(one for one in forced.splitlines() if one.startswith("  t_ref ") and "degC" in one)
    assert "rises to a peak" in forced


def test_the_right_law_is_reported_with_the_departure_that_would_be_seen(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made_track_run(home / "one")
    printed = out(capsys, "fit", "one")
    assert printed.splitlines()[1] == "SBR, dry: no departure from the law is seen"
    assert re.search(r"a departure of 1\.[6-9] % \(root mean square, beyond what .* is seen in 95 % of", printed)
    assert "2 % a repeat, declared by the rig [A]" in printed
    assert "no scatter between conditions is declared" in printed
    assert "18 conditions are outside" in printed


def test_a_load_that_friction_warms_is_no_load_dependence(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, load_n in (("light", 10.0), ("heavy", 40.0)):  # twice the load, and 3 % of its own heat more
        speeds = (0.05, 0.1, 0.2)

        def warmed(temperature_c: float, speed_m_s: float, load_n: float = load_n) -> float:
            return law(temperature_c, speed_m_s) * (1.0 + 0.01 * speed_m_s * load_n)

        made_track_run(home / name, (20.0,), speeds, warmed, scatter=0.01, load_n=load_n, band_k=20.0)
    printed = out(capsys, "fit", "light", "heavy", "--law", "power", "--force", code=0)
    assert "load         not resolved: friction warms the contact by up to" in printed


def test_several_runs_are_fitted_together(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made_run(home / "one", DESIGN[:20])
    made_run(home / "two", DESIGN[20:])
    assert data(capsys, "fit", "one", "two")["groups"][0]["conditions"] == len(DESIGN)


def test_left_out_conditions_are_reported(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made_run(home / "one", carried=[1], sideslip={2: 10.0})
    assert invoke(["fit", "one"]) == 0
    said = capsys.readouterr().err
    assert "left out (carry-over): one/1 (" in said
    assert "left out (sideslip: the laws know none): one/2" in said


def test_one_temperature_is_refused_and_held_parameters_do(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cold = [(25.0, load, slip) for load in (100.0, 200.0, 400.0) for slip in (0.1, 0.2, 0.4)]
    made_run(home / "cold", cold)
    message = out(capsys, "fit", "cold", code=1)
    assert "one temperature only (25 degC), and a, beta, tm need at least 4" in message
    assert "--hold a,beta,tm" in message
    parameters = data(capsys, "fit", "cold", "--hold", "a,beta,tm=70")["groups"][0]["parameters"]
    held = {"value": 70.0, "unit": "degC", "interval": [70.0, 70.0], "no_interval": "", "held": True}
    assert parameters["tm"] == held
    assert parameters["a"]["value"] == 0.224424 and not parameters["c"]["held"]


def test_powers_of_slip_and_load_are_fitted_to_a_wheel_without_its_rolling_conditions(
    capsys: pytest.CaptureFixture[str],
) -> None:
    found = data(capsys, "fit", "appendix-a", "--law", "power")
    assert [*found["groups"][0]["parameters"]] == ["a", "n", "m"]
    rolling = [one["condition"] for one in found["not_fitted"] if one["reason"].startswith("no slip")]
    assert rolling == ["A025", "A033", "A041"]


def test_an_unknown_compound_has_nothing_published_to_hold(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made_run(home / "one", compound="2#")
    assert invoke(["fit", "one", "--hold", "tm"]) == 0
    capsys.readouterr()
    assert "no parameter 'k2'" in out(capsys, "fit", "one", "--hold", "k2", code=2)
    assert "'hot' is no number" in out(capsys, "fit", "one", "--hold", "tm=hot", code=2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["appendix-c"], "no run appendix-c"),
        (["appendix-a", "appendix-a"], "named twice"),
        (["appendix-a", "--validate", "appendix-a"], "is fitted, and shows nothing of other conditions"),
        (["appendix-a", "--law", "v3"], "no law 'v3' can be fitted (expected v2, paper, power)"),
        (["appendix-b", "--check"], "expected appendix-a --validate appendix-b"),
        ([], "Missing argument 'SOURCE...'"),
    ],
)
def test_a_command_that_makes_no_sense_is_refused(
    home: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    assert message in out(capsys, "fit", *arguments, code=2)


def test_a_run_without_values_gives_the_reason(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made_run(home / "one", DESIGN[:2], failed=[1, 2])
    assert "no condition of one can be fitted: left out for not reached" in out(capsys, "fit", "one", code=1)


def test_a_run_of_a_kind_without_laws_is_refused(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made_run(home / "one", DESIGN[:2], kind="tests.tester.cli.test_fit_command:LAWLESS")
    assert "no law can be fitted to conditions of the kind lawless" in out(capsys, "fit", "one", code=2)


def test_without_scipy_the_line_that_installs_it_is_named(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    for command in (["paper"], ["fit", "appendix-a"]):
        message = out(capsys, *command, code=2)
        assert 'a fit needs scipy: pip install "friction-tester[report]"' in message


def _lawless() -> object:
    from dataclasses import replace

    from tester.kinds.wheel_on_belt import KIND

    return replace(KIND, name="lawless", fits=None)


LAWLESS = _lawless()


def test_a_run_on_a_track_is_fitted_by_interface(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made_track_run(home / "one", (0.0, 10.0, 20.0), interfaces=("dry", "wet"), scatter=0.0)
    found = data(capsys, "fit", "one")
    assert (found["law"], [one["group"] for one in found["groups"]]) == ("wlf_bell", ["SBR, dry", "SBR, wet"])
    parameters = found["groups"][0]["parameters"]
    assert {name: parameters[name]["value"] for name in ("mu_max", "width", "t_ref")} == pytest.approx(
        {"mu_max": 2.2, "width": 3.0, "t_ref": -3.0}, rel=1e-3
    )


def test_a_law_of_materials_is_fitted_on_the_surface_that_is_named(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    speeds = (0.05, 0.2, 1.0)
    made_track_run(home / "one", (10.0, 25.0), speeds, compounds=("tread",), mu=tread, scatter=0.0, band_k=50.0)
    found = data(capsys, "fit", "one", "--law", "greta", "--surface", "road", "--given", "area=50")
    parameters = found["groups"][0]["parameters"]
    assert {name: one["value"] for name, one in parameters.items()} == pytest.approx(
        {"tau_s0": 12e3, "v_c": 1.0, "n": 0.6}, rel=0.02
    )
    assert "does not name its surface" in out(capsys, "fit", "one", "--law", "greta", code=1)


def tread(temperature_c: float, speed_m_s: float) -> float:
    library = Library.beside()
    law = greta(library.rubber("tread"), library.surface("road"), {"area": 50.0})
    return law.mu(temperature_c, 20.0, speed_m_s)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--law", "power", "--given", "area=50"], "takes no figures"),
        (["--law", "greta", "--surface", "road", "--given", "area=wide"], "--given area=wide: 'wide' is no number"),
        (["--law", "greta", "--surface", "rod"], "did you mean"),
        (["--law", "persson", "--surface", "road"], "no spectrum of heights"),
    ],
)
def test_impossible_laws_of_a_track_are_refused(
    home: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    made_track_run(home / "one", (10.0, 25.0), (0.05, 0.2, 1.0), compounds=("tread",), band_k=50.0)
    assert invoke(["fit", "one", *arguments]) in (1, 2)
    assert message in capsys.readouterr().err
