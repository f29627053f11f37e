"""tester.base.yaml_events: the events of PyYAML's own classes, only sooner."""

from __future__ import annotations

import pytest
import yaml
from hypothesis import example, given, settings
from hypothesis import strategies as st
from yaml.error import MarkedYAMLError

import recipes
from tester.base.source import MAX_DEPTH
from tester.base.yaml_events import Events

PIECES = [
    "\n", "\n  ", "\n    ", " ", "  ", "- ", "\n- ", ": ", ":", ", ", ",", "[", "]", "{", "}", "#", " # said", "? ",
    "a", "load", "key: ", "\nkey: ", "100 N", "-3 mm/s", "1#", "0.5", "...", "---", "\n---\n", "'q'", '"d"', "|\n",
    "&a ", "*a", "!t ", "%", "\t", "25 °C", "a:b", "http://x", "[1 N, 2 N, 3 N]", "{a: 1, b: 2}", "x" * 1100,
]  # fmt: skip


class Plain(yaml.reader.Reader, yaml.scanner.Scanner, yaml.parser.Parser):
    """PyYAML as it is."""

    def __init__(self, text: str) -> None:
        yaml.reader.Reader.__init__(self, text)
        yaml.scanner.Scanner.__init__(self)
        yaml.parser.Parser.__init__(self)


def told(source: Plain | Events) -> list[object]:
    """Return every event with its positions and all it says; at the end the error, if there is one."""
    found: list[object] = []
    try:
        while (event := source.get_event()) is not None:
            said = {key: value for key, value in vars(event).items() if not key.endswith("_mark")}
            marks = [(m.index, m.line, m.column) for m in (event.start_mark, event.end_mark)]
            found.append((type(event).__name__, said, marks))
    except MarkedYAMLError as error:
        marks = [m and (m.line, m.column) for m in (error.problem_mark, error.context_mark)]
        found.append((type(error).__name__, error.problem, error.context, marks))
    except ValueError as error:
        found.append(repr(error))
    return found


@given(st.lists(st.sampled_from(PIECES), max_size=25).map("".join))
@example("- [1, 2\n]: x\n")
@example("[" + "100 N, " * 400 + "5 N]: x\n")
@example("- {load: [" + "100 N, " * 400 + "], a}\n")
@settings(max_examples=400, deadline=None)
def test_any_text_gives_the_events_and_errors_of_pyyaml(text: str) -> None:
    assert told(Events(text, 10_000)) == told(Plain(text))


@pytest.mark.parametrize("name", ["quickstart", "table2", "pre-grind"])
def test_recipes_give_the_events_of_pyyaml(name: str) -> None:
    text = recipes.find(name).read_text(encoding="utf-8")
    assert told(Events(text, MAX_DEPTH)) == told(Plain(text))


def test_a_list_longer_than_a_batch_keeps_every_item_with_its_place() -> None:
    text = "load: [" + ", ".join(f"{n} N" for n in range(1000)) + "]\n"
    found = told(Events(text, MAX_DEPTH))
    assert found == told(Plain(text))
    assert sum(isinstance(one, tuple) and one[0] == "ScalarEvent" for one in found) == 1001


def test_what_follows_a_long_list_is_refused_at_its_own_place() -> None:
    text = "load: [" + "1 N, " * 200 + "@]\n"
    assert told(Events(text, MAX_DEPTH)) == told(Plain(text))
