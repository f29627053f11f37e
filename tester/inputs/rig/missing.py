"""Keys that a rig file lacks: which may take the value of the packaged file, and the file completed with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from copy import deepcopy

from tester.base.source import Tree, Value
from tester.inputs.rig.config import Rig
from tester.inputs.rig.packaged import packaged_tree

Place = tuple[str, ...]
"""Where a key stands: the names of its sections, and its own."""


def lacking(kind: type[Rig], tree: Tree) -> tuple[Place, ...]:
    """Return the keys that a file may lack and does, in the packaged file's order; a missing section as its keys."""
    packaged = packaged_tree(kind, like(tree)).data
    if not isinstance(packaged, dict) or not isinstance(tree.data, dict):
        return ()
    return tuple(_lacking(kind, packaged, tree.data, ()))


def complete(kind: type[Rig], tree: Tree) -> None:
    """Write the packaged values of the keys that it may lack into a tree."""
    packaged = packaged_tree(kind, like(tree)).data
    for place in lacking(kind, tree):
        value, section = packaged, tree.data
        for key in place[:-1]:
            assert isinstance(value, dict) and isinstance(section, dict)  # else it would not be lacking there
            value = value[key]
            if section.get(key) is None:
                section[key] = {}
            section = section[key]
        assert isinstance(value, dict) and isinstance(section, dict)
        section[place[-1]] = deepcopy(value[place[-1]])


def unstated(kind: type[Rig], tree: Tree) -> Iterator[Place]:
    """Yield the keys that a file has to say itself and does not, of sections that it has (``Rig.stated``)."""
    for place in (tuple(one.split(".")) for one in kind.stated):
        due, own = packaged_tree(kind, like(tree)).data, tree.data
        for key in place:
            due = due.get(key) if isinstance(due, dict) else None
            own = own.get(key) if isinstance(own, dict) else None
        if isinstance(due, dict) and isinstance(own, dict):
            yield from ((*place, key) for key in due if key not in own)


def like(tree: Tree) -> str:
    """Return the packaged rig that a file says it is built like, "" for the first of its kind."""
    found = tree.data.get("like") if isinstance(tree.data, dict) else None
    return found if isinstance(found, str) else ""


def _lacking(
    kind: type[Rig], packaged: Mapping[str, Value], own: Mapping[str, Value], above: Place
) -> Iterator[Place]:
    for key, value in packaged.items():
        place = (*above, key)
        inner = own.get(key)
        if isinstance(value, dict):
            if inner is None and _leads_to_some(kind, place) and (key not in own or _may_lack(kind, place)):
                inner = dict[str, Value]()  # a section that is missing, or that stands there empty
            if isinstance(inner, dict) and not _by_hand(kind, place, inner):
                yield from _lacking(kind, value, inner, place)
        elif key not in own and _may_lack(kind, place):
            yield place


def _may_lack(kind: type[Rig], place: Place) -> bool:
    """Tell whether a key, or a section above it, is one that a file may lack."""
    return any(
        len(parts) <= len(place) and _alike(parts, place) for parts in (one.split(".") for one in kind.may_lack)
    )


def _leads_to_some(kind: type[Rig], place: Place) -> bool:
    """Tell whether a section holds keys that a file without it may lack. An axis or a device is there, or it is not."""
    return _may_lack(kind, place) or any(
        len(parts) > len(place) and "*" not in parts[: len(place)] and _alike(parts, place)
        for parts in (one.split(".") for one in kind.may_lack)
    )


def _alike(parts: list[str], place: Place) -> bool:
    return all(part in ("*", key) for part, key in zip(parts, place, strict=False))


def _by_hand(kind: type[Rig], place: Place, section: Mapping[str, Value]) -> bool:
    """Tell whether a section is that of an axis without a drive."""
    return place[0] == "axes" and place[-1] in kind.manual and section.get("manual") is True
