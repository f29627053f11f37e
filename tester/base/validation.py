"""A pydantic error in the words of the file: where it is, what was expected, which key was probably meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from itertools import islice
from typing import TYPE_CHECKING, get_args

from pydantic import BaseModel

from tester.base.source import MAX_PROBLEMS, Location, Problem, Tree, Value
from tester.base.units import Quantity, expected, shown

if TYPE_CHECKING:
    from pydantic import ValidationError
    from pydantic.fields import FieldInfo
    from pydantic_core import ErrorDetails

_EXPECTED = {
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "float_type": "a number",
    "float_parsing": "a number",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "string_type": "a text (numbers and true, false, null are texts only in quotes)",
    "list_type": "a list",
    "tuple_type": "a list",
    "dict_type": "keys with values",
    "model_type": "keys with values",
    "model_attributes_type": "keys with values",
}
"""What pydantic's type errors mean to somebody who writes YAML."""


def problems_of(
    error: ValidationError, tree: Tree, model: type[BaseModel] | None, missing: str = ""
) -> list[Problem]:
    """Return the errors as problems, sorted by position; see ``tester.base.source.problems_from_validation``."""
    details = islice(error.errors(include_url=False), MAX_PROBLEMS + 1)
    found = list(details)
    meant = {(at[:-1], near) for at, near in _misspelt(found, tree, model)}
    return sorted({_problem(one, tree, model, missing) for one in found if not _is_meant(one, tree, meant)})


def _misspelt(
    details: list[ErrorDetails], tree: Tree, model: type[BaseModel] | None
) -> Iterator[tuple[Location, str]]:
    """Yield where a key is unknown, and the key that it was probably meant to be."""
    for detail in details:
        if detail["type"] == "extra_forbidden":
            at, _ = _locate(detail["loc"], tree.data)
            for near in _nearest(str(detail["loc"][-1]), list(_fields(model, at[:-1]))):
                yield at, near


def _is_meant(detail: ErrorDetails, tree: Tree, meant: set[tuple[Location, str]]) -> bool:
    """Return whether a missing key is there, misspelt: one mistake is one problem."""
    if detail["type"] != "missing" or not detail["loc"]:
        return False
    return (_locate(detail["loc"], tree.data)[0], str(detail["loc"][-1])) in meant


def _problem(detail: ErrorDetails, tree: Tree, model: type[BaseModel] | None, missing: str) -> Problem:
    at, value = _locate(detail["loc"], tree.data)
    kind, key = detail["type"], str(detail["loc"][-1]) if detail["loc"] else ""
    if kind == "extra_forbidden":
        return Problem(tree.name, *tree.key_position(at), _unknown(key, list(_fields(model, at[:-1]))))
    if kind == "missing":
        said = _missing(key, _fields(model, at).get(key)) + (f"; {missing}" if missing else "")
        return Problem(tree.name, *tree.key_position(at), said)
    message = _message(detail, value)
    names = [piece for piece in at if isinstance(piece, str)]
    return tree.problem(at, f"{names[-1]}: {message}" if names else message)


def _locate(loc: Location, data: Value) -> tuple[Location, Value]:
    """Follow pydantic's location into the file as far as it goes, past the names of validators in between."""
    at: list[str | int] = []
    for piece in loc:
        if isinstance(data, dict) and isinstance(piece, str) and piece in data:
            at.append(piece)
            data = data[piece]
        if isinstance(data, list) and isinstance(piece, int) and 0 <= piece < len(data):
            at.append(piece)
            data = data[piece]
    return tuple(at), data


def _fields(model: type[BaseModel] | None, at: Location) -> dict[str, FieldInfo]:
    """Return the fields that the mapping at a location may have, by the key they have in the file."""
    models = [] if model is None else [model]
    for piece in at:
        below = [
            found
            for one in models
            for name, info in one.model_fields.items()
            if (info.alias or name) == piece
            for found in _models_in(info.annotation)
        ]
        models = below or models
    return {info.alias or name: info for one in models for name, info in one.model_fields.items()}


def _models_in(annotation: object) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for inner in get_args(annotation):
        yield from _models_in(inner)


def _nearest(key: str, valid: list[str]) -> list[str]:
    """Return the valid key that is nearest to one, none where none is near."""
    tidy = key.strip().casefold().replace("-", "_").replace(" ", "_")
    return difflib.get_close_matches(tidy[:40], valid, n=1, cutoff=0.6)


def _unknown(key: str, valid: list[str]) -> str:
    near = _nearest(key, valid)
    meant = f", did you mean {near[0]}?" if near else ""
    listed = f" (expected one of {', '.join(valid)})" if valid else ""
    return f"unknown key {shown(key)}{meant}{listed}"


def _missing(key: str, info: FieldInfo | None) -> str:
    due = "" if info is None else info.description or _quantity_in(info)
    return f"{key} is missing" + (f" (expected {due})" if due else "")


def _quantity_in(info: FieldInfo) -> str:
    """Return what a field's quantity expects, wherever in its annotation that stands, or an empty text."""
    waiting: list[object] = [*info.metadata, info.annotation]
    while waiting:
        one = waiting.pop()
        if isinstance(one, Quantity):
            return expected(one.unit)
        waiting.extend(get_args(one))
    return ""


def _message(detail: ErrorDetails, value: Value) -> str:
    kind, message = detail["type"], detail["msg"]
    given = "nothing" if value is None else shown(str(value)) if not isinstance(value, list | dict) else "this"
    if kind in _EXPECTED:
        return f"{given} is not accepted (expected {_EXPECTED[kind]})"
    if kind in ("literal_error", "enum"):
        return _choice(str(value), str(detail.get("ctx", {}).get("expected", "")), given)
    if kind == "value_error":
        return message.removeprefix("Value error, ")
    if message.startswith("Input should be "):
        return f"{given} is not accepted (expected {message.removeprefix('Input should be ')})"
    return message


def _choice(value: str, choices: str, given: str) -> str:
    names = choices.replace(" or ", ", ").replace("'", "").split(", ")
    near = difflib.get_close_matches(value.casefold()[:40], names, n=1, cutoff=0.6)
    meant = f", did you mean {near[0]}?" if near else ""
    return f"{given} is not accepted{meant} (expected {choices})"
