"""Engineering assumptions that entered a run: terms of its budget, and numbers of its rig file, marked [A]."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import cast

from tester.base.source import InvalidSource, load_tree
from tester.results.run_results import RunResults

MARK = "[A]"


@dataclass(frozen=True, slots=True)
class AssumedKey:
    """A key of a rig file whose packaged value is an assumption, and its remark in the file."""

    key: str
    value: str
    remark: str


def assumed_terms(results: RunResults) -> Iterator[tuple[str, str, str]]:
    """Yield name, bound and source of the terms of the budget that rest on an assumption."""
    for term in results.run.info.terms:
        if MARK in term.source:
            unit = "" if term.unit in ("", "1") else f"\u00a0{term.unit}"
            yield term.name, f"{term.bound:g}{unit}, {term.distribution}", term.source


def assumed_keys(commented: str, packaged: str, stored: str) -> list[AssumedKey]:
    """Return the keys that a packaged rig file marks and that keep their packaged value in a run's rig.

    ``commented`` is the packaged file with its remarks, ``packaged`` the same as a run stores it, ``stored`` the run's
    own text. A key with another value is the laboratory's own number, and is left out. Empty where one of the texts is
    unreadable.
    """
    try:
        before, now = (_flat(load_tree(text, "rig.yaml").data) for text in (packaged, stored))
    except InvalidSource:
        return []
    return [
        AssumedKey(key, now[key], remark)
        for key, remark in _marked(commented)
        if key in before and now.get(key) == before[key]
    ]


def _flat(tree: object, place: str = "") -> dict[str, str]:
    """Return the values of a tree by their keys, as ``limits.load``."""
    if isinstance(tree, Mapping):
        leaves: dict[str, str] = {}
        for key, value in cast("Mapping[object, object]", tree).items():
            leaves |= _flat(value, f"{place}.{key}" if place else str(key))
        return leaves
    return {place: str(tree)}


def _marked(text: str) -> Iterator[tuple[str, str]]:
    """Yield key and remark of every line of a rig file whose comment has the mark."""
    path: list[tuple[int, str]] = []
    for line in text.splitlines():
        key, colon, rest = line.partition(":")
        name = key.strip()
        if not colon or not name or name.startswith(("#", "-")):
            continue
        depth = len(key) - len(key.lstrip())
        path = [entry for entry in path if entry[0] < depth] + [(depth, name)]
        _, hash_mark, remark = rest.partition("#")
        if hash_mark and MARK in remark:
            yield ".".join(entry for _, entry in path), remark.strip()
