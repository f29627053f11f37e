"""Material files of a recipe: finds those of its compounds and surface, copies them to the run's folder, records them.
A kept law that a simulated rig uses is copied with them.

In the run's folder the copies have the same places next to the recipe as the originals have, so that a reader of that
recipe finds the copies first. A name without a file remains only a name.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import recipes
from sim.physics.materials import UnknownMaterialError
from tester.base.source import InvalidSource, Problem
from tester.inputs.materials.files import FOLDERS, MaterialFile, Role
from tester.inputs.materials.library import Library
from tester.inputs.materials.material_schema import CompoundModel
from tester.inputs.recipe.recipe_schema import Recipe, surfaces_of
from tester.inputs.rig import Rig
from tester.inputs.rig.profiles import LAW_KEYS, is_law_file
from tester.run.kind_lookup import recipe_part
from tester.store.disk import write_whole
from tester.store.records import StoredMaterial
from tester.store.sql import text_sha256

SHORT_BYTES = 256 * 1024
"""Greatest size up to which the content of a data file is recorded, if it is text, bytes."""
PACKAGED = "packaged: "
_FOLDERS: dict[str, str] = {**FOLDERS, "law": "laws"}


@dataclass(frozen=True, slots=True)
class KeptFile:
    """A file to copy into a run's folder: its record and its content."""

    stored: StoredMaterial
    content: bytes


@dataclass(frozen=True, slots=True)
class UsedMaterials:
    """The files for the names in a recipe, and the names without a file (role and name)."""

    files: tuple[MaterialFile, ...] = ()
    bare: tuple[tuple[Role, str], ...] = ()

    @property
    def doubts(self) -> list[str]:
        """Return the doubtful points of the files, a line each."""
        return [str(doubt) for file in self.files for doubt in file.doubts]


def used_materials(recipe: Recipe, path: Path, leave_out: Iterable[str] = ()) -> UsedMaterials:
    """Return the files for the names in a recipe at ``path``; raises InvalidSource with all problems of the first
    invalid file.

    ``leave_out``: names to skip.
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


def law_file(rig: Rig) -> tuple[MaterialFile, ...]:
    """Return the file of the kept law that a simulated rig uses; none for another law. Raises InvalidSource."""
    named = [str(getattr(rig.plant, key, "")) for _, key in LAW_KEYS]
    files = [Path(name) for name in named if is_law_file(name)] if rig.simulated else []
    return tuple(_law_file(path) for path in files)


def law_copies(folder: Path, stored: Iterable[StoredMaterial]) -> dict[str, str]:
    """Return the copies of kept laws in a run's folder, by the path of the original.

    The original may have changed, or be gone, since the run began: what reads the run's rig again reads the copy.
    """
    return {law.source: str((folder / law.file).resolve()) for law in stored if law.role == "law"}


def _law_file(path: Path) -> MaterialFile:
    from tester.inputs.kept_laws.law_value import load_law

    kept = load_law(path)
    doubts = tuple(Problem(str(path), 1, 1, doubt) for doubt in kept.doubts)
    return MaterialFile("law", kept.model.compound, path, path.read_text(encoding="utf-8"), doubts=doubts)


def described_compounds(recipe: Recipe, path: Path, rig: Rig) -> dict[str, CompoundModel]:
    """Return the models in the files of a recipe's compounds, by name; empty if they do not apply to the rubber on the
    rig.

    Skips unreadable files, which the recipe's check reports.
    """
    if not recipe_part(rig).rubs_as_described(rig):
        return {}
    library, models = Library.beside(path), dict[str, CompoundModel]()
    for name in dict.fromkeys(specimen.compound for specimen in recipe.specimens):
        with suppress(UnknownMaterialError, InvalidSource):
            models[name] = library.compound(name).model
    return models


def _named(recipe: Recipe) -> Iterator[tuple[Role, str]]:
    for name in dict.fromkeys(specimen.compound for specimen in recipe.specimens):
        yield "compound", name
    for name in surfaces_of(recipe):
        yield "surface", name


def kept_files(files: Sequence[MaterialFile], taken: Iterable[str] = ()) -> tuple[KeptFile, ...]:
    """Return the copies for a run's folder, each file before the files to which it refers.

    ``taken``: names of files that already exist there. A second file of the same name is put into a folder of its own.
    """
    there = {name.casefold() for name in taken}
    kept: list[KeptFile] = []
    for file in files:
        names = [file.path.name, *(data.name for data in file.data)]
        folder = next(place for place in _places(_FOLDERS[file.role]) if not there & {_at(place, n) for n in names})
        there |= {_at(folder, name) for name in names}
        doubts = "\n".join(map(str, file.doubts))
        source = _source(file.path)
        stored = StoredMaterial(
            file.role, file.name, f"{folder}/{file.path.name}", source, text_sha256(file.text), file.text, doubts
        )
        kept.append(KeptFile(stored, file.text.encode()))
        for data in file.data:
            record = StoredMaterial(
                "data", data.name, f"{folder}/{data.name}", source, data.sha256, _short_text(data.content)
            )
            kept.append(KeptFile(record, data.content))
    return tuple(kept)


def _places(folder: str) -> Iterator[str]:
    yield folder
    yield from (f"{folder}/{number}" for number in range(2, 10_000))


def _at(folder: str, name: str) -> str:
    return f"{folder}/{name}".casefold()


def _source(path: Path) -> str:
    """Return the source of a file, as it is stored."""
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
    for file in kept:
        _write(folder / file.stored.file, file.content)


def _write(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)

    def fill(part: Path) -> None:
        part.write_bytes(content)

    write_whole(path, fill)


def put_back(folder: Path, stored: Iterable[StoredMaterial]) -> tuple[list[str], list[str]]:
    """Restore the copies in a run's folder from the record.

    Returns the restored files, and those that cannot be restored: they were changed, and the record has only their
    hash.
    """
    restored: list[str] = []
    lost: list[str] = []
    for material in stored:
        path = folder / material.file
        if path.is_file() and sha256(path.read_bytes()).hexdigest() == material.sha256:
            continue
        if material.text is None:
            lost.append(material.file)
            continue
        _write(path, material.text.encode())
        restored.append(material.file)
    return restored, lost
