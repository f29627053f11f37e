"""Configuration files to dataclasses and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

import pytest

from tester.base.config_reader import Range, as_text, as_tree, key_of, read
from tester.base.source import InvalidSource, load_tree


@dataclass(frozen=True, slots=True)
class Inner:
    load_n: Annotated[float, "N", Range(gt=0.0, le=450.0)] = 200.0

    def __post_init__(self) -> None:
        if self.load_n == 13.0:
            raise ValueError("13 N is unlucky")


@dataclass(frozen=True, slots=True)
class Outer:
    wheel_speed_m_s: Annotated[float, "m/s"]
    share: Annotated[float, "1"] = 0.5
    torque_nm: Annotated[float, "N.m"] = 2.0
    counts: float = 1.0
    mode: Literal["velocity", "position"] = "velocity"
    limits: tuple[float, float] | None = None
    inner: Inner = field(default_factory=Inner)
    named: Mapping[str, Inner] = field(default_factory=dict[str, Inner])
    on: bool = False
    node: int = 1
    text: str = ""


@dataclass(frozen=True, slots=True)
class Pair:
    load_n: Annotated[float, "N"] = 1.0
    share: Annotated[float, "1"] = 0.5

    def __post_init__(self) -> None:
        if self.load_n < self.share:
            raise ValueError("the load is below the share")


@dataclass(frozen=True, slots=True)
class Packaged:
    pairs: Mapping[str, Pair] = field(default_factory=lambda: {"soft": Pair(2.0, 0.1), "hard": Pair(7.0)})


def packaged(text: str) -> Packaged:
    return read(Packaged, load_tree(text, "rig.yaml"))


def outer(text: str) -> Outer:
    return read(Outer, load_tree(text, "rig.yaml"))


def problems(text: str) -> list[str]:
    with pytest.raises(InvalidSource) as caught:
        outer(text)
    return [str(problem) for problem in caught.value.problems]


def test_key_is_the_field_name_without_the_suffix_of_its_own_unit() -> None:
    assert key_of(Outer, "wheel_speed_m_s") == "wheel_speed"


def test_key_of_a_field_without_a_unit_is_its_name() -> None:
    assert key_of(Outer, "counts") == "counts"


def test_a_quantity_is_converted_to_the_unit_of_its_field() -> None:
    assert outer("wheel_speed: 800 mm/s").wheel_speed_m_s == 0.8


def test_a_bare_number_counts_in_the_unit_of_its_field() -> None:
    assert outer("wheel_speed: 0.8").wheel_speed_m_s == 0.8


def test_a_ratio_may_be_given_in_percent() -> None:
    assert outer("{wheel_speed: 1, share: 20 %}").share == 0.2


def test_a_unit_written_with_a_point_is_the_one_of_the_table() -> None:
    assert outer("{wheel_speed: 1, torque: 16 N m}").torque_nm == 16.0


def test_a_missing_key_takes_the_default_of_the_dataclass() -> None:
    assert outer("wheel_speed: 1").inner == Inner(200.0)


def test_a_missing_key_without_default_is_a_problem_that_names_the_expected_form() -> None:
    assert problems("counts: 1") == [
        'rig.yaml:1:1: wheel_speed is missing (expected a speed such as "0.8 m/s"; units accepted: m/s, mm/s)'
    ]


def test_a_wrong_unit_is_a_problem_at_its_place() -> None:
    (problem,) = problems("wheel_speed: 1\ninner:\n  load: 3 m/s")
    assert problem.startswith("rig.yaml:3:9: load: ") and "N, kN" in problem


def test_a_value_outside_its_range_is_a_problem() -> None:
    (problem,) = problems("wheel_speed: 1\ninner: {load: 451}")
    assert "too large" in problem


def test_an_unknown_key_is_a_problem_that_names_the_nearest() -> None:
    (problem,) = problems("wheel_speed: 1\ninner: {laod: 3 N}")
    assert problem.startswith('rig.yaml:2:9: unknown key "laod", did you mean load?')


def test_the_name_with_its_suffix_is_not_a_key() -> None:
    (problem,) = problems("wheel_speed_m_s: 1")
    assert 'unknown key "wheel_speed_m_s", did you mean wheel_speed?' in problem


def test_a_refusal_of_the_dataclass_itself_is_a_problem_at_its_section() -> None:
    assert problems("wheel_speed: 1\ninner:\n  load: 13 N") == ["rig.yaml:3:3: inner: 13 N is unlucky"]


def test_every_problem_is_reported_at_once() -> None:
    assert len(problems("wheel_speed: 1 N\nshare: x\ninner: {load: -1}\nmode: torque\nfoo: 1")) == 5


@pytest.mark.parametrize("text", ["node: true", "node: 1.5", "on: 1", "text: 7", "counts: fast", "limits: [1, 2, 3]"])
def test_types_are_strict(text: str) -> None:
    assert len(problems(f"wheel_speed: 1\n{text}")) == 1


def test_a_list_becomes_a_tuple() -> None:
    assert outer("{wheel_speed: 1, limits: [-1, 2.5]}").limits == (-1.0, 2.5)


def test_a_mapping_of_sections_keeps_its_names() -> None:
    assert outer("{wheel_speed: 1, named: {a: {load: 1 N}, b: {}}}").named == {"a": Inner(1.0), "b": Inner(200.0)}


def test_the_tree_of_a_configuration_holds_quantities_with_units() -> None:
    tree = as_tree(Outer(0.8))
    assert tree["wheel_speed"] == "0.8 m/s" and tree["torque"] == "2 N m" and tree["share"] == 0.5


@pytest.mark.parametrize("text", ["no", "1e3", "0o17", "a: b", "# no comment", "null", "", "ein Prüfstand", "1:30"])
def test_a_text_survives_writing_and_reading(text: str) -> None:
    config = Outer(0.8, text=text)
    assert outer(as_text(config)) == config


@pytest.mark.parametrize("value", [0.1, 1 / 3, 6000 / 6.283185307179586, 1e-7, 123456789.25, 450.0])
def test_a_number_survives_writing_and_reading_exactly(value: float) -> None:
    config = Outer(value, counts=value, limits=(-value, value), named={"a": Inner(min(value, 450.0))})
    assert outer(as_text(config)) == config


def test_a_packaged_entry_keeps_the_keys_that_the_file_does_not_state() -> None:
    assert packaged("pairs: {soft: {load: 3 N}}").pairs == {"soft": Pair(3.0, 0.1), "hard": Pair(7.0)}


def test_an_empty_section_leaves_the_packaged_entries() -> None:
    assert packaged("pairs: {}") == packaged("pairs: {soft: {}}") == Packaged()


def test_an_entry_with_a_new_name_is_beside_the_packaged_ones() -> None:
    assert packaged("pairs: {own: {load: 3 N, share: 0.2}}").pairs == {**Packaged().pairs, "own": Pair(3.0, 0.2)}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("  sofd: {load: 3 N}", "3: share is missing (expected every key of a new name; known names: soft, hard)"),
        ("  own: {load: 3 N, shar: 1}", '20: unknown key "shar", did you mean share? (expected one of load, share)'),
        ("  soft: {load: 0}", "9: soft: the load is below the share"),
        ("  soft: 3", '9: soft: "3" is not accepted (expected keys with values)'),
        ("  3", '3: pairs: "3" is not accepted (expected keys with values)'),
    ],
)
def test_an_entry_that_does_not_fit_is_one_problem_at_its_place(text: str, message: str) -> None:
    with pytest.raises(InvalidSource) as caught:
        read(Packaged, load_tree(f"pairs:\n{text}", "rig.yaml"), "the builder knows it")
    assert [str(problem) for problem in caught.value.problems] == [f"rig.yaml:2:{message}"]


def test_a_merged_entry_survives_writing_and_reading() -> None:
    config = packaged("pairs: {soft: {load: 0.3333333333333333 N}, own: {load: 3, share: 0}}")
    assert packaged(as_text(config)) == config
