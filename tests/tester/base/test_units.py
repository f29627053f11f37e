"""tester.base.units: quantities of this domain as text."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from typing import Annotated

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import BaseModel, ValidationError

from tester.base import units
from tester.base.units import Quantity, UnitError, as_text, expected, parse, parse_one_of, shown, units_like

UNITS = [
    "m/s", "mm/s", "m/s2", "mm/s2", "N", "kN", "s", "min", "h", "ms", "degC", "K", "deg", "rad", "deg/s", "rad/s",
    "mm", "m", "um", "Hz", "kHz", "W", "kW", "J", "N m", "J/K", "W/K", "kg/m3", "J/(kg K)", "W/(m K)", "W/(m2 K)",
    "N/mm", "N s/m", "mm3/(N m)", "K/s", "N/K", "N/s", "bit/s", "kbit/s", "rev", "%", "1",
]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("0.8 m/s", "m/s", 0.8),
        ("700 mm/s", "m/s", 0.7),
        ("-300 mm/s", "m/s", -0.3),
        ("−300 mm/s", "m/s", -0.3),
        ("0.3 m/s", "mm/s", 300.0),
        ("0.2 kN", "N", 200.0),
        ("4 min", "s", 240.0),
        ("4min", "s", 240.0),
        ("1.5 h", "min", 90.0),
        ("50 ms", "s", 0.05),
        ("25 degC", "degC", 25.0),
        ("25 °C", "degC", 25.0),
        ("25°C", "degC", 25.0),
        ("25 C", "degC", 25.0),
        ("2 degC", "K", 2.0),
        ("2 K", "K", 2.0),
        ("10 deg", "deg", 10.0),
        ("10°", "deg", 10.0),
        ("50 µm", "mm", 0.05),
        ("50 μm", "mm", 0.05),
        ("100 Hz", "Hz", 100.0),
        ("5 %", "1", 0.05),
        ("0.06", "1", 0.06),
        ("5 %", "%", 5.0),
        ("14 W/(m²·K)", "W/(m2 K)", 14.0),
        ("14 W / ( m2 K )", "W/(m2 K)", 14.0),
        ("1850 J/kg/K", "J/(kg K)", 1850.0),
        ("0.08 mm3/Nm", "mm3/(N m)", 0.08),
        ("400 N s/m", "N s/m", 400.0),
        ("2 N·m", "N m", 2.0),
        ("500 kbit/s", "bit/s", 500_000.0),
        ("300 mm·s⁻¹", "m/s", 0.3),
        ("30 revolutions", "rev", 30.0),
        ("1e3 N", "N", 1000.0),
        (".5 s", "s", 0.5),
    ],
)
def test_a_quantity_has_exactly_its_stated_value(text: str, unit: str, value: float) -> None:
    assert parse(text, unit) == value


def test_radians_convert_to_degrees() -> None:
    assert parse("1 rad", "deg") == pytest.approx(57.29577951308232, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "unit", "said"),
    [
        ("0.8", "m/s", 'has no unit (expected a speed such as "0.8 m/s"; units accepted: m/s, mm/s)'),
        ("5 W", "m/s", "has the unit of power"),
        ("200 n", "N", "did you mean N?"),
        ("3 sekonds", "s", 'unknown unit "sekonds"'),
        ("0,8 m/s", "m/s", "decimal comma"),
        ("fast", "m/s", "is not a number with a unit"),
        ("", "m/s", "is not a number with a unit"),
        ("300 K", "degC", "temperature differences"),
        ("0x10 N", "N", "unknown unit"),
        ("1e999 N", "N", "too large"),
        ("nan N", "N", "is not a number"),
        ("٣ N", "N", "is not a number"),
        ("9" * 100 + " N", "N", "too long"),
    ],
)
def test_a_text_that_is_not_a_quantity_is_refused_with_the_reason(text: str, unit: str, said: str) -> None:
    with pytest.raises(UnitError) as raised:
        parse(text, unit)
    assert said in str(raised.value)


@pytest.mark.parametrize("unit", UNITS)
def test_a_refusal_names_every_unit_that_is_accepted(unit: str) -> None:
    with pytest.raises(UnitError) as raised:
        parse("1 furlong", unit)
    assert all(one in str(raised.value) for one in units_like(unit) if one != "1")


@pytest.mark.parametrize("unit", UNITS)
def test_the_example_in_a_message_is_itself_accepted(unit: str) -> None:
    example = expected(unit).split('"')[1]
    assert isinstance(parse(example, unit), float)


def test_a_quantity_of_several_kinds_keeps_its_kind() -> None:
    assert parse_one_of("30 rev", ("rev", "s")) == (30.0, "rev")
    assert parse_one_of("1 min", ("rev", "s")) == (60.0, "s")


def test_minus_zero_is_zero() -> None:
    assert str(parse("-0 mm/s", "m/s")) == "0.0"


@given(st.floats(allow_nan=False, allow_infinity=False, min_value=-1e15, max_value=1e15), st.sampled_from(UNITS))
@settings(max_examples=200, deadline=None)
def test_a_value_survives_being_written_and_read(value: float, unit: str) -> None:
    value = round(value, 6)
    assert parse(as_text(value, unit).removesuffix(" 1"), unit) == value


@given(st.text(max_size=60), st.sampled_from(UNITS))
@settings(max_examples=300, deadline=None)
def test_any_text_is_a_number_or_refused(text: str, unit: str) -> None:
    try:
        value = parse(text, unit)
    except UnitError as error:
        assert "\n" not in str(error)
    else:
        assert value == value


def test_a_long_text_is_cut_in_a_message() -> None:
    assert len(shown("x" * 1000)) <= 42


class Model(BaseModel):
    """A model with quantities."""

    speed: Annotated[float, Quantity("m/s", gt=0, le=1.0)] = 0.8
    period: Annotated[float, Quantity("s", bare=True)] = 1.0
    share: Annotated[float, Quantity("1")] = 0.5


def test_a_field_reads_text_in_its_unit() -> None:
    assert Model.model_validate({"speed": "800 mm/s"}).speed == 0.8


def test_a_bare_number_is_refused_where_a_unit_is_due() -> None:
    with pytest.raises(ValidationError, match=r"0\.8 has no unit .*units accepted: m/s, mm/s"):
        Model.model_validate({"speed": 0.8})


def test_a_bare_number_counts_in_the_unit_where_that_is_allowed() -> None:
    read = Model.model_validate({"period": 2, "share": 0.25})
    assert (read.period, read.share) == (2.0, 0.25)


@pytest.mark.parametrize("value", [True, None, ["1 s"], {"s": 1}, float("nan"), float("inf")])
def test_not_a_number_is_refused_even_where_bare_numbers_are_allowed(value: object) -> None:
    with pytest.raises(ValidationError):
        Model.model_validate({"period": value})


@pytest.mark.parametrize(("text", "said"), [("0 m/s", "more than 0 m/s"), ("1.1 m/s", "at most 1 m/s")])
def test_a_value_out_of_bounds_is_refused_with_the_bound_in_its_unit(text: str, said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        Model.model_validate({"speed": text})


def test_braces_in_a_users_text_stay_text() -> None:
    with pytest.raises(ValidationError, match=r"\{message\} \{0\}"):
        Model.model_validate({"speed": "1 {message} {0}"})


def test_json_has_quantities_as_a_file_has_them() -> None:
    assert Model().model_dump(mode="json") == {"speed": "0.8 m/s", "period": 1.0, "share": 0.5}


def test_the_schema_gives_editors_the_form() -> None:
    properties = Model.model_json_schema()["properties"]
    assert properties["speed"]["type"] == "string"
    assert {"type": "number"} in properties["period"]["anyOf"]


def test_units_load_without_pydantic() -> None:
    code = "import sys, tester.base.units; sys.exit('pydantic' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.fixture
def viscosity() -> Iterator[None]:
    before = dict(units._KIND_OF)
    units.add_kind("a viscosity", "50 mPa s", {"mPa s": 1, "Pa s": 1000})
    yield
    units._KIND_OF.clear()
    units._KIND_OF.update(before)


@pytest.mark.usefixtures("viscosity")
def test_a_kind_that_was_added_is_read_in_all_its_units() -> None:
    assert (parse("0.05 Pa s", "mPa s"), parse("50 mPa s", "mPa s")) == (50.0, 50.0)
    with pytest.raises(UnitError, match="a viscosity such as"):
        parse("50 N", "mPa s")


@pytest.mark.usefixtures("viscosity")
def test_a_unit_of_another_kind_is_not_taken_over() -> None:
    with pytest.raises(UnitError, match="the unit N is that of a force"):
        units.add_kind("a weight", "5 N", {"N": 1})


@pytest.mark.parametrize("wrong", [{"P": 0.0}, {"P": 100.0}, {}])
def test_units_without_factors_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(UnitError, match="above 0"):
        units.add_kind("a viscosity", "1 P", wrong)


def test_a_missing_unit_is_named_with_the_known_ones_and_how_to_add_one() -> None:
    with pytest.raises(UnitError, match=r'mine: the unit "mm/ss".*did you mean.*expected one of m/s.*add_kind'):
        units.known_unit("mm/ss", "mine")
