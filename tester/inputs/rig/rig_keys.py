"""Every key of a kind's rig file with its class (tester.inputs.rig.key_classes), found from its sections' types."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, is_dataclass
from functools import cache
from types import UnionType
from typing import TYPE_CHECKING, Any, Final, Union, cast, get_args, get_origin

from tester.base.config_reader import entries
from tester.inputs.rig.key_classes import Bounded, Ceiling, Classes, Free, Held, Inside, KeyClass

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from tester.inputs.rig.config import Rig

ANY: Final = "*"
"""A name that a file chooses, in the place of a key."""
Place = tuple[str, ...]
_MAPPING: Final = get_origin(Mapping[str, str])
_NONE: Final[Mapping[str, Classes]] = {}


@dataclass(frozen=True, slots=True)
class RigKey:
    """A key of a kind's rig file; its class, two for a key that is bounded both ways, () for none."""

    place: Place
    unit: str
    classes: tuple[KeyClass, ...]

    @property
    def key(self) -> str:
        """Return the key as in the rig file, with ``*`` for a name that the file chooses."""
        return ".".join(self.place)

    @property
    def ceilings(self) -> tuple[Ceiling, ...]:
        """Return the key's bounds."""
        return tuple(Ceiling(self.key, self.unit, bound) for bound in self.classes if isinstance(bound, Bounded))

    @property
    def described(self) -> bool:
        """Return whether the key describes the machine: only its file sets it on a real rig. So does one without a
        class."""
        return not self.classes or isinstance(self.classes[0], Held)


@cache
def keys_of(kind: type[Rig]) -> tuple[RigKey, ...]:
    """Return every key of a kind's rig file, in the order of its sections."""
    return tuple(_section(kind, (), {}, ()))


def ceilings_of(kind: type[Rig]) -> tuple[Ceiling, ...]:
    """Return the bounds of a kind's safety keys, in the order of its sections."""
    return tuple(ceiling for key in keys_of(kind) for ceiling in key.ceilings)


def _section(
    kind: type[DataclassInstance], above: Place, stated: Mapping[str, Classes], whole: tuple[KeyClass, ...]
) -> Iterator[RigKey]:
    """Yield the keys of a section; ``stated``, ``whole``: the classes that the section's field states for them."""
    for entry in entries(kind):
        place = (*above, entry.key)
        marks = tuple(mark for mark in entry.marks if isinstance(mark, Bounded | Held | Free))
        inside: Mapping[str, Classes] = next((mark.classes for mark in entry.marks if isinstance(mark, Inside)), _NONE)
        declared = stated.get(entry.key, ())
        if isinstance(declared, Mapping):
            inside = declared
        elif declared:
            marks = declared if isinstance(declared, tuple) else (declared,)
        yield from _below(entry.type, place, entry.unit, inside, marks or whole)


def _below(
    hint: Any, place: Place, unit: str, inside: Mapping[str, Classes], classes: tuple[KeyClass, ...]
) -> Iterator[RigKey]:
    """Yield the keys of a field: itself, or those of the section or sections that it holds."""
    if get_origin(hint) in (Union, UnionType):
        hint = next((kind for kind in get_args(hint) if isinstance(kind, type) and is_dataclass(kind)), hint)
    sections = get_args(hint)[1] if get_origin(hint) is _MAPPING else None
    if isinstance(sections, type) and is_dataclass(sections):
        yield from _section(sections, (*place, ANY), inside, classes)
    elif isinstance(hint, type) and is_dataclass(hint):
        yield from _section(hint, place, inside, classes)
    else:
        yield RigKey(place, unit, classes)


def values_of(rig: Rig) -> Iterator[tuple[RigKey, Place, object]]:
    """Yield every key that a rig has, with its place in the file and its value."""
    for key in keys_of(type(rig)):
        for place, value in _found(rig, key.place, ()):
            yield key, place, value


def value_at(rig: Rig, place: Place) -> object:
    """Return the value at a place of the file, None where the rig has no such section."""
    return next((value for _, value in _found(rig, place, ())), None)


def _found(node: Any, place: Place, above: Place) -> Iterator[tuple[Place, object]]:
    """Yield what is at a place below a section, once for each name that the file chooses."""
    if ANY not in place:
        value = _at(node, place)
        if value is not None:
            yield (*above, *place), value
        return
    number = place.index(ANY)
    sections = _at(node, place[:number])
    if isinstance(sections, Mapping):
        for name, section in cast("Mapping[str, Any]", sections).items():
            yield from _found(section, place[number + 1 :], (*above, *place[:number], name))


def _at(node: Any, place: Place) -> Any:
    """Return what is at a place without a name that the file chooses, None where a section is not there.

    A rig is looked through some times whenever its file is read: there are no generators and no tests of types here.
    """
    for key in place:
        if node is None:
            return None
        names = _names(cast("type[DataclassInstance]", type(node)))
        if names is None:
            node = node.get(key)
        elif (name := names.get(key)) is not None:
            node = getattr(node, name)
        else:
            return None
    return node


@cache
def _names(kind: type[DataclassInstance]) -> dict[str, str] | None:
    """Return the fields of a section by their keys; None for a mapping of sections."""
    return None if issubclass(kind, Mapping) else {entry.key: entry.name for entry in entries(kind)}
