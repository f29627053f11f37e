"""`tester predict`: the published model on the command line."""

from __future__ import annotations

import json

import pytest

from tester.cli.main import invoke

POINT = {"--compound": "1#", "--slip": "300 mm/s", "--load": "200 N", "--temperature": "25 degC"}


def predict(capsys: pytest.CaptureFixture[str], *flags: str, **options: str) -> str:
    given = POINT | {f"--{name.replace('_', '-')}": value for name, value in options.items()}
    code = invoke(["predict", *(word for pair in given.items() for word in pair), *flags])
    captured = capsys.readouterr()
    assert code == 0, captured.err
    return captured.out


def mu(capsys: pytest.CaptureFixture[str], **options: str) -> float:
    return json.loads(predict(capsys, "--json", **options))["mu"]


def refusal(capsys: pytest.CaptureFixture[str], **options: str) -> str:
    given = POINT | {f"--{name}": value for name, value in options.items()}
    assert invoke(["predict", *(word for pair in given.items() for word in pair)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    return captured.err


@pytest.mark.parametrize(("compound", "value"), [("1#", 0.72977), ("2#", 0.49736), ("3#", 1.04982)])
def test_value_of_each_compound_at_the_reference_point(
    capsys: pytest.CaptureFixture[str], compound: str, value: float
) -> None:
    assert mu(capsys, compound=compound) == pytest.approx(value, abs=6e-6)


def test_json_is_one_line_with_the_coefficient_only(capsys: pytest.CaptureFixture[str]) -> None:
    out = predict(capsys, "--json")
    assert out.count("\n") == 1 and list(json.loads(out)) == ["mu"]


def test_text_has_five_decimals(capsys: pytest.CaptureFixture[str]) -> None:
    assert predict(capsys) == "0.72977\n"


def test_speed_may_be_given_in_another_unit(capsys: pytest.CaptureFixture[str]) -> None:
    assert mu(capsys, slip="0.3 m/s") == mu(capsys)


@pytest.mark.parametrize(("angle", "value"), [("10 deg", 0.8316), ("20 deg", 0.9893), ("30°", 1.1942)])
def test_sideslip_raises_the_resultant(capsys: pytest.CaptureFixture[str], angle: str, value: float) -> None:
    assert mu(capsys, sideslip=angle) == pytest.approx(value, abs=6e-5)


def test_wheel_speed_matters_with_sideslip_only(capsys: pytest.CaptureFixture[str]) -> None:
    assert mu(capsys, wheel_speed="0.6 m/s") == mu(capsys)
    assert mu(capsys, wheel_speed="0.6 m/s", sideslip="20 deg") < mu(capsys, sideslip="20 deg")


def test_model_v2_gives_the_better_fit(capsys: pytest.CaptureFixture[str]) -> None:
    # At its reference point the form is c + a2 (0.348869 + 0.398528).
    assert mu(capsys, model="v2") == pytest.approx(0.747397, abs=1e-6)


@pytest.mark.parametrize(
    ("option", "value", "accepted"),
    [
        ("slip", "300 N", "m/s, mm/s"),
        ("slip", "300", "m/s, mm/s"),
        ("load", "200 mm", "N, kN"),
        ("load", "twohundred", "N, kN"),
        ("temperature", "25 K", "degC"),
        ("sideslip", "20 m/s", "deg, rad"),
    ],
)
def test_wrong_unit_is_refused_naming_those_accepted(
    capsys: pytest.CaptureFixture[str], option: str, value: str, accepted: str
) -> None:
    message = refusal(capsys, **{option: value})
    assert f"--{option}" in message and accepted in " ".join(message.split())


@pytest.mark.parametrize(
    ("option", "value", "part"),
    [("compound", "4#", "1#, 2#, 3#"), ("model", "v3", "paper"), ("load", "0 N", "load"), ("load", "-5 N", "load")],
)
def test_a_point_that_the_model_does_not_cover_is_a_usage_error(
    capsys: pytest.CaptureFixture[str], option: str, value: str, part: str
) -> None:
    assert part in refusal(capsys, **{option: value})


def test_a_missing_option_is_a_usage_error() -> None:
    assert invoke(["predict", "--compound", "1#"]) == 2


def warnings(capsys: pytest.CaptureFixture[str], **options: str) -> list[str]:
    given = POINT | {f"--{name.replace('_', '-')}": value for name, value in options.items()}
    assert invoke(["predict", *(word for pair in given.items() for word in pair)]) == 0
    return capsys.readouterr().err.splitlines()


def test_inside_the_data_there_is_no_warning(capsys: pytest.CaptureFixture[str]) -> None:
    assert warnings(capsys) == []
    assert warnings(capsys, load="400 N", temperature="85 degC", slip="400 mm/s") == []


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"load": "99 N"}, "load 99 N is outside the paper's data, 100 to 400 N"),
        ({"load": "401 N"}, "load 401 N is outside"),
        ({"slip": "410 mm/s"}, "slip velocity 410 mm/s is outside the paper's data, 0 to 400 mm/s"),
        ({"slip": "-100 mm/s"}, "slip velocity -100 mm/s is outside"),
        ({"temperature": "24 degC"}, "temperature 24 degC is outside the paper's data, 25 to 85 degC"),
        ({"temperature": "86 degC"}, "temperature 86 degC is outside"),
        ({"slip": "0 mm/s"}, "the wheel rolls"),
        ({"compound": "3#", "sideslip": "10 deg"}, "no valid data of 3# with a sideslip angle"),
        ({"sideslip": "-10 deg"}, "0.58 sin|sideslip| of 1# is this project's"),
    ],
)
def test_the_basis_of_the_value_is_stated_once(
    capsys: pytest.CaptureFixture[str], options: dict[str, str], said: str
) -> None:
    (line,) = warnings(capsys, **options)
    assert line.startswith("warning: ") and said in line


def test_each_exceeded_bound_is_reported(capsys: pytest.CaptureFixture[str]) -> None:
    assert len(warnings(capsys, compound="2#", sideslip="31 deg", load="500 N")) == 2


def test_the_other_law_of_the_paper_warns_too_and_a_foreign_one_does_not(capsys: pytest.CaptureFixture[str]) -> None:
    assert warnings(capsys, model="v2", load="50 N")
    assert not warnings(capsys, model="tests.sim.physics.test_caveats:flat", load="50 N")


def test_a_belt_that_would_run_backwards_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    message = refusal(capsys, slip="801 mm/s")
    assert "backwards" in message and "expected at most 800 mm/s" in message


def test_a_belt_at_rest_is_not_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert predict(capsys, slip="800 mm/s")
