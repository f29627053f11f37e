"""`tester check`, `plan` and `schema` as users call them."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.kinds import packaged_text
from tests.tester.inputs.recipe.texts import SMALL


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(folder: Path, text: str) -> str:
    (folder / "r.yaml").write_text(text, encoding="utf-8")
    return "r.yaml"


def test_check_reports_that_a_packaged_recipe_is_valid(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["check", "quickstart"]) == 0
    out, err = capsys.readouterr()
    assert out == 'recipes/quickstart.yaml: valid on rig "simulated rubber friction tester", 2 conditions\n'
    assert err == ""


def test_check_reports_every_problem_on_stderr_and_exits_3(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = SMALL.replace("200 N]", "500 N, 7]").replace("measure:", "measure:\n  windw: 3 rev")
    assert invoke(["check", write(folder, text)]) == 3
    out, err = capsys.readouterr()
    assert out == ""
    assert [line.split(": ")[0] for line in err.splitlines()] == ["r.yaml:5:3", "r.yaml:10:19", "r.yaml:10:26"]


def test_check_gives_the_problems_as_json(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["check", write(folder, SMALL.replace("200 N]", "500 N]")), "--json"]) == 3
    data = json.loads(capsys.readouterr().out)
    assert data["valid"] is False
    (problem,) = data["problems"]
    assert (problem["file"], problem["line"], problem["column"]) == ("r.yaml", 9, 19)


def test_check_holds_the_recipe_against_the_rig_as_it_is_set(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name = write(folder, SMALL)
    assert invoke(["check", name]) == 0
    assert invoke(["check", name, "--set", "limits.load=150"]) == 3
    assert "limit 150 N: limits.load" in capsys.readouterr().err


SHARED = SMALL + "  - {name: b, slip_velocity: 300 mm/s, load: 100 N, temperature: 40 degC}\n"
MERGED = [{
    "grid": "b", "measured_in": "load",
    "conditions": [{"slip_velocity_m_s": 0.3, "load_n": 100.0, "sideslip_deg": 0.0, "camber_deg": 0.0,
                    "temperature_c": 40.0, "wheel_speed_m_s": 0.8, "surface": ""}],
}]  # fmt: skip


@pytest.mark.parametrize("command", ["check", "plan"])
def test_conditions_shared_by_two_grids_are_reported(
    command: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = write(folder, SHARED)
    assert invoke([command, name]) == 0
    assert "grid b shares 1 condition with grid load" in capsys.readouterr().out
    assert invoke([command, name, "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["merged"], data["conditions"]) == (MERGED, 4)


def test_conditions_measured_again_are_not(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["check", write(folder, SHARED.replace("name: b", "name: b, measure_again: true"))]) == 0
    out = capsys.readouterr().out
    assert "5 conditions" in out and "shares" not in out


def test_an_unknown_recipe_is_a_usage_error(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["check", "nosuch"]) == 2
    assert "packaged are greta, grosch, pin-on-disc, pre-grind" in capsys.readouterr().err


def test_an_invalid_rig_file_exits_3(folder: Path) -> None:
    assert invoke(["check", "quickstart", "--set", "limits.laod=150"]) == 3


@pytest.mark.parametrize("text", ["[" * 60_000, "a: 1\na: 2\n", "", "recipe: \x07\n"])
def test_plan_and_check_refuse_the_same_recipes(folder: Path, text: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["plan", write(folder, text)]) == 3
    assert capsys.readouterr().err.startswith("r.yaml:")


def test_plan_lists_the_steps_with_durations(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["plan", "table2"]) == 0
    out = capsys.readouterr().out
    assert "conditions        174, 870 repeats" in out
    assert out.count("pre-grind 4 min") == out.count("install wheel")


def test_plan_as_json_has_the_contracts_keys(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["plan", "table2", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    conditions = [step for step in data["steps"] if step["kind"] == "condition"]
    assert data["conditions"] == len(conditions) == 174
    assert data["rig_seconds"] > 0
    assert data["wheels"] == sum(step["kind"] == "install" for step in data["steps"])
    assert {step["repeats"] for step in conditions} == {5}


def test_schema_prints_the_packaged_schema(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["schema"]) == 0
    schema = json.loads(capsys.readouterr().out)
    assert schema["required"] == ["recipe", "specimens"]


def test_plan_prints_how_many_wheels_separate_two_compounds(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["plan", "quickstart"]) == 0
    assert "to tell 10 % takes 3, 5 % takes 9 wheels each (replicates; here 1)" in capsys.readouterr().out


def test_plan_prints_the_cost_of_a_precision(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["plan", "quickstart", "--precision", "2%"]) == 0
    out = capsys.readouterr().out
    assert "repeatability     2 % (type A, expanded, 95 %)" in out
    assert "nothing is stored" in out


def test_plan_offers_a_dry_run_with_its_price(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--set", "sim.noise=0", "--rig", "sim"]
    assert invoke(["plan", "quickstart", *options]) == 0
    (line,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("a dry run takes")]
    assert re.fullmatch(r"a dry run takes   about \d0? s: tester run quickstart --set sim.noise=0 --yes", line)


def test_plan_for_a_precision_offers_no_run_of_the_recipe(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["plan", "quickstart", "--precision", "2%"]) == 0
    assert "a dry run" not in capsys.readouterr().out


def test_plan_gives_the_rig_time_with_its_range(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["plan", "quickstart", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["rig_seconds_low"] < data["rig_seconds"] < data["rig_seconds_high"]


def test_plan_refuses_a_total_below_that_of_the_instruments(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["plan", "quickstart", "--total", "0.5%"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "from the instruments alone (95 %), of which" in err


@pytest.mark.parametrize("arguments", [["--precision", "0%"], ["--precision", "2%", "--total", "5%"]])
def test_a_precision_that_makes_no_sense_is_a_usage_error(folder: Path, arguments: list[str]) -> None:
    assert invoke(["plan", "quickstart", *arguments]) == 2


def test_check_lists_the_keys_of_the_rig_that_take_the_packaged_value(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = folder / "rig.yaml"
    path.write_text(packaged_text().replace("  pushed: ", "  # pushed: "), encoding="utf-8")
    assert invoke(["check", "quickstart", "--rig", str(path)]) == 0
    assert f"{path}: packaged values count for interlocks.pushed\n" in capsys.readouterr().err
