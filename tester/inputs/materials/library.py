"""Compounds and surfaces by their names: beside the recipe, then in the laboratory's folder, then as packaged.

If two places hold a name, the nearer takes precedence. A name that occurs twice in one folder is refused as ambiguous.
This module alone turns a file into the input of friction laws.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING

import recipes
from sim.physics.laws import StatedLaw
from sim.physics.materials import Rubber, Shear, ShearModulus, Sinusoid, Spectrum, Surface, UnknownMaterialError
from tester.base.source import InvalidSource, Problem, load_tree
from tester.base.units import shown
from tester.inputs.materials.compound import LoadedCompound, load_compound
from tester.inputs.materials.files import FOLDERS, Role
from tester.inputs.materials.material_schema import CompoundModel, ModuliModel
from tester.inputs.materials.measured_moduli import ModuliTable

if TYPE_CHECKING:
    from tester.inputs.materials.surface_file import LoadedSurface

VARIABLE = "TESTER_MATERIALS"
"""Environment variable: the laboratory's folder, with ``compounds`` and ``surfaces`` in it."""
DECADE_K = 8.0
"""Kelvin equivalent to a decade of frequency, where a file has none [A] (paper G, Eq 9)."""
_NAME = re.compile(r"^(?:name|\"name\"|'name')[ \t]*:.*$", re.MULTILINE)


class MissingModuliError(ValueError):
    """A compound's file without moduli, or without usable ones; the message names the missing part."""


@dataclass(frozen=True, slots=True)
class LibraryEntry:
    """A file of a folder, by its name in recipes; ``hidden``: a nearer file has the same name."""

    role: Role
    name: str
    path: Path
    hidden: bool = False


class Library:
    """Finds compounds and surfaces in folders, the nearest first (``sim.physics.materials.Materials``).

    Every lookup reads the folders anew; nothing is cached.
    """

    def __init__(self, folders: Sequence[Path]) -> None:
        """``folders``: each with ``compounds`` and ``surfaces``; a missing one is empty."""
        self.folders = tuple(dict.fromkeys(folders))

    @classmethod
    def beside(cls, recipe: Path | None = None) -> Library:
        """Return the library of a recipe: its own folder, that of ``TESTER_MATERIALS``, the packaged one.

        Raises InvalidSource where the variable names no folder: another compound of the same name would be used.
        """
        recipe_folder = [recipe.parent] if recipe is not None else []
        laboratory = os.environ.get(VARIABLE, "")
        if laboratory and not Path(laboratory).is_dir():
            raise InvalidSource(
                [Problem(VARIABLE, 1, 1, f"{shown(laboratory)} is no folder (expected the laboratory's)")]
            )
        return cls([*recipe_folder, *([Path(laboratory)] if laboratory else []), recipes.FOLDER])

    def entries(self, role: Role) -> list[LibraryEntry]:
        """Return every file of a role, nearest first and sorted in a folder. Raises InvalidSource for doubled names."""
        listed: list[LibraryEntry] = []
        for folder in self.folders:
            files = [*_named(folder / FOLDERS[role])]
            _refuse_doubled(files)
            nearer = {entry.name for entry in listed}
            listed += [LibraryEntry(role, name, path, hidden=name in nearer) for path, name in files]
        return listed

    def path(self, role: Role, name: str) -> Path | None:
        """Return the file of a name, None where none has it. Raises InvalidSource where two of a folder have it."""
        for folder in self.folders:
            files = [(path, named) for path, named in _named(folder / FOLDERS[role]) if named == name]
            _refuse_doubled(files)
            if files:
                return files[0][0]
        return None

    def compound(self, name: str) -> LoadedCompound:
        """Return a compound's file. Raises UnknownMaterialError, InvalidSource."""
        return load_compound(self._found("compound", name))

    def surface_file(self, name: str) -> LoadedSurface:
        """Return a surface's file. Raises UnknownMaterialError, InvalidSource."""
        from tester.inputs.materials.surface_file import load_surface  # needs numpy; a plan reads only compounds

        return load_surface(self._found("surface", name))

    def rubber(self, name: str) -> Rubber:
        """Return a compound as input of friction laws.

        Raises UnknownMaterialError, InvalidSource, and MissingModuliError (a ValueError) where its file has no moduli.
        """
        return rubber_of(self.compound(name))

    def surface(self, name: str) -> Surface:
        """Return a surface as input of friction laws. Raises UnknownMaterialError, InvalidSource."""
        return surface_of(self.surface_file(name))

    def stated_law(self, name: str) -> StatedLaw | None:
        """Return the law that a compound's file states; None without a file, or for one without it.

        Raises InvalidSource.
        """
        path = self.path("compound", name)
        law = load_compound(path).model.law if path is not None else None
        return law.stated() if law is not None else None

    def _found(self, role: Role, name: str) -> Path:
        path = self.path(role, name)
        if path is not None:
            return path
        known = [*dict.fromkeys(title for folder in self.folders for _, title in _named(folder / FOLDERS[role]))]
        near = get_close_matches(name, known, 1)
        meant = f", did you mean {shown(near[0])}?" if near else ""
        where = ", ".join(str(folder / FOLDERS[role]) for folder in self.folders)
        raise UnknownMaterialError(f"no file of a {role} has the name {shown(name)}{meant} (looked in {where})")


def rubber_of(loaded: LoadedCompound) -> Rubber:
    """Return a compound as input of friction laws. Raises MissingModuliError."""
    model, moduli = loaded.model, loaded.model.moduli
    if moduli is None:
        raise MissingModuliError(f"compound {shown(model.name)}: {loaded.file.path} holds no moduli")
    shear = model.shear
    try:
        modulus = _modulus(model, moduli, loaded.table)
    except ValueError as error:
        raise MissingModuliError(f"compound {shown(model.name)}: {loaded.file.path}: {error}") from error
    return Rubber(
        name=model.name,
        modulus=modulus,
        poisson=model.poisson,
        glass_c=model.Tg,
        shear=Shear(shear.tau_s0, shear.v_c, shear.n, shear.ratio) if shear is not None else None,
        decade_k=model.decade_k or DECADE_K,
    )


def _modulus(model: CompoundModel, moduli: ModuliModel, table: ModuliTable | None) -> ShearModulus:
    from sim.physics.moduli import ConstantModulus, DmaRow, FractionalZener, TabulatedModulus  # needs numpy

    if moduli.constant is not None:
        return ConstantModulus(moduli.constant.G, moduli.constant.loss_factor)
    if moduli.fractional_zener is not None:
        z = moduli.fractional_zener
        return FractionalZener(z.Gr, z.Gg, z.tau, z.b, shift_c=z.Ts, t_ref_c=z.at)
    assert table is not None
    rows = [DmaRow(r.temperature_c, r.frequency_hz, r.storage_pa, r.loss_pa) for r in table.rows]
    hold = moduli.beyond == "hold"
    if len(table.frequencies_hz) == 1:
        return TabulatedModulus.of_sweep(rows, model.poisson, model.decade_k or DECADE_K, hold)
    if model.Tg is None:
        raise ValueError("Tg is missing: moduli at several frequencies are put on one curve by the shift of Tg + 50 K")
    return TabulatedModulus.of_grid(rows, model.Tg, model.poisson, hold)


def surface_of(loaded: LoadedSurface) -> Surface:
    """Return a surface as input of friction laws; two waves that its file lacks are found in its spectrum."""
    from sim.physics.roughness import SelfAffine, TabulatedSpectrum, two_waves  # needs numpy

    model = loaded.model
    spectrum: Spectrum | None = None
    if model.spectrum is not None:
        s = model.spectrum
        spectrum = SelfAffine(s.C0, s.q0, s.q1, s.H)
    elif loaded.radial is not None:
        spectrum = TabulatedSpectrum(loaded.radial.q_1_m, loaded.radial.power_m4)
    if model.waves is not None:
        coarse, fine = (Sinusoid(wave.wavelength, wave.Ra) for wave in (model.waves.coarse, model.waves.fine))
        return Surface(model.name, spectrum, coarse, fine)
    found = two_waves(spectrum) if spectrum is not None else None
    if found is None:
        return Surface(model.name, spectrum)
    return Surface(model.name, spectrum, found.coarse, found.fine, found.split_m)


def _named(folder: Path) -> Iterator[tuple[Path, str]]:
    """Yield the YAML files of a folder with their names. Only the line of the name is read: lists stay fast."""
    for path in _files(folder):
        try:
            line = _NAME.search(path.read_text(encoding="utf-8", errors="replace"))
            data = load_tree(line[0].rstrip("\r")).data if line else None
        except (OSError, InvalidSource):
            continue  # opening the file by its path reports its faults
        if isinstance(data, dict) and isinstance(data.get("name"), str):
            yield path, str(data["name"])


def _files(folder: Path) -> list[Path]:
    """Return the YAML files of a folder, and of the folders in it."""
    return [*sorted(folder.glob("*.yaml")), *sorted(folder.glob("*/*.yaml"))]


def nameless(library: Library) -> Iterator[Path]:
    """Yield the YAML files of a library's folders without a name."""
    for folder in library.folders:
        for below in FOLDERS.values():
            named = {path for path, _ in _named(folder / below)}
            yield from (path for path in _files(folder / below) if path not in named)


def _refuse_doubled(files: Iterable[tuple[Path, str]]) -> None:
    """Raise InvalidSource where two files of a folder have one name."""
    first: dict[str, Path] = {}
    problems: list[Problem] = []
    for path, name in files:
        if first.setdefault(name, path) is not path:
            duplicate = f"name: {shown(name)} is already the name of {first[name].name} in this folder"
            problems.append(Problem(str(path), 1, 1, duplicate))
    if problems:
        raise InvalidSource(problems)
