"""Messages from a page, read strictly, and answers to it as JSON. STOP is found in a message of any form."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, JsonValue, TypeAdapter, ValidationError
from pydantic_core import to_json

from tester.service.commands import MAX_MESSAGE, AddNote, ExcludeRepeat, Stop, StrictMessage
from tester.service.protocol import stop_in

LONGEST = MAX_MESSAGE
"""Longest message of a page, bytes: a recipe, escaped."""
Number = Annotated[int, Field(ge=0, lt=2**53)]


@dataclass(frozen=True, slots=True)
class PairPage(StrictMessage):
    """The first message of a new page: the code on the machine's screen, and the page's name for people."""

    code: Annotated[str, Field(max_length=20)]
    name: Annotated[str, Field(max_length=200)] = ""
    type: Literal["pair"] = "pair"


@dataclass(frozen=True, slots=True)
class Enter(StrictMessage):
    """The first message of a page that is paired: its secret."""

    secret: Annotated[str, Field(max_length=200)]
    type: Literal["enter"] = "enter"


@dataclass(frozen=True, slots=True)
class PageCommand(StrictMessage):
    """A command of the service's protocol, with the machine's code where it needs one."""

    id: Number
    action: dict[str, JsonValue]
    code: Annotated[str, Field(max_length=20)] = ""
    type: Literal["command"] = "command"


@dataclass(frozen=True, slots=True)
class PageQuestion:
    """A question about stored runs or this page; its other keys are read by the query."""

    id: Number
    query: Annotated[str, Field(max_length=40)]
    rest: dict[str, JsonValue] = field(default_factory=dict[str, JsonValue])


First: TypeAlias = Annotated[PairPage | Enter, Field(discriminator="type")]
FIRST: TypeAdapter[First] = TypeAdapter(First)
_COMMAND: TypeAdapter[PageCommand] = TypeAdapter(PageCommand)
_ASK: TypeAdapter[PageQuestion] = TypeAdapter(PageQuestion)
_NOTE: TypeAdapter[AddNote] = TypeAdapter(AddNote)
_EXCLUDE: TypeAdapter[ExcludeRepeat] = TypeAdapter(ExcludeRepeat)
_OBJECT: TypeAdapter[dict[str, JsonValue]] = TypeAdapter(dict[str, JsonValue])


class BadFrontError(Exception):
    """A message of a page is not one; the message gives place and reason. ``number``: its id, 0 where it has none."""

    def __init__(self, reason: str, number: int = 0) -> None:
        """Keep reason and number."""
        super().__init__(reason)
        self.number = number


def first_of(text: str | bytes) -> PairPage | Enter:
    """Return the first message of a page. Raises BadFrontError."""
    try:
        return FIRST.validate_json(text)
    except ValidationError:
        raise BadFrontError("the first message is pair or enter") from None


def message_of(text: str | bytes) -> PageCommand | PageQuestion:
    """Return a later message of a page. Raises BadFrontError."""
    number = 0
    try:
        found = _OBJECT.validate_json(text)
        given = found.get("id")
        number = given if isinstance(given, int) and not isinstance(given, bool) else 0
        if found.pop("type", None) == "ask":
            known = {key: found.pop(key) for key in ("id", "query") if key in found}
            return _ASK.validate_python({**known, "rest": found})
        return _COMMAND.validate_json(text)
    except ValidationError as error:
        raise BadFrontError(in_one_line(error), number) from None


def edit_of(question: PageQuestion) -> AddNote | ExcludeRepeat | None:
    """Return a note or an exclusion as the service's command, for a run under way; None for another question, or one
    that is not valid.
    """
    keys = {"condition" if key == "n" else key: value for key, value in question.rest.items()}
    with suppress(ValidationError):
        if question.query == "note":
            return _NOTE.validate_python(keys)
        if question.query == "exclude":
            return _EXCLUDE.validate_python(keys)
    return None


def stop_of(text: str | bytes) -> tuple[int, bool] | None:
    """Return the id of a STOP and whether it is a fast one, whatever else the message holds; None if it is no STOP."""
    found = stop_in(text)
    return (found.id, found.action.fast) if found is not None and isinstance(found.action, Stop) else None


def in_one_line(error: ValidationError) -> str:
    """Return the first mistake and its place, without quoting the message."""
    first = error.errors(include_url=False, include_input=False, include_context=False)[0]
    at = ".".join(str(piece) for piece in first["loc"])
    reason = str(first["msg"]).removeprefix("Value error, ")
    return f"{at}: {reason}" if at else reason


def to_front(kind: str, **values: JsonValue) -> bytes:
    """Return a message to a page."""
    return to_json({"type": kind, **values})


def accepted(number: int, result: bytes = b"null") -> bytes:
    """Return the answer to a command or question; ``result`` is JSON."""
    return b'{"type":"accepted","id":%d,"result":%b}' % (number, result)


def refused(number: int, reason: str) -> bytes:
    """Return the refusal of a command or question."""
    return to_front("refused", id=number, reason=reason)
