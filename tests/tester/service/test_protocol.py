from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tester.service.commands import (
    Acknowledge,
    Action,
    Answer,
    Command,
    Hold,
    Jog,
    Join,
    RunRecipe,
    Stop,
    TakeControl,
)
from tester.service.protocol import (
    Accepted,
    BadMessageError,
    Event,
    Frame,
    Frames,
    Goodbye,
    Hello,
    MachineMessage,
    PlanMessage,
    Refused,
    ServerMessage,
    Snapshot,
    encode,
    from_server,
    schema,
    to_server,
)
from tester.service.state_view import MODES
from tests.tester.service.views import HOSTILE, MACHINE, hostile, plan, state, with_alarm

SCHEMA = Path(__file__).parents[3] / "docs" / "protocol.schema.json"
EVENT = Event(7, 12.5, "2024-02-21T14:05:09.000Z", "trip", "trip", "overload: 461 N", "run")
ROW = (1.0, None, 0.5)


@pytest.mark.parametrize(
    "message",
    [
        Hello(2, "life", "0.1", 3, True, MACHINE, state(), plan(), (EVENT,), True, (ROW,)),
        Snapshot(with_alarm(state()), ROW),
        Snapshot(hostile(state()), ROW),
        EVENT,
        PlanMessage(None),
        MachineMessage(MACHINE),
        Frames((Frame(1.0, "can", True, 0x201, "0f 00"),), 12),
        Accepted(4, {"run": "x", "list": [1, None]}),
        Refused(4, HOSTILE),
        Goodbye("the service has ended"),
    ],
    ids=lambda message: type(message).__name__,
)
def test_a_message_of_the_service_comes_back_as_it_was(message: ServerMessage) -> None:
    assert from_server(encode(message)) == message


@pytest.mark.parametrize(
    "action",
    [RunRecipe("quickstart", speed=None), Hold(), Stop(fast=True), Jog("press", -1), Answer(2, "no"),
     Acknowledge(3), TakeControl(force=True)],
    ids=lambda action: action.command,
)  # fmt: skip
def test_a_command_comes_back_as_it_was(action: Action) -> None:
    assert to_server(encode(Command(5, action))) == Command(5, action)


def test_a_join_comes_back_as_it_was() -> None:
    joined = Join("tui of [/x] $(rm) <b>", control=True, service="life", since=9)
    assert to_server(encode(joined)) == joined


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b'{"type":"command","id":1,"action":{"command":"stop","fsat":true}}', "fsat"),
        (b'{"type":"command","id":1,"action":{"command":"zap"}}', "zap"),
        (b'{"type":"command","id":1,"action":{"command":"jog","axis":"wheel","direction":5}}', "direction"),
        (b'{"type":"command","id":1,"action":{"command":"run","recipe":"x","speed":-1}}', "speed"),
        (b'{"type":"command","id":1,"action":{"command":"run","recipe":"x","speed":NaN}}', "finite"),
        (b'{"type":"command","action":{"command":"stop"}}', "id"),
        (b'{"type":"join","name":"a\\u001b[2J"}', r"join.name: the character U\+001B, number 2, is not accepted"),
        (b'{"type":"command","id":1,"action":{"command":"run","recipe":"x","operator":"\\u202e"}}', "operator: .*202E"),
        (b'{"type":"command","id":1,"action":{"command":"run","recipe":"x","notes":"a\\nb"}}', r"notes: .*U\+000A"),
        (b'{"type":"command","id":1,"action":{"command":"resume","run":"x","reason":"\\u0007"}}', r"reason: .*U\+0007"),
        (b"[", "JSON"),
        (b"\xff\xfe", "JSON"),
        (b"{}", "type"),
        (b"null", "object"),
    ],
)
def test_a_wrong_message_is_refused_with_the_mistake(text: bytes, said: str) -> None:
    with pytest.raises(BadMessageError, match=said):
        to_server(text)


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=200) | st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=10),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(
        st.sampled_from(["type", "id", "action", "command", "fast"]) | st.text(max_size=5), inner, max_size=4
    ),
    max_leaves=8,
).map(lambda value: json.dumps(value).encode()))  # fmt: skip
def test_whatever_is_sent_is_a_message_or_refused(text: bytes) -> None:
    try:
        message = to_server(text)
    except BadMessageError as error:
        assert str(error)
    else:
        assert to_server(encode(message)) == message


def test_a_client_ignores_keys_of_a_newer_service() -> None:
    raw = json.loads(encode(Goodbye("bye"))) | {"mood": "good"}
    assert from_server(json.dumps(raw)) == Goodbye("bye")


def test_numbers_that_are_none_become_null() -> None:
    text = encode(Snapshot(state(), (float("nan"), float("inf"))))
    assert b"NaN" not in text and b"Infinity" not in text


def test_the_written_schema_is_that_of_the_messages() -> None:
    assert json.loads(SCHEMA.read_text(encoding="utf-8")) == schema()


def test_the_protocols_page_names_every_message_command_mode_and_column() -> None:
    page = (SCHEMA.parent / "protocol.md").read_text(encoding="utf-8")
    definitions = schema()["$defs"]
    assert isinstance(definitions, dict)
    names = {*MODES, *MACHINE.trend}
    for one in definitions.values():
        assert isinstance(one, dict)
        properties = one.get("properties")
        for key in ("type", "command"):
            if isinstance(properties, dict) and isinstance(found := properties.get(key), dict) and "const" in found:
                names.add(str(found["const"]))
    assert [name for name in sorted(names) if f"`{name}`" not in page] == []
