"""The rig files that ship with a kind; the parameters of a laboratory's own interlocks stand in them by default."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from tester.base.source import Tree, load_tree
from tester.inputs.rig.config import Rig
from tester.inputs.rig.parameter import SECTION, key_line


def packaged_name(kind: type[Rig], like: str = "") -> str:
    """Return the name of a packaged rig: the one asked for, else, or if there is none of that name, the first."""
    return like if like in kind.packaged else next(iter(kind.packaged))


@cache
def packaged_text(kind: type[Rig], like: str = "") -> str:
    """Return the text of a packaged file, with a line for each parameter that its section ``interlocks`` lacks."""
    package, _, file = kind.packaged[packaged_name(kind, like)].partition(":")
    text = (files(package) / file).read_text(encoding="utf-8")
    tree = load_tree(text, file)
    section = tree.data.get(SECTION) if isinstance(tree.data, dict) else None
    new = [key_line(one) for one in kind.parameters if one.key not in section] if isinstance(section, dict) else []
    if not new:
        return text
    lines, place = text.splitlines(), tree.keys[(SECTION,)][0]
    return "\n".join([*lines[:place], *new, *lines[place:]]) + "\n"


@cache
def packaged_tree(kind: type[Rig], like: str = "") -> Tree:
    """Return a packaged file as data, for those who do not change it."""
    return new_tree(kind, like)


def new_tree(kind: type[Rig], like: str = "") -> Tree:
    """Return a packaged file as data of the caller's own."""
    name = packaged_name(kind, like)
    return load_tree(packaged_text(kind, like), kind.packaged[name].replace(":", "/"))
