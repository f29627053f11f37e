"""Reads YAML written by people: strictly, with the position of everything, all problems at once.

Recipes and rig files come from editors and USB sticks (safety.md, "Bad input"), so this accepts a small, plain part of
YAML: mappings, lists and scalars by the YAML 1.2 core schema (``NO`` is a text, ``1e3`` a number, ``1:30`` a text).
Refused, with line and column: anchors, aliases, tags, merges, directives, several documents, duplicate keys, control
and bidirectional characters, more than 256 kB or 20 levels. PyYAML supplies the events, from libyaml where its
installation has that, else from its own parser; nothing is ever constructed from a tag.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias, cast

import yaml
import yaml.events as ev
from yaml.error import Mark, MarkedYAMLError
from yaml.scanner import ScannerError

from tester.base.trouble import in_words
from tester.base.units import shown
from tester.base.words import FORBIDDEN, harmless
from tester.base.yaml_trouble import OUT_OF_RANGE, plainer, too_deep

MAX_BYTES = 256 * 1024
MAX_DEPTH = 20
MAX_PROBLEMS = 100
"""Most problems listed for one file: a longer list is no use to a reader."""

_LOADER = cast("type[yaml.SafeLoader]", getattr(yaml, "CSafeLoader", yaml.SafeLoader))
"""Only its events are used. libyaml is missing where PyYAML was built without it."""

Value: TypeAlias = "bool | int | float | str | list[Value] | dict[str, Value] | None"
Location: TypeAlias = tuple[str | int, ...]
"""Place in the tree: keys and list indices from the top."""

_NULL = frozenset({"", "~", "null", "Null", "NULL"})
_BOOL = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
_INT = re.compile(r"[-+]?[0-9]{1,18}|0o[0-7]{1,20}|0x[0-9a-fA-F]{1,15}")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]{1,3})?")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")


@dataclass(frozen=True, slots=True, order=True)
class Problem:
    """One fault of a file; line and column count from 1. ``str`` gives ``file:line:col: message``."""

    file: str
    line: int
    column: int
    message: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}: {self.message}"


class InvalidSource(Exception):  # noqa: N818 - it is the file that is invalid, not the program
    """A file that cannot be used; ``problems`` lists the reasons, sorted by position, at least one."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        listed = sorted(set(problems))
        more = len(listed) - MAX_PROBLEMS
        if more > 0:
            last = listed[MAX_PROBLEMS - 1]
            listed[MAX_PROBLEMS:] = [Problem(last.file, last.line, last.column, f"and {more} more problems")]
        self.problems: tuple[Problem, ...] = tuple(listed)
        super().__init__("\n".join(map(str, listed)))


@dataclass(slots=True)
class Tree:
    """A file as plain data, with the (line, column) of every value and of every key, from 1."""

    name: str
    text: str
    data: Value = None
    positions: dict[Location, tuple[int, int]] = field(default_factory=dict[Location, tuple[int, int]])
    keys: dict[Location, tuple[int, int]] = field(default_factory=dict[Location, tuple[int, int]])

    def position(self, location: Location) -> tuple[int, int]:
        """Return (line, column) of the value at a location, or of the nearest value above it."""
        for length in range(len(location), -1, -1):
            place = self.positions.get(location[:length])
            if place is not None:
                return place
        return 1, 1

    def key_position(self, location: Location) -> tuple[int, int]:
        """Return (line, column) of the key at a location; of the value where there is no such key."""
        return self.keys.get(location) or self.position(location)

    def problem(self, location: Location, message: str) -> Problem:
        """Return a Problem at the value at a location."""
        return Problem(self.name, *self.position(location), message)


def load_tree(source: Path | str, name: str | None = None) -> Tree:
    """Read a file (Path) or a text (str) and return its Tree; ``name`` names it in messages.

    Raises InvalidSource with every problem that can be found; a syntax error ends the reading.
    """
    tree, problems = read_tree(source, name)
    if problems:
        raise InvalidSource(problems)
    return tree


def read_tree(source: Path | str, name: str | None = None) -> tuple[Tree, list[Problem]]:
    """Return a Tree with the problems that leave it readable, for a caller that continues to look for more.

    Such a tree has null, or the first of two values, where a value was refused. Raises InvalidSource for an unreadable
    file.
    """
    called = printable(name if name is not None else str(source) if isinstance(source, Path) else "<text>")
    text = _read(source, called) if isinstance(source, Path) else source
    if len(text) > MAX_BYTES or len(text.encode("utf-8", "surrogatepass")) > MAX_BYTES:
        raise _too_large(called)
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    _refuse_characters(text, called)
    builder = _Builder(Tree(called, text))
    builder.build()
    return builder.tree, builder.problems


def printable(text: str) -> str:
    """Return a text that is safe on a terminal: characters that could steer it become question marks."""
    return harmless(text).replace("\n", "?").replace("\t", "?")


def _read(path: Path, called: str) -> str:
    try:
        if not path.is_file():
            raise InvalidSource([Problem(called, 1, 1, "no such file" if not path.exists() else "not a file")])
        with path.open("rb") as stream:
            raw = stream.read(MAX_BYTES + 1)
    except OSError as error:
        raise InvalidSource([Problem(called, 1, 1, f"cannot be read: {in_words(error)}")]) from error
    if len(raw) > MAX_BYTES:
        raise _too_large(called)
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        column = error.start - raw.rfind(b"\n", 0, error.start)
        raise InvalidSource([Problem(called, line, column, "not UTF-8 text (save the file as UTF-8)")]) from error


def _too_large(called: str) -> InvalidSource:
    return InvalidSource([Problem(called, 1, 1, f"larger than {MAX_BYTES // 1024} kB: not a file of ours")])


def _refuse_characters(text: str, called: str) -> None:
    problems = [
        Problem(
            called,
            text.count("\n", 0, match.start()) + 1,
            match.start() - text.rfind("\n", 0, match.start()),
            f"the character U+{ord(match.group()):04X} is not accepted (control, bidirectional or invisible)",
        )
        for _, match in zip(range(MAX_PROBLEMS), FORBIDDEN.finditer(text), strict=False)
    ]
    if problems:
        raise InvalidSource(problems)


def _place(event: ev.Event) -> tuple[int, int]:
    """Return the line and column at which an event begins, from 1."""
    mark = cast("Mark", event.start_mark)
    return mark.line + 1, mark.column + 1


class _Builder:
    """Turns events into a Tree, and collects every problem that leaves the structure readable."""

    def __init__(self, tree: Tree) -> None:
        self.tree = tree
        self.problems: list[Problem] = []
        self._loader = _LOADER(tree.text)
        self._reached = (1, 1)

    def build(self) -> None:
        """Fill the tree and the list of problems; raises InvalidSource where reading cannot continue."""
        try:
            self._document()
        except MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
            message = f"not YAML: {plainer(error, self.tree.text, line, column, MAX_DEPTH)}"
            raise InvalidSource([*self.problems, Problem(self.tree.name, line, column, message)]) from error
        except (ValueError, OverflowError) as error:
            # PyYAML's own parser calls chr() and int() for an escape or a directive, whatever its number.
            out_of_range = Problem(self.tree.name, *self._reached, f"not YAML: {OUT_OF_RANGE}")
            raise InvalidSource([*self.problems, out_of_range]) from error

    def _following(self) -> ev.Event:
        """Return the next event; raises MarkedYAMLError, and ValueError for an escape out of range."""
        event = cast("ev.Event", self._loader.get_event())  # pyright: ignore[reportUnknownMemberType]
        self._reached = _place(event)
        return event

    def _document(self) -> None:
        self._following()  # start of the stream
        start = self._following()
        if not isinstance(start, ev.DocumentStartEvent):
            self._refuse(start, "the file is empty")
            return
        if start.version is not None or start.tags:
            self._refuse(start, "directives (%YAML, %TAG) are not accepted")
        self.tree.data = self._node(self._following(), (), 1)
        self._following()  # end of the document
        after = self._following()
        if isinstance(after, ev.DocumentStartEvent):
            self._refuse(after, "a second document (---) is not accepted: one file is one document")

    def _node(self, event: ev.Event, at: Location, depth: int) -> Value:
        self.tree.positions[at] = _place(event)
        if depth > MAX_DEPTH and not isinstance(event, ev.ScalarEvent):
            mark = cast("Mark", event.start_mark)
            raise ScannerError(None, None, too_deep(MAX_DEPTH), mark)
        if isinstance(event, ev.AliasEvent):
            self._refuse(event, "aliases (*name) are not accepted: write the value out")
            return None
        self._refuse_decoration(event)
        if isinstance(event, ev.ScalarEvent):
            return self._scalar(event)
        if isinstance(event, ev.SequenceStartEvent):
            return self._sequence(at, depth)
        return self._mapping(at, depth)

    def _refuse_decoration(self, event: ev.Event) -> None:
        if isinstance(event, ev.ScalarEvent | ev.CollectionStartEvent):
            if event.anchor is not None:
                self._refuse(event, "anchors (&name) are not accepted: write the value out")
            if event.tag is not None:
                self._refuse(event, "tags (!name) are not accepted")

    def _sequence(self, at: Location, depth: int) -> list[Value]:
        items: list[Value] = []
        while not isinstance(event := self._following(), ev.SequenceEndEvent):
            items.append(self._node(event, (*at, len(items)), depth + 1))
        return items

    def _mapping(self, at: Location, depth: int) -> dict[str, Value]:
        items: dict[str, Value] = {}
        while not isinstance(event := self._following(), ev.MappingEndEvent):
            key = self._key(event, at, depth)
            here = (*at, key)
            first = self.tree.keys.get(here) if key in items else None
            if first is not None:
                self._refuse(event, f"duplicate key {shown(key)}: it is in line {first[0]} already")
                here = (*here, -1)  # read past the value without touching the first one's positions
            self.tree.keys[here] = _place(event)
            value = self._node(self._following(), here, depth + 1)
            items.setdefault(key, value)
        return items

    def _key(self, event: ev.Event, at: Location, depth: int) -> str:
        if not isinstance(event, ev.ScalarEvent):
            self._refuse(event, "a key is to be a plain text")
            if not isinstance(event, ev.AliasEvent):
                self._node(event, (*at, -1), depth + 1)
            return ""
        self._refuse_decoration(event)
        if event.value == "<<" and not event.style:
            self._refuse(event, "merges (<<) are not accepted: write the values out")
        elif not event.value:
            self._refuse(event, "the key is empty")
        self._refuse_escaped(event)
        return event.value

    def _scalar(self, event: ev.ScalarEvent) -> Value:
        text = event.value
        if event.style:  # None or "" of a plain scalar
            self._refuse_escaped(event)
            return text
        if text in _NULL:
            return None
        if text in _BOOL:
            return _BOOL[text]
        if _INT.fullmatch(text):
            return int(text, 0) if text[:2] in ("0o", "0x") else int(text)
        if _NOT_FINITE.fullmatch(text):
            self._refuse(event, f"{shown(text)} is not a finite number")
            return None
        if _FLOAT.fullmatch(text):
            number = float(text)
            if abs(number) == float("inf"):
                self._refuse(event, f"{shown(text)} is too large for a number")
            return number
        return text

    def _refuse_escaped(self, event: ev.ScalarEvent) -> None:
        """Refuse, by their code, forbidden characters that a quoted text contains as an escape such as "\\u202e"."""
        forbidden = FORBIDDEN.search(event.value)
        if forbidden is not None:
            self._refuse(event, f"the character U+{ord(forbidden.group()):04X} is not accepted, even as an escape")

    def _refuse(self, event: ev.Event, message: str) -> None:
        self.problems.append(Problem(self.tree.name, *_place(event), message))
