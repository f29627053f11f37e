"""Sections of files that people write: strict, described for editors, their errors in the words of the file.

An error names its place, the expected value, and the key that was probably meant.
"""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterator, Mapping
from functools import partial
from itertools import islice
from typing import TYPE_CHECKING, cast, get_args

from pydantic import BaseModel, ConfigDict

from tester.base.source import MAX_PROBLEMS, Location, Problem, Tree, Value
from tester.base.units import Quantity, expected, shown

if TYPE_CHECKING:
    from pydantic import ValidationError
    from pydantic.fields import FieldInfo
    from pydantic_core import ErrorDetails

class Section(BaseModel, frozen=True):
    """A section of a file: no key beyond its fields, whose docstrings editors show."""

    model_config = ConfigDict(extra="forbid", strict=True, use_attribute_docstrings=True)


class WithSection:
    """What marks a field whose value may also be a section, which its annotation does not show."""

    __slots__ = ()

    def section(self) -> type[BaseModel] | None:
        """Return the model of that section; None where there is none."""
        raise NotImplementedError


def editor_schema(model: type[BaseModel]) -> dict[str, object]:
    """Return the JSON Schema (2020-12) of a file, for editors."""
    schema: dict[str, object] = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    schema.update(cast("dict[str, object]", _for_editors(model.model_json_schema(by_alias=True))))
    return schema


def editor_text(model: type[BaseModel]) -> str:
    """Return the JSON Schema as the text of a file, such as ``recipes/recipe.schema.json``."""
    return json.dumps(editor_schema(model), indent=2, ensure_ascii=False) + "\n"


def _for_editors(node: object) -> object:
    """Drop entries that mislead an editor: generated titles, null for "left out", defaults without their unit."""
    if isinstance(node, list):
        return [_for_editors(item) for item in cast("list[object]", node)]
    if not isinstance(node, dict):
        return node
    entries = cast("dict[str, object]", node)
    tidy = {
        key: _for_editors(value)
        for key, value in entries.items()
        if not (key == "title" and isinstance(value, str))
        and not (key == "default" and not isinstance(value, str | int))
    }
    choices = tidy.get("anyOf")
    if isinstance(choices, list):
        kept = [item for item in cast("list[object]", choices) if item != {"type": "null"}]
        if len(kept) == 1 and isinstance(kept[0], dict):
            del tidy["anyOf"]
            return {**cast("dict[str, object]", kept[0]), **tidy}
        tidy["anyOf"] = kept
    return tidy


NEARLY, SOMEWHAT = 0.75, 0.6
"""Least similarity of a key to the one it is taken for (difflib), before and after the comparison of words."""
SHORTEST = 3
"""Shortest word that is compared."""

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
"""Pydantic's type errors in words for authors of YAML."""


def problems_of(
    error: ValidationError, tree: Tree, model: type[BaseModel] | None = None, missing: str = ""
) -> list[Problem]:
    """Return a pydantic error as problems, sorted by position.

    With ``model`` (the validated class) unknown and missing keys name the valid ones. ``missing`` is added to the
    message for a missing key whose field has no description.
    """
    details = islice(error.errors(include_url=False), MAX_PROBLEMS + 1)
    errors_found = list(details)
    meant = {(at[:-1], near) for at, near in _misspelt(errors_found, tree, model)}
    return sorted(
        {_problem(detail, tree, model, missing) for detail in errors_found if not _is_meant(detail, tree, meant)}
    )


def _misspelt(details: list[ErrorDetails], tree: Tree, model: type[BaseModel] | None) -> Iterator[tuple[Location, str]]:
    """Yield the place of each unknown key, and the key that was probably meant."""
    for detail in details:
        if detail["type"] == "extra_forbidden":
            at, _ = _locate(detail["loc"], tree.data)
            key = str(detail["loc"][-1])
            near = _meant(key, model, at, tree)
            for name in near if not _elsewhere(key, near, model) else ():
                yield at, name


def _is_meant(detail: ErrorDetails, tree: Tree, meant: set[tuple[Location, str]]) -> bool:
    """Return whether a missing key is present but misspelt: one mistake is one problem."""
    if detail["type"] != "missing" or not detail["loc"]:
        return False
    return (_locate(detail["loc"], tree.data)[0], str(detail["loc"][-1])) in meant


def _problem(detail: ErrorDetails, tree: Tree, model: type[BaseModel] | None, missing: str) -> Problem:
    at, value = _locate(detail["loc"], tree.data)
    kind, key = detail["type"], str(detail["loc"][-1]) if detail["loc"] else ""
    if kind == "extra_forbidden":
        return Problem(tree.name, *tree.key_position(at), _unknown(key, model, at, tree))
    if kind == "missing":
        info = _fields(model, at).get(key)
        described = info is not None and bool(info.description)
        words = _missing(key, info) + (f"; {missing}" if missing and not described else "")
        return Problem(tree.name, *tree.key_position(at), words)
    message = _message(detail, value)
    names = [piece for piece in at if isinstance(piece, str)]
    return tree.problem(at, f"{names[-1]}: {message}" if names else message)


def _locate(loc: Location, data: Value) -> tuple[Location, Value]:
    """Return pydantic's location as far as it exists in the file, without the names of validators in between, and its
    value."""
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
    """Return the fields of the mapping at a location, by their keys in the file."""
    models = [] if model is None else [model]
    for piece in at:
        below = [
            inner
            for each in models
            for name, info in each.model_fields.items()
            if (info.alias or name) == piece
            for inner in (*_models_in(info.annotation), *_sections_of(info))
        ]
        models = below or models
    return {info.alias or name: info for each in models for name, info in each.model_fields.items()}


def _sections_of(info: FieldInfo) -> Iterator[type[BaseModel]]:
    for item in _annotations(info):
        section = item.section() if isinstance(item, WithSection) else None
        if section is not None:
            yield section


def _models_in(annotation: object) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for inner in get_args(annotation):
        yield from _models_in(inner)


def _meant(key: str, model: type[BaseModel] | None, at: Location, tree: Tree) -> list[str]:
    """Return the keys that were probably meant by an unknown one at a location; empty where none is similar.

    Keys that are not yet in the file come first, and of them the required ones.
    """
    valid = _fields(model, at[:-1])
    free = {name: info for name, info in valid.items() if (*at[:-1], name) not in tree.keys}
    return _nearest(key, free) or difflib.get_close_matches(_tidy(key), list(valid), n=1, cutoff=NEARLY)


def _nearest(key: str, free: Mapping[str, FieldInfo]) -> list[str]:
    """Return the keys of ``free`` most similar to an unknown key; required ones come first.

    First choice is a key with nearly the same spelling; then keys with all its words in their name or their quantity's:
    ``slip_speed`` is a slip velocity, which is a speed, and ``angle`` the sideslip or the camber; last, a key with a
    somewhat similar spelling.
    """
    due = {name: info for name, info in free.items() if info.is_required()}
    for like in (partial(_spelt, cutoff=NEARLY), _of_the_words, partial(_spelt, cutoff=SOMEWHAT)):
        if found := like(key, due) or like(key, free):
            return found
    return []


def _spelt(key: str, fields: Mapping[str, FieldInfo], cutoff: float) -> list[str]:
    return difflib.get_close_matches(_tidy(key), list(fields), n=1, cutoff=cutoff)


def _of_the_words(key: str, fields: Mapping[str, FieldInfo]) -> list[str]:
    """Return the keys that have all words of an unknown key, or their beginnings, in their name or their quantity's."""
    words = tuple(word for word in _tidy(key).split("_") if word)
    if not words or any(len(word) < SHORTEST for word in words):
        return []
    matching: list[str] = []
    for name, info in fields.items():
        known = [*name.split("_"), *_quantity_in(info).partition(" such as")[0].split()]
        if all(any(part.startswith(word) for part in known) for word in words):
            matching.append(name)
    return matching[:2]


def _tidy(key: str) -> str:
    return key.strip().casefold().replace("-", "_").replace(" ", "_")[:40]


def _elsewhere(key: str, near: list[str], model: type[BaseModel] | None) -> list[str]:
    """Return the sections that have exactly this key, none if a key here is spelt nearly alike."""
    if model is None or difflib.get_close_matches(_tidy(key), near, cutoff=NEARLY):
        return []
    return list(dict.fromkeys(_sections_with(key, model)))


def _sections_with(key: str, model: type[BaseModel], section: str = "") -> Iterator[str]:
    """Return the sections of a file, except itself, that have a key."""
    for name, info in model.model_fields.items():
        if section and (info.alias or name) == key:
            yield section
        for below in dict.fromkeys(_models_in(info.annotation)):
            yield from _sections_with(key, below, info.alias or name)


def _unknown(key: str, model: type[BaseModel] | None, at: Location, tree: Tree) -> str:
    near, valid = _meant(key, model, at, tree), list(_fields(model, at[:-1]))
    elsewhere = _elsewhere(key, near, model)
    meant = f", did you mean {' or '.join(near)}?" if near else ""
    if elsewhere:
        meant = f" here: it goes into {' or '.join(elsewhere)}"
    listed = f" (expected one of {', '.join(valid)})" if valid else ""
    return f"unknown key {shown(key)}{meant}{listed}"


def _missing(key: str, info: FieldInfo | None) -> str:
    due = "" if info is None else info.description or _quantity_in(info)
    return f"{key} is missing" + (f" (expected {due})" if due else "")


def _quantity_in(info: FieldInfo) -> str:
    """Return the expected form of a field's quantity, anywhere in its annotation, or an empty text."""
    return next((expected(item.unit) for item in _annotations(info) if isinstance(item, Quantity)), "")


def _annotations(info: FieldInfo) -> Iterator[object]:
    """Yield everything in a field's annotation, at any depth."""
    waiting: list[object] = [*info.metadata, info.annotation]
    while waiting:
        item = waiting.pop()
        yield item
        waiting.extend(get_args(item))


def _message(detail: ErrorDetails, value: Value) -> str:
    kind, message = detail["type"], detail["msg"]
    value_words = "nothing" if value is None else shown(str(value)) if not isinstance(value, list | dict) else "this"
    if kind in _EXPECTED:
        return f"{value_words} is not accepted (expected {_EXPECTED[kind]})"
    if kind in ("literal_error", "enum"):
        return _choice(str(value), str(detail.get("ctx", {}).get("expected", "")), value_words)
    if kind == "value_error":
        return message.removeprefix("Value error, ")
    if message.startswith("Input should be "):
        return f"{value_words} is not accepted (expected {message.removeprefix('Input should be ')})"
    return message


def _choice(value: str, choices: str, value_words: str) -> str:
    names = choices.replace(" or ", ", ").replace("'", "").split(", ")
    near = difflib.get_close_matches(value.casefold()[:40], names, n=1, cutoff=0.6)
    meant = f", did you mean {near[0]}?" if near else ""
    return f"{value_words} is not accepted{meant} (expected {choices})"
