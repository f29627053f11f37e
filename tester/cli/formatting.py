"""How commands show what is stored: as JSON, and text that somebody else wrote."""

from __future__ import annotations

import json

import click

from tester.base.words import Json


def shown(text: str) -> str:
    """Return text that a person or a device wrote, harmless for a terminal."""
    return "".join(c if c.isprintable() else "�" for c in text)


def dump(value: Json) -> None:
    """Print JSON, indented."""
    click.echo(json.dumps(value, ensure_ascii=False, allow_nan=False, indent=1))
