"""Completes a rig file with its missing keys, from the packaged file of its kind and with the comments there."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import NamedTemporaryFile

from tester.base.source import InvalidSource, Tree, Value, load_tree
from tester.inputs.rig.config import Rig
from tester.inputs.rig.packaged import Place, complete, lacking, like, packaged_tree


def upgrade(kind: type[Rig], path: Path) -> tuple[str, ...]:
    """Write the missing keys with their comments into a rig file and return them; everything else stays unchanged.

    Raises InvalidSource for a file that is not YAML or whose layout does not allow adding lines to its sections,
    OSError where it cannot be written. The file is replaced in one step.
    """
    tree = load_tree(path)
    _refuse_what_is_no_section(kind, tree)
    missing = lacking(kind, tree)
    if not missing:
        return ()
    with path.open(encoding="utf-8", newline="") as stream:
        text = stream.read()
    whole = _with_keys(text, tree, packaged_tree(kind, like(tree)), missing)
    complete(kind, tree)
    if not _reads_as(whole, tree.data):
        what = "no key can be added to it as it is written: put each key on a line of its own"
        raise InvalidSource([tree.problem(missing[0][:-1], what)])
    _replace(path, whole)
    return tuple(".".join(place) for place in missing)


def _refuse_what_is_no_section(kind: type[Rig], tree: Tree) -> None:
    if not isinstance(tree.data, dict):
        raise InvalidSource([tree.problem((), "expected the sections of a rig file")])
    packaged = packaged_tree(kind, like(tree)).data
    assert isinstance(packaged, dict)
    for key, value in tree.data.items():
        if isinstance(packaged.get(key), dict) and not isinstance(value, dict | None):
            raise InvalidSource([tree.problem((key,), f"{key}: expected a section with keys")])


def _with_keys(text: str, tree: Tree, packaged: Tree, missing: Sequence[Place]) -> str:
    """Return a file's text with keys added: each at the end of its section."""
    end = "\r\n" if "\r\n" in text else "\n"
    lines = text.splitlines(keepends=True)
    if lines and not lines[-1].endswith("\n"):
        lines[-1] += end
    added: dict[Place, list[str]] = {}
    for place in missing:
        section = _nearest_section(tree, place)
        indent = _end_of_section(tree, section)[1] if section else ""
        new = added.setdefault(section, [])
        new += [indent + line if line else "" for line in _lines(packaged, place, section, missing)]
    last = len(lines)
    ends = {section: _end_of_section(tree, section)[0] if section else last for section in added}
    # From the end of the file, so that earlier places stay valid; where two share a place, the inner is written last,
    # above.
    for section in sorted(
        added, key=lambda place_of_section: (ends[place_of_section], -len(place_of_section)), reverse=True
    ):
        lines[ends[section] : ends[section]] = [line + end for line in added[section]]
    return "".join(lines)


def _nearest_section(tree: Tree, place: Place) -> Place:
    """Return the innermost section around a key; only sections in the file count. () is the file itself."""
    return next(place[:n] for n in range(len(place) - 1, -1, -1) if n == 0 or place[:n] in tree.keys)


def _lines(packaged: Tree, place: Place, section: Place, missing: Sequence[Place]) -> Iterator[str]:
    """Yield the lines of a key from the packaged file, including the names of the sections that are missing.

    They are indented relative to the section that the file has. A section's name comes with the first of its keys.
    """
    for n in range(len(section) + 1, len(place)):
        if next(other for other in missing if other[:n] == place[:n]) == place:
            if n == 1:
                yield from ("", *_comment_above(packaged, place[:1]))
            yield "  " * (n - 1 - len(section)) + packaged.text.splitlines()[packaged.keys[place[:n]][0] - 1].strip()
    block, indent = _block(packaged, place), "  " * (len(place) - 1 - len(section))
    column = len(block[0]) - len(block[0].lstrip())
    yield from (indent + line[column:] for line in block)


def _block(packaged: Tree, place: Place) -> list[str]:
    """Return the lines of a key of the packaged file: its own, and comments that continue below it."""
    line, column = packaged.keys[place]
    text = packaged.text.splitlines()
    after = line
    while after < len(text) and text[after].lstrip().startswith("#") and not text[after][:column].strip():
        after += 1
    return text[line - 1 : after]


def _comment_above(packaged: Tree, place: Place) -> list[str]:
    text, last = packaged.text.splitlines(), packaged.keys[place][0] - 1
    first = last
    while first > 0 and text[first - 1].startswith("#"):
        first -= 1
    return text[first:last]


def _reads_as(text: str, data: Value) -> bool:
    try:
        return load_tree(text).data == data
    except InvalidSource:
        return False


def _end_of_section(tree: Tree, section: Place) -> tuple[int, str]:
    """Return the last line of a section (from 1) and the indentation of its keys."""
    depth = len(section)
    inside = [place for where, place in tree.keys.items() if where[:depth] == section and len(where) == depth + 1]
    line, column = tree.key_position(section)
    if not inside:
        return line, " " * (column + 1)
    below = [place for where, place in tree.positions.items() if where[:depth] == section and len(where) > depth]
    below += [place for where, place in tree.keys.items() if where[:depth] == section and len(where) > depth]
    return max(line for line, _ in below), " " * (inside[0][1] - 1)


def _replace(path: Path, text: str) -> None:
    """Put a file's new text in its place: a crash leaves either the old text or the new."""
    target = path.resolve()
    with NamedTemporaryFile(
        "w", encoding="utf-8", newline="", dir=target.parent, prefix=f".{target.name}.", delete=False
    ) as stream:
        stream.write(text)
        stream.flush()
        os.fsync(stream.fileno())
    written = Path(stream.name)
    try:
        shutil.copymode(target, written)
        written.replace(target)
    except OSError:
        written.unlink(missing_ok=True)
        raise
