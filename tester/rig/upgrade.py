"""Keys that a rig file lacks: which they are, and the file with them written in.

Only the section ``interlocks`` has keys that may be missing: a new interlock brings its parameters, and a file from
before it takes their packaged values.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import NamedTemporaryFile

from tester.interlocks.parameter import Parameter
from tester.interlocks.table import PARAMETERS
from tester.interlocks.written import SECTION, key_line, rig_section
from tester.rig.load import SIMULATED
from tester.source import InvalidSource, Tree, Value, load_tree


def packaged_keys(name_or_path: str | Path, overrides: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the keys for which a rig takes the packaged value because its file and ``overrides`` do not have them.

    As ``interlocks.pushed``, in the order of the packaged file. Raises InvalidSource for a file that cannot be read.
    """
    if name_or_path == SIMULATED:
        return ()
    given = {text.partition("=")[0].strip() for text in overrides}
    keys = (f"{SECTION}.{one.key}" for one in lacking(load_tree(Path(name_or_path))))
    return tuple(key for key in keys if key not in given)


def lacking(tree: Tree) -> tuple[Parameter, ...]:
    """Return the parameters of interlocks that a file does not have."""
    section = tree.data.get(SECTION) if isinstance(tree.data, dict) else None
    has = section if isinstance(section, dict) else {}
    return tuple(one for one in PARAMETERS if one.key not in has)


def upgrade(path: Path) -> tuple[str, ...]:
    """Write the missing keys with their comments into a rig file and return them; everything else stays as it is.

    Raises InvalidSource for a file that is not YAML or whose section is written so that no line can be added to it,
    OSError where it cannot be written. The file is replaced in one step.
    """
    tree = load_tree(path)
    missing = lacking(tree)
    if not missing:
        return ()
    with path.open(encoding="utf-8", newline="") as stream:
        text = stream.read()
    _replace(path, _with_keys(text, tree, missing))
    return tuple(one.key for one in missing)


def _with_keys(text: str, tree: Tree, missing: Sequence[Parameter]) -> str:
    """Return a file's text with keys added; what is then read back has to be the file and these keys, no more."""
    if not isinstance(tree.data, dict):
        raise InvalidSource([tree.problem((), "expected the sections of a rig file")])
    end = "\r\n" if "\r\n" in text else "\n"
    lines = text.splitlines(keepends=True)
    if SECTION in tree.data:
        last, indent = _end_of_section(tree)
        new = [key_line(one, indent) for one in missing]
    else:
        last, new = len(lines), ["", *rig_section().splitlines()]
    if last and not lines[last - 1].endswith("\n"):
        lines[last - 1] += end
    whole = "".join([*lines[:last], *(line + end for line in new), *lines[last:]])
    if not _adds_only(whole, tree.data, missing):
        what = "no key can be added to it as it is written: put each key on a line of its own"
        raise InvalidSource([tree.problem((SECTION,), what)])
    return whole


def _adds_only(text: str, before: Mapping[str, Value], missing: Sequence[Parameter]) -> bool:
    """Tell whether a text reads as the file before with the missing keys."""
    section = before.get(SECTION)
    added = {one.key: load_tree(one.default).data for one in missing}
    try:
        return load_tree(text).data == {**before, SECTION: {**(section if isinstance(section, dict) else {}), **added}}
    except InvalidSource:
        return False


def _end_of_section(tree: Tree) -> tuple[int, str]:
    """Return the last line of the section (from 1) and the indentation of its keys."""
    inside = [place for where, place in tree.keys.items() if where[0] == SECTION and len(where) == 2]
    if not inside:
        return tree.key_position((SECTION,))[0], "  "
    values = [place for where, place in tree.positions.items() if where and where[0] == SECTION and len(where) > 1]
    return max(line for line, _ in inside + values), " " * (inside[0][1] - 1)


def _replace(path: Path, text: str) -> None:
    """Put a file's new text in its place: a crash leaves the one or the other."""
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
