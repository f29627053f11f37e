"""A strict section of a file that people write, and its JSON Schema for editors."""

from __future__ import annotations

import json
from typing import cast

from pydantic import BaseModel, ConfigDict


class Section(BaseModel, frozen=True):
    """A section of a file: no key beyond its fields, whose docstrings editors show."""

    model_config = ConfigDict(extra="forbid", strict=True, use_attribute_docstrings=True)


def editor_schema(model: type[BaseModel]) -> dict[str, object]:
    """Return the JSON Schema (2020-12) of a file, for editors."""
    schema: dict[str, object] = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    schema.update(cast("dict[str, object]", _tidy(model.model_json_schema(by_alias=True))))
    return schema


def editor_text(model: type[BaseModel]) -> str:
    """Return the JSON Schema as the text of a file, such as ``recipes/recipe.schema.json``."""
    return json.dumps(editor_schema(model), indent=2, ensure_ascii=False) + "\n"


def _tidy(node: object) -> object:
    """Drop entries that mislead an editor: generated titles, null for "left out", defaults without their unit."""
    if isinstance(node, list):
        return [_tidy(item) for item in cast("list[object]", node)]
    if not isinstance(node, dict):
        return node
    entries = cast("dict[str, object]", node)
    tidy = {
        key: _tidy(value)
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
