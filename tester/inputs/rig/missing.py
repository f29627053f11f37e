"""Missing keys of a rig file: which may take the packaged file's value, and the file completed with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from copy import deepcopy

from tester.base.source import Tree, Value
from tester.inputs.rig.config import Rig
from tester.inputs.rig.packaged import packaged_tree

Place = tuple[str, ...]
"""Place of a key: the names of its sections, and its own."""


def lacking(kind: type[Rig], tree: Tree) -> tuple[Place, ...]:
    """Return the missing keys that a file may lack, in the packaged file's order; a missing section as its keys."""
    packaged = packaged_tree(kind, like(tree)).data
    if not isinstance(packaged, dict) or not isinstance(tree.data, dict):
        return ()
    return tuple(_lacking(kind, packaged, tree.data, ()))


def complete(kind: type[Rig], tree: Tree) -> None:
    """Write the packaged values of the missing keys that a file may lack into a tree."""
    packaged = packaged_tree(kind, like(tree)).data
    for place in lacking(kind, tree):
        value, section = packaged, tree.data
        for key in place[:-1]:
            assert isinstance(value, dict) and isinstance(section, dict)  # otherwise the key would not be missing there
            value = value[key]
            if section.get(key) is None:
                section[key] = {}
            section = section[key]
        assert isinstance(value, dict) and isinstance(section, dict)
        section[place[-1]] = deepcopy(value[place[-1]])


def unstated(kind: type[Rig], tree: Tree) -> Iterator[Place]:
    """Yield the missing keys that a file must state itself, of sections that it has (``Rig.stated``)."""
    for place in (tuple(key_path.split(".")) for key_path in kind.stated):
        due, present = packaged_tree(kind, like(tree)).data, tree.data
        for key in place:
            due = due.get(key) if isinstance(due, dict) else None
            present = present.get(key) if isinstance(present, dict) else None
        if isinstance(due, dict) and isinstance(present, dict):
            yield from ((*place, key) for key in due if key not in present)


def like(tree: Tree) -> str:
    """Return the packaged rig that a file names in ``like``, "" for the first of its kind."""
    named = tree.data.get("like") if isinstance(tree.data, dict) else None
    return named if isinstance(named, str) else ""


def _lacking(
    kind: type[Rig], packaged: Mapping[str, Value], own: Mapping[str, Value], above: Place
) -> Iterator[Place]:
    for key, value in packaged.items():
        place = (*above, key)
        inner = own.get(key)
        if isinstance(value, dict):
            if inner is None and _leads_to_some(kind, place) and (key not in own or _may_lack(kind, place)):
                inner = dict[str, Value]()  # a section that is missing, or present but empty
            if isinstance(inner, dict) and not _by_hand(kind, place, inner):
                yield from _lacking(kind, value, inner, place)
        elif key not in own and _may_lack(kind, place):
            yield place


def _may_lack(kind: type[Rig], place: Place) -> bool:
    """Return whether a file may lack a key, or a section above it."""
    return any(
        len(parts) <= len(place) and _alike(parts, place) for parts in (pattern.split(".") for pattern in kind.may_lack)
    )


def _leads_to_some(kind: type[Rig], place: Place) -> bool:
    """Return whether a section has keys that a file without it may lack. An axis or a device is never completed."""
    return _may_lack(kind, place) or any(
        len(parts) > len(place) and "*" not in parts[: len(place)] and _alike(parts, place)
        for parts in (pattern.split(".") for pattern in kind.may_lack)
    )


def _alike(parts: list[str], place: Place) -> bool:
    return all(part in ("*", key) for part, key in zip(parts, place, strict=False))


def _by_hand(kind: type[Rig], place: Place, section: Mapping[str, Value]) -> bool:
    """Return whether a section is that of an axis without a drive."""
    return place[0] == "axes" and place[-1] in kind.manual and section.get("manual") is True
