"""The compound and the surface of a kept law that is made of them: found by name, held against the fit's hashes."""

from __future__ import annotations

from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Final

from sim.physics.materials import Rubber, Surface, UnknownMaterialError
from tester.base.source import InvalidSource, Problem
from tester.inputs.kept_laws.law_schema import KeptLawModel
from tester.inputs.kept_laws.law_value import KeptLaw, load_law
from tester.inputs.materials.files import MaterialFile
from tester.inputs.materials.library import Library, rubber_of, surface_of

FOLDER: Final = "laws"
"""Folder of kept laws in a run's folder; compounds and surfaces are beside this folder."""


def content_hash(file: MaterialFile) -> str:
    """Return the hash of a material's file and of the data to which it refers."""
    return sha256("".join([file.sha256, *(data.sha256 for data in file.data)]).encode()).hexdigest()


def read_law(path: Path) -> KeptLaw:
    """Read a kept law, and its compound and surface if it has any. Raises InvalidSource with every problem."""
    kept = load_law(path)
    if not kept.model.of_materials:
        return kept
    made_of, changed = materials_of(kept.model, path)
    return replace(kept, doubts=(*kept.doubts, *changed), made_of=made_of)


def materials_of(model: KeptLawModel, path: Path) -> tuple[tuple[Rubber, Surface], list[str]]:
    """Return the rubber and the surface of a law's file, and a line for each that has changed since the fit.

    They are looked for beside the file, then as for a recipe. Raises InvalidSource.
    """
    library = Library.beside(path.parent if path.parent.name == FOLDER else path)
    try:
        compound, surface = library.compound(model.compound), library.surface_file(model.surface)
        found = {"compound": compound.file, "surface": surface.file}
        changed = [
            f"{role} {file.name} has changed since the fit of {path.name}: {file.path} has another content"
            for role, file in found.items()
            if content_hash(file) != dict(model.made_of).get(role)  # type: ignore[arg-type]
        ]
        return (rubber_of(compound), surface_of(surface)), changed
    except (UnknownMaterialError, ValueError) as error:
        if isinstance(error, InvalidSource):
            raise
        raise InvalidSource([Problem(str(path), 1, 1, f"the law is made of materials: {error}")]) from error
