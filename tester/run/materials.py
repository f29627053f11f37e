"""Files of the compounds and the surface that a recipe names: found, copied into the run's folder, kept in its record.

The copies lie beside the run's recipe as the originals lie beside theirs, so whoever reads the run's recipe finds them
first. A name that no file has is a name and no more.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import recipes
from sim.physics.materials import UnknownMaterialError
from tester.base.source import InvalidSource
from tester.inputs.materials.files import FOLDERS, MaterialFile, Role
from tester.inputs.materials.library import Library
from tester.inputs.materials.schema import CompoundModel
from tester.inputs.recipe.schema import Recipe
from tester.inputs.rig import Rig
from tester.run.kinds import recipe_part
from tester.store.disk import write_whole
from tester.store.records import StoredMaterial
from tester.store.statements import text_sha256

SHORT_BYTES = 256 * 1024
"""A file of data that is a text and no longer than this is kept in the record, too."""
PACKAGED = "packaged: "


@dataclass(frozen=True, slots=True)
class KeptFile:
    """A file to be copied into a run's folder: what the record keeps of it, and its bytes."""

    stored: StoredMaterial
    content: bytes


@dataclass(frozen=True, slots=True)
class UsedMaterials:
    """What a recipe's names stand for: files, and names that no file has (role and name)."""

    files: tuple[MaterialFile, ...] = ()
    bare: tuple[tuple[Role, str], ...] = ()

    @property
    def doubts(self) -> list[str]:
        """Return what is doubtful in the files, a line each."""
        return [str(doubt) for one in self.files for doubt in one.doubts]


def used_materials(recipe: Recipe, path: Path, leave_out: Iterable[str] = ()) -> UsedMaterials:
    """Return the files that a recipe at ``path`` names; raises InvalidSource with every problem of the first bad one.

    ``leave_out``: names that are not looked for.
    """
    library = Library.beside(path)
    known = set(leave_out)
    files: list[MaterialFile] = []
    bare: list[tuple[Role, str]] = []
    for role, name in _named(recipe):
        if name in known:
            continue
        try:
            loaded = library.compound(name) if role == "compound" else library.surface_file(name)
        except UnknownMaterialError:
            bare.append((role, name))
            continue
        files.append(loaded.file)
    return UsedMaterials(tuple(files), tuple(bare))


def described_compounds(recipe: Recipe, path: Path, rig: Rig) -> dict[str, CompoundModel]:
    """Return what the files of a recipe's compounds say, by name; nothing where rubber on the rig is not as they say.

    A file that cannot be read is left out: what is wrong with it is a problem of the recipe, not of this.
    """
    if not recipe_part(rig).rubs_as_described(rig):
        return {}
    library, found = Library.beside(path), dict[str, CompoundModel]()
    for name in dict.fromkeys(one.compound for one in recipe.specimens):
        with suppress(UnknownMaterialError, InvalidSource):
            found[name] = library.compound(name).model
    return found


def _named(recipe: Recipe) -> Iterator[tuple[Role, str]]:
    for name in dict.fromkeys(one.compound for one in recipe.specimens):
        yield "compound", name
    if recipe.abrasive is not None:
        yield "surface", recipe.abrasive.name


def kept_files(files: Sequence[MaterialFile], taken: Iterable[str] = ()) -> tuple[KeptFile, ...]:
    """Return what of materials goes into a run's folder, each file before what it refers to.

    ``taken``: files that lie there already. Two of one name get folders of their own.
    """
    there = {name.casefold() for name in taken}
    kept: list[KeptFile] = []
    for one in files:
        names = [one.path.name, *(data.name for data in one.data)]
        folder = next(place for place in _places(FOLDERS[one.role]) if not there & {_at(place, n) for n in names})
        there |= {_at(folder, name) for name in names}
        doubts = "\n".join(map(str, one.doubts))
        source = _source(one.path)
        stored = StoredMaterial(
            one.role, one.name, f"{folder}/{one.path.name}", source, text_sha256(one.text), one.text, doubts
        )
        kept.append(KeptFile(stored, one.text.encode()))
        for data in one.data:
            of = StoredMaterial(
                "data", data.name, f"{folder}/{data.name}", source, data.sha256, _short_text(data.content)
            )
            kept.append(KeptFile(of, data.content))
    return tuple(kept)


def _places(folder: str) -> Iterator[str]:
    yield folder
    yield from (f"{folder}/{number}" for number in range(2, 10_000))


def _at(folder: str, name: str) -> str:
    return f"{folder}/{name}".casefold()


def _source(path: Path) -> str:
    """Return where a file was read from, as it is stored."""
    if recipes.FOLDER in path.parents:
        return f"{PACKAGED}{path.relative_to(recipes.FOLDER).as_posix()}"
    return str(path.absolute())


def _short_text(content: bytes) -> str | None:
    if len(content) > SHORT_BYTES or b"\0" in content:
        return None
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return None


def write_materials(folder: Path, kept: Iterable[KeptFile]) -> None:
    """Copy materials into a run's folder; raises OSError."""
    for one in kept:
        _write(folder / one.stored.file, one.content)


def _write(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)

    def fill(part: Path) -> None:
        part.write_bytes(content)

    write_whole(path, fill)


def put_back(folder: Path, stored: Iterable[StoredMaterial]) -> tuple[list[str], list[str]]:
    """Make the copies in a run's folder what its record says they were.

    Returns the files that were put back, and those that cannot be: changed, and held by their hash alone.
    """
    restored: list[str] = []
    lost: list[str] = []
    for one in stored:
        path = folder / one.file
        if path.is_file() and sha256(path.read_bytes()).hexdigest() == one.sha256:
            continue
        if one.text is None:
            lost.append(one.file)
            continue
        _write(path, one.text.encode())
        restored.append(one.file)
    return restored, lost
