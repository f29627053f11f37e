"""tester.base.source: YAML written by people, read strictly."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Annotated

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict, Field, ValidationError

import recipes
from tester.base import source
from tester.base.source import (
    MAX_BYTES,
    MAX_DEPTH,
    MAX_PROBLEMS,
    InvalidSource,
    Problem,
    load_tree,
)
from tester.base.units import Quantity
from tester.base.validation import problems_of


@pytest.fixture(params=["CSafeLoader", "SafeLoader"])
def parser(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """libyaml, and PyYAML's own parser, which replaces it where it is missing."""
    monkeypatch.setattr(source, "_LOADER", getattr(yaml, request.param))
    return request.param


def refused(text: str) -> list[str]:
    """Return the problems of a text, as the user sees them."""
    with pytest.raises(InvalidSource) as raised:
        load_tree(text, "f.yaml")
    return [str(problem) for problem in raised.value.problems]


# -- what is read --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("scalar", "value"),
    [
        ("NO", "NO"),
        ("yes", "yes"),
        ("on", "on"),
        ("1:30", "1:30"),
        ("2024-01-01", "2024-01-01"),
        ("1_000", "1_000"),
        ("010", 10),
        ("0o17", 15),
        ("0x1F", 31),
        ("1e3", 1000.0),
        ("-.5", -0.5),
        ("1.", 1.0),
        ("true", True),
        ("FALSE", False),
        ("~", None),
        ("null", None),
        ('"true"', "true"),
        ("'5'", "5"),
        ("300 mm/s", "300 mm/s"),
        ("1#", "1#"),
    ],
)
def test_scalars_follow_the_yaml_1_2_core_schema(scalar: str, value: object) -> None:
    data = load_tree(f"a: {scalar}\n").data
    assert isinstance(data, dict)
    assert data["a"] == value
    assert type(data["a"]) is type(value)


def test_keys_are_texts() -> None:
    assert load_tree("1: a\ntrue: b\n").data == {"1": "a", "true": "b"}


def test_every_value_and_key_has_its_position() -> None:
    tree = load_tree("a: 1\nb:\n  - x\n  - {c: 2, d: [3, 4]}\n")
    assert tree.position(("a",)) == (1, 4)
    assert tree.key_position(("b",)) == (2, 1)
    assert tree.position(("b", 0)) == (3, 5)
    assert tree.key_position(("b", 1, "d")) == (4, 12)
    assert tree.position(("b", 1, "d", 1)) == (4, 19)


def test_a_missing_key_has_the_position_of_its_nearest_parent() -> None:
    assert load_tree("a:\n  b: 1\n").position(("a", "c", 3)) == (2, 3)


def test_windows_line_ends_and_a_byte_order_mark_do_not_move_positions() -> None:
    tree = load_tree("\ufeffa: 1\r\nb: 2\r\n")
    assert tree.data == {"a": 1, "b": 2}
    assert tree.position(("b",)) == (2, 4)


def test_a_file_has_the_name_that_the_caller_uses(tmp_path: Path) -> None:
    file = tmp_path / "r.yaml"
    file.write_text("a: {", encoding="utf-8")
    with pytest.raises(InvalidSource) as raised:
        load_tree(file, "recipes/r.yaml")
    assert raised.value.problems[0].file == "recipes/r.yaml"


# -- what is refused -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("a: 1\nb: 2\na: 3\n", 'f.yaml:3:1: duplicate key "a": it is in line 1 already'),
        ("a: {b: 1, b: 2}\n", 'f.yaml:1:11: duplicate key "b": it is in line 1 already'),
        ("a: &x 1\n", "f.yaml:1:4: anchors (&name) are not accepted: write the value out"),
        ("a: !!int 3\n", "f.yaml:1:4: tags (!name) are not accepted"),
        ("a: !x [1]\n", "f.yaml:1:4: tags (!name) are not accepted"),
        ("<<: {a: 1}\n", "f.yaml:1:1: merges (<<) are not accepted: write the values out"),
        ("%YAML 1.1\n---\na: 1\n", "f.yaml:1:1: directives (%YAML, %TAG) are not accepted"),
        ("a: 1\n---\nb: 1\n", "f.yaml:2:1: a second document (---) is not accepted: one file is one document"),
        ("? [a]\n: b\n", "f.yaml:1:3: a key is to be a plain text"),
        ("a: .inf\n", 'f.yaml:1:4: ".inf" is not a finite number'),
        ("a: .nan\n", 'f.yaml:1:4: ".nan" is not a finite number'),
        ("a: 1e999\n", 'f.yaml:1:4: "1e999" is too large for a number'),
        ('a: "\\u202e"\n', "f.yaml:1:4: the character U+202E is not accepted, even as an escape"),
        ("a:\n\t- b\n", "f.yaml:2:1: not YAML: a tab where spaces are due (indent with spaces)"),
        ("a: b: c\n", "f.yaml:1:5: not YAML: a colon is not expected here (a text that holds ': ' needs quotes)"),
        (
            "a:\n  - b: 1\n   c: 2\n",
            "f.yaml:3:4: not YAML: the line is indented by 3 "
            "(expected 4 as in line 2 or 2 as in line 2 or 0 as in line 1)",
        ),
        (
            "a:\n  b: 1\n   c: 2\n",
            "f.yaml:3:5: not YAML: the line is indented by 3 (expected 2 as in line 2 or 0 as in line 1)",
        ),
        ("a: 1\n# all\n b: 2\n", "f.yaml:3:2: not YAML: the line is indented by 1 (expected 0 as in line 1)"),
        ("a: 1\n\tb: 2\n", "f.yaml:2:1: not YAML: a tab where spaces are due (indent with spaces)"),
        ("  a: 1\nb: 2\n", "f.yaml:2:1: not YAML: the line is indented by 0 (expected 2 as in line 1)"),
        ("a: @b\n", "f.yaml:1:4: not YAML: @ cannot begin a text (a text that begins with it needs quotes)"),
        ("a: {b: 1\nc: 2\n", "f.yaml:2:2: not YAML: a comma or } is missing (for the bracket opened in line 1)"),
        ("a: 1\n- b\n", "f.yaml:2:1: not YAML: an item of a list (- ...) among keys"),
        ("a: [1,\n  2\nb: 3\n", "f.yaml:3:2: not YAML: a comma or ] is missing (for the bracket opened in line 1)"),
        ("", "f.yaml:1:1: the file is empty"),
        ("# only a comment\n", "f.yaml:2:1: the file is empty"),
    ],
)
@pytest.mark.usefixtures("parser")
def test_yaml_beyond_our_rules_is_refused_with_its_position(text: str, problem: str) -> None:
    assert refused(text) == [problem]


def test_an_escape_out_of_range_is_refused_where_its_value_begins_or_is(parser: str) -> None:
    column = {"CSafeLoader": 7, "SafeLoader": 1}[parser]
    assert refused('a: "\\UFFFFFFFF"\n') == [
        f"f.yaml:1:{column}: not YAML: a number in an escape or directive is out of range"
    ]


def test_an_alias_is_refused_beside_its_anchor() -> None:
    assert [line.split(": ")[1][:7] for line in refused("a: &x 1\nb: *x\n")] == ["anchors", "aliases"]


@pytest.mark.parametrize("character", ["\x00", "\x07", "\x1b", "\x7f", "\x85", "\u200b", "\u202e", "\u2028", "\u2066"])
def test_control_and_bidirectional_characters_are_refused_with_code_and_position(character: str) -> None:
    assert refused(f"a: 1\nb: x{character}y\n") == [
        f"f.yaml:2:5: the character U+{ord(character):04X} is not accepted (control, bidirectional or invisible)"
    ]


def test_all_problems_come_at_once_sorted_by_position() -> None:
    lines = refused("c: &x 1\na: !t 2\na: 3\nb: .inf\n")
    assert [line.split(":")[1] for line in lines] == ["1", "2", "3", "4"]


@pytest.mark.usefixtures("parser")
@pytest.mark.parametrize("opening", ["[", "{a: ", "[\n", "- ", "? ", "[{a: "])
def test_sixty_kilobytes_of_open_brackets_are_refused_at_the_depth_limit(opening: str) -> None:
    lines = refused(opening * (60_000 // len(opening)))
    assert len(lines) <= MAX_DEPTH + 1
    assert f"nested deeper than {MAX_DEPTH} levels" in lines[-1]


@pytest.mark.usefixtures("parser")
def test_nesting_up_to_the_limit_is_read() -> None:
    assert load_tree("[" * MAX_DEPTH + "1" + "]" * MAX_DEPTH).data


def test_a_file_beyond_the_size_limit_is_refused_unread(tmp_path: Path) -> None:
    file = tmp_path / "big.yaml"
    file.write_text("é" * MAX_BYTES, encoding="utf-8")
    with pytest.raises(InvalidSource, match="larger than 256 kB"):
        load_tree(file)


def test_a_file_that_is_not_utf_8_is_refused_at_the_byte(tmp_path: Path) -> None:
    file = tmp_path / "latin.yaml"
    file.write_bytes(b"a: 1\nb: \xb0C\n")
    with pytest.raises(InvalidSource) as raised:
        load_tree(file, "latin.yaml")
    assert str(raised.value) == "latin.yaml:2:4: not UTF-8 text (save the file as UTF-8)"


@pytest.mark.parametrize("name", ["absent.yaml", "."])
def test_a_file_that_cannot_be_read_is_a_problem_not_a_crash(tmp_path: Path, name: str) -> None:
    with pytest.raises(InvalidSource, match=r"no such file|not a file"):
        load_tree(tmp_path / name)


def test_a_file_name_cannot_steer_the_terminal() -> None:
    with pytest.raises(InvalidSource) as raised:
        load_tree("", "a\x1b[31m\n.yaml")
    assert str(raised.value).startswith("a?[31m?.yaml:1:1: ")


def test_a_hopeless_file_has_a_bounded_list_of_problems() -> None:
    lines = refused("".join(f"a: {n}\n" for n in range(MAX_PROBLEMS + 50)))
    assert len(lines) == MAX_PROBLEMS + 1
    assert lines[-1].endswith("and 49 more problems")


yaml_pieces = st.sampled_from(
    [
        *"[]{},:?-!&*#|>'\"%@`\\ \n\tab01~<.",
        "- ",
        "? ",
        ": ",
        "\n  ",
        "---\n",
        "<<",
        "%TAG ",
        "!!",
        "|2-\n",
        "\\U",
        "\\x",
    ]
)


@given(st.lists(yaml_pieces, max_size=40).map("".join) | st.text(max_size=80))
@settings(max_examples=300, deadline=None)
def test_any_text_is_a_tree_or_refused_with_positions(text: str) -> None:
    try:
        tree = load_tree(text)
    except InvalidSource as error:
        assert error.problems
        assert all(problem.line >= 1 and problem.column >= 1 for problem in error.problems)
        assert all("\n" not in problem.message for problem in error.problems)
    else:
        assert tree.positions[()] >= (1, 1)


# -- validation errors ---------------------------------------------------------------------------------------------


class Inner(BaseModel):
    """Something nested."""

    model_config = ConfigDict(extra="forbid", strict=True)

    load: Annotated[float, Quantity("N", gt=0)]
    repeats: Annotated[int, Field(ge=1)] = 5
    kind: str = "x"


class Outer(BaseModel):
    """A file."""

    model_config = ConfigDict(extra="forbid", strict=True)

    name: str
    inner: Inner
    many: list[Inner] = []


def validated(text: str) -> list[str]:
    tree = load_tree(textwrap.dedent(text), "f.yaml")
    with pytest.raises(ValidationError) as raised:
        Outer.model_validate(tree.data)
    return [str(problem) for problem in problems_of(raised.value, tree, Outer)]


def test_a_wrong_value_is_reported_at_the_value() -> None:
    assert validated("name: a\ninner: {load: 5 W}\n") == [
        'f.yaml:2:15: load: "5 W" has the unit of power (expected a force such as "200 N"; units accepted: N, kN)'
    ]


def test_an_unknown_key_is_reported_at_the_key_with_the_nearest_valid_one() -> None:
    assert validated("name: a\ninner:\n  load: 5 N\n  Repeat: 3\n") == [
        'f.yaml:4:3: unknown key "Repeat", did you mean repeats? (expected one of load, repeats, kind)'
    ]


def test_a_missing_key_is_reported_where_it_is_missing_with_the_expected_form() -> None:
    assert validated("name: a\ninner:\n  repeats: 2\n") == [
        'f.yaml:2:1: load is missing (expected a force such as "200 N"; units accepted: N, kN)'
    ]


def test_an_element_of_a_list_has_its_own_position() -> None:
    lines = validated("name: a\ninner: {load: 1 N}\nmany:\n  - {load: 2 N}\n  - {load: 0 N, repeats: 1.5}\n")
    assert lines == [
        "f.yaml:5:12: load: 0 N is too small (expected more than 0 N)",
        'f.yaml:5:26: repeats: "1.5" is not accepted (expected a whole number)',
    ]


@pytest.mark.parametrize(
    ("value", "said"),
    [("5", "(expected a text"), ("[a]", "(expected a text"), ("", "nothing is not accepted (expected a text")],
)
def test_a_value_of_another_type_is_named_in_plain_words(value: str, said: str) -> None:
    assert said in validated(f"name: {value}\ninner: {{load: 1 N}}\n")[0]


def test_problems_sort_by_position_and_read_like_a_compilers() -> None:
    late, early = Problem("f", 10, 1, "b"), Problem("f", 9, 20, "a")
    assert str(InvalidSource([late, early])) == "f:9:20: a\nf:10:1: b"


# -- two parsers ---------------------------------------------------------------------------------------------------

PIECES = [
    "\n", "\n  ", "\n    ", " ", "- ", "\n- ", ": ", ", ", ",", "[", "]", "{", "}", " # said", "a", "load", "key: ",
    "\nkey: ", "100 N", "-3 mm/s", "1#", "0.5", "---", "'q'", '"d"', "&a ", "*a", "!t ", "25 °C", "a:b", "[1 N, 2 N]",
]  # fmt: skip


def read_by(loader: str, text: str) -> tuple[object, ...] | None:
    """Return the tree with its places and problems, None for invalid YAML."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(source, "_LOADER", getattr(yaml, loader))
        try:
            tree, problems = source.read_tree(text)
        except InvalidSource:
            return None
    return tree.data, tree.positions, tree.keys, [one.message for one in problems]


@given(st.lists(st.sampled_from(PIECES), max_size=25).map("".join))
@settings(max_examples=300, deadline=None)
def test_both_parsers_agree_on_texts_that_both_read(text: str) -> None:
    by_libyaml, by_pyyaml = read_by("CSafeLoader", text), read_by("SafeLoader", text)
    if by_libyaml is not None and by_pyyaml is not None:
        (data, _, *others), (same, _, *same_others) = by_libyaml, by_pyyaml
        assert (data, others) == (same, same_others)  # an omitted value has a different place in each


@pytest.mark.parametrize("name", ["quickstart", "table2", "pre-grind"])
def test_both_parsers_read_a_recipe_alike(name: str) -> None:
    text = recipes.find(name).read_text(encoding="utf-8")
    by_libyaml = read_by("CSafeLoader", text)
    assert by_libyaml is not None and by_libyaml == read_by("SafeLoader", text)
