"""The keys of a kind's rig file with their classes, as a table of its page and of `tester rig keys`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, TypeAlias

from tester.inputs.rig.key_classes import Bounded, Free, Held, KeyClass
from tester.inputs.rig.rig_keys import ANY, Place, keys_of

if TYPE_CHECKING:
    from tester.inputs.rig.config import Rig

Row: TypeAlias = tuple[list[str], KeyClass | None]
"""Keys of the same class, and the class; None for no class."""


def ceiling_table(rows: Iterable[Row], elsewhere: Iterable[Row] = ()) -> str:
    """Return the safety keys of some rows with direction, hardest value and reason as Markdown, a line each.

    ``elsewhere``: rows of another table; those that bound the same keys alike are left out.
    """
    lines = ["| key | tighter is | not looser than | because |", "|---|---|---|---|"]
    known = [key_class for _, key_class in elsewhere]
    lines += [
        f"| {', '.join(names)} | {key_class.direction.value} | {key_class.hardest} | {key_class.because} |"
        for names, key_class in rows
        if isinstance(key_class, Bounded) and key_class not in known
    ]
    return "\n".join(lines) + "\n"


def in_words(key_class: KeyClass | None) -> tuple[str, str]:
    """Return a class, and the reason for it or what contradicts a wrong value."""
    if isinstance(key_class, Bounded):
        words = "not above" if key_class.direction.value == "lower" else "not below"
        return f"{words} {key_class.hardest}".replace("not below true", "true"), key_class.because
    if isinstance(key_class, Held):
        within = f" within {100.0 * key_class.within:.0f} %" if key_class.within < 1.0 else ""
        return f"held{within}", key_class.against
    return ("free", key_class.because) if isinstance(key_class, Free) else ("no class", "")


def classed(kind: type[Rig]) -> Iterator[Row]:
    """Yield every class of a kind with the keys that have it, None with those without a class.

    Keys come as short as possible: ``sim.*``, ``axes.*.heartbeat``.
    """
    every = [key.place for key in keys_of(kind)]
    places: dict[tuple[KeyClass, ...], list[Place]] = {}
    for key in keys_of(kind):
        places.setdefault(key.classes, []).append(key.place)
    for classes, shared in places.items():
        names = _names(shared, every)
        yield from ((names, key_class) for key_class in classes or (None,))


def _names(shared: list[Place], every: list[Place]) -> list[str]:
    """Return the shortest names of keys that share a class: whole sections, a key of every axis, or single keys."""
    left, names = dict.fromkeys(shared), list[str]()
    for place in shared:
        if place not in left:
            continue
        covered, name = _widest(place, left, every)
        names.append(name)
        for key in covered:
            del left[key]
    return names


def _widest(place: Place, shared: Mapping[Place, None], every: list[Place]) -> tuple[list[Place], str]:
    """Return the keys that a row names together with a key, and their name."""
    for depth in range(1, len(place)):
        section = [other for other in every if other[:depth] == place[:depth]]
        if len(section) > 1 and all(other in shared for other in section):
            return section, ".".join((*place[:depth], ANY))
    alike = [other for other in every if other[:1] + other[2:] == place[:1] + place[2:] and len(place) > 2]
    if len(alike) > 1 and all(other in shared for other in alike):
        return alike, ".".join((*place[:1], ANY, *place[2:]))
    return [place], ".".join(place)
