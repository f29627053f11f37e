"""The kinds of rigs, found by name: packaged kinds, and kinds that an installed package declares.

Only ``tester.run`` and ``tester.cli`` look a kind up; all other modules receive a kind, or a rig. A rig file names
its kind in the key ``kind``.
"""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Final

from tester.base.trouble import TroubleError
from tester.kinds.kind import Kind

if TYPE_CHECKING:
    from tester.analysis.papers import Paper
    from tester.base.source import Tree
    from tester.inputs.rig import Rig
    from tester.inputs.rig.profiles import LawCopies

DEFAULT: Final = "wheel_on_belt"
"""Kind of a rig file without the key ``kind``."""
PACKAGED: Final = (DEFAULT, "specimen_on_track")
"""Kinds that ship with the program: packages beside this module."""
SIMULATED: Final = "sim"
"""Name of the packaged rig that is the default."""


class UnknownKindError(TroubleError, LookupError):
    """No kind of rig has this name; the message lists the kinds."""


def find(name: str) -> Kind:
    """Return a kind; raises UnknownKindError.

    ``name``: of a packaged kind, or of an extension in the group ``kinds`` (tester.base.plugins). The extension's
    object is a ``Kind``. An extension cannot take a packaged name.
    """
    if name in PACKAGED:
        return _packaged(name)
    from tester.base.plugins import PluginError, plugins

    try:
        found = plugins().load("kinds", name)
    except PluginError as error:
        near = difflib.get_close_matches(name, PACKAGED, n=1)
        meant = f", did you mean {near[0]}?" if near else ""
        known = ", ".join(PACKAGED)
        raise UnknownKindError(f"there is no kind of rig {name}{meant} (expected {known}); {error}") from error
    if not isinstance(found, Kind):
        raise UnknownKindError(f"the extension {name} is no kind of rig (expected a tester.kinds.kind.Kind)")
    # Control evaluates the rig class's table: a row that is only in the sheet would be shown and never trip.
    table = getattr(found.rig(), "table", None)
    unseen = [row.name for row in found.interlocks().rows if table is not None and row not in table.rows]
    if unseen:
        lacking = f"the table of its rig class lacks {', '.join(unseen)}, which its interlocks list"
        raise UnknownKindError(f"the kind of rig {name} is refused: {lacking} (make it by KIND.extended)")
    return found


def packaged_rigs() -> dict[str, Kind]:
    """Return the names of the rigs that ship with packaged kinds, each with its kind."""
    kinds = [_packaged(name) for name in PACKAGED]
    return {rig: kind for kind in kinds for rig in kind.rigs}


def shipping(rig: str) -> Kind | None:
    """Return the kind that ships a rig of this name: a packaged kind, else an extension; None for an unknown name.

    Extensions are loaded only for a name that is neither a packaged rig nor a file. Of two extensions with the name,
    the first in alphabetical order counts.
    """
    kind = packaged_rigs().get(rig)
    if kind is not None or Path(rig).exists():
        return kind
    from tester.base.plugins import plugins

    return next((kind for kind in map(find, plugins().names("kinds")) if rig in kind.rigs), None)


def packaged_conditions() -> dict[str, Kind]:
    """Return the names of measured conditions that ship with packaged kinds, each with its kind."""
    kinds = [_packaged(name) for name in PACKAGED]
    return {name: kind for kind in kinds if kind.fits is not None for name in kind.fits().packaged}


def packaged_papers() -> tuple[Paper, ...]:
    """Return the papers of the packaged kinds, the first kind's first."""
    kinds = [_packaged(name) for name in PACKAGED]
    return tuple(paper for kind in kinds if kind.papers is not None for paper in kind.papers())


def load_rig(
    source: str | Path = SIMULATED,
    overrides: Sequence[str] = (),
    accept_risk: str = "",
    copies: LawCopies | None = None,
) -> Rig:
    """Return the rig of a file, or the packaged rig of that name; raises InvalidSource
    (tester.inputs.rig.rig_files)."""
    from tester.inputs.rig.rig_files import load

    kind, tree = _opened(source)
    return load(kind.rig(), tree, overrides, accept_risk, copies or {})


def load_rig_text(text: str | Path, name: str | None = None, copies: LawCopies | None = None) -> Rig:
    """Return the rig of a text or a file that a run has stored; raises InvalidSource with every problem.

    Its risks were accepted when the run began; a resumed run asks for them (tester.run.session).
    """
    from tester.base.source import load_tree
    from tester.inputs.rig.rig_files import checked

    tree = load_tree(text, name or ("rig.yaml" if isinstance(text, str) else None))
    return checked(_kind_of(tree).rig(), tree, copies or {})


def packaged_keys(source: str | Path, overrides: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the keys that have packaged values because neither a rig's file nor ``overrides`` has them.

    Keys are written as ``interlocks.pushed``, in the order of the packaged file. Raises InvalidSource for an
    unreadable file.
    """
    from tester.inputs.rig.packaged import lacking

    kind, tree = _opened(source)
    given = {text.partition("=")[0].strip() for text in overrides}
    keys = (".".join(place) for place in lacking(kind.rig(), tree))
    return tuple(key for key in keys if key not in given)


def packaged_text(name: str = SIMULATED) -> str:
    """Return a packaged rig file as it is shipped; raises KeyError for an unknown name."""
    from tester.inputs.rig import packaged

    return packaged.packaged_text(packaged_rigs()[name].rig(), name)


def hardware_text(kind: str = DEFAULT, like: str = "") -> str:
    """Return a commented file for a real machine, made from one of the kind's packaged rigs; "": its first.

    Raises UnknownKindError, KeyError where the kind has no such rig.
    """
    from tester.inputs.rig import packaged

    rig = find(kind).rig()
    if like and like not in rig.packaged:
        raise KeyError(like)
    return packaged.hardware_text(rig, like)


def upgrade(path: Path) -> tuple[str, ...]:
    """Write the missing keys with their comments into a rig file and return them (tester.inputs.rig.upgrade)."""
    from tester.base.source import load_tree
    from tester.inputs.rig import upgrade

    return upgrade.upgrade(_kind_of(load_tree(path)).rig(), path)


def _packaged(name: str) -> Kind:
    kind = import_module(f"tester.kinds.{name}").KIND
    assert isinstance(kind, Kind)
    return kind


def _opened(source: str | Path) -> tuple[Kind, Tree]:
    """Return a rig's kind, and its file as data."""
    from tester.base.source import load_tree
    from tester.inputs.rig.packaged import new_tree
    from tester.inputs.rig.profiles import find_beside

    kind = shipping(str(source))
    if kind is not None:
        return kind, new_tree(kind.rig(), str(source))
    path = Path(source)
    tree = load_tree(path)
    find_beside(tree, path.parent)
    return _kind_of(tree), tree


def _kind_of(tree: Tree) -> Kind:
    """Return the kind of a rig file, and add a missing key ``kind`` to the tree; raises InvalidSource."""
    from tester.base.source import InvalidSource

    if not isinstance(tree.data, dict):
        return find(DEFAULT)
    name = tree.data.setdefault("kind", DEFAULT)
    try:
        return find(str(name))
    except UnknownKindError as error:
        raise InvalidSource([tree.problem(("kind",), f"kind: {error}")]) from error
