"""This machine's part of fitting: its laws, and groups of conditions that are fitted together."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from tester.analysis.fit.fit_law import FitError, Law, Sourced
from tester.analysis.fit.fit_part import FitPart, LawPlace, MadeOf, Subject
from tester.base.axes import Setpoint
from tester.base.source import InvalidSource
from tester.kinds.specimen_on_track.axes import INTERFACES, held_by
from tester.kinds.specimen_on_track.fit.laws import GRETA, LAWS, OF_MATERIALS, WLF_BELL, reference_band
from tester.kinds.specimen_on_track.fit.run_data import LOAD, SPEED
from tester.kinds.specimen_on_track.fit.track_group import group_of

if TYPE_CHECKING:
    from sim.physics.materials import Materials


def _library() -> Materials:
    from tester.inputs.materials.library import Library

    return Library.beside()


def _refuse_different(folders: Sequence[Path]) -> None:
    """Raise FitError where two runs used different files of one name."""
    from tester.inputs.kept_laws.law_materials import content_hash
    from tester.inputs.materials.library import Library

    seen: dict[tuple[str, str], tuple[str, Path]] = {}
    for folder in folders:
        library = Library([folder])
        files = [library.compound(entry.name).file for entry in library.entries("compound")]
        files += [library.surface_file(entry.name).file for entry in library.entries("surface")]
        for file in files:
            role, content = file.path.parent.name, content_hash(file)
            before, other = seen.setdefault((role, file.name), (content, folder))
            if content != before:
                raise FitError(
                    f"{role}/{file.name}: {other.name} and {folder.name} used different files of it (expected runs of"
                    " the same material)"
                )


class TrackFits(FitPart):
    """Laws of a specimen on a track, and the conditions of runs."""

    laws = LAWS
    cells = (SPEED, LOAD)

    def __init__(self, materials: Callable[[], Materials] = _library) -> None:
        """``materials``: returns the compounds and surfaces."""
        self._materials = materials

    def run_points(self, folder: Path) -> Sourced:
        """Return the conditions of a run, a group for each compound, interface and surface; raises StoreError."""
        from tester.kinds.specimen_on_track.fit.run_data import run_points

        return run_points(folder)

    def of_runs(self, folders: Sequence[Path]) -> FitPart:
        from tester.inputs.materials.library import Library

        _refuse_different(folders)
        return TrackFits(lambda: Library([*folders, *Library.beside().folders]))

    def bound(self, law: Law, group: str, surface: str, figures: Mapping[str, float]) -> Law:
        """Return a law for a group, with the moduli of its compound and its surface if needed; raises FitError."""
        wanted = group_of(group)
        if law.name not in OF_MATERIALS:
            if figures:
                raise FitError(f"the law {law.name} takes no figures, not {', '.join(figures)}")
            return self._with_glass(law, wanted.compound) if law.name == WLF_BELL.name else law
        if law.name == GRETA.name and wanted.interface != INTERFACES[0]:
            raise FitError(f"{group}: the law {law.name} includes adhesion, it is for dry contact")
        named = surface or wanted.surface
        if not named:
            raise FitError(f"{group}: the run does not name its surface (expected --surface NAME)")
        from tester.kinds.specimen_on_track.fit import greta_fit, persson_fit

        bound = greta_fit.bound if law.name == GRETA.name else persson_fit.bound
        try:
            materials = self._materials()
            return bound(materials.rubber(wanted.compound), materials.surface(named), figures)
        except (ValueError, InvalidSource) as error:
            raise FitError(f"{group}: {error}") from error

    def made_of(self, law: Law, group: str, surface: str, figures: Mapping[str, float]) -> MadeOf | None:
        """Return the files of a law of materials; raises FitError."""
        if law.name not in OF_MATERIALS:
            return None
        from tester.inputs.kept_laws.law_materials import content_hash
        from tester.inputs.materials.library import Library
        from tester.kinds.specimen_on_track.fit.persson_fit import AREA_MM2

        wanted, library = group_of(group), self._materials()
        named = surface or wanted.surface
        if not isinstance(library, Library):
            raise FitError(f"{group}: the law {law.name} is kept with the files of its materials, and there are none")
        files = {"compound": library.compound(wanted.compound).file, "surface": library.surface_file(named).file}
        rest = {name: value for name, value in figures.items() if name != "area"}
        hashes = {role: content_hash(file) for role, file in files.items()}
        return MadeOf(named, figures.get("area", AREA_MM2), rest, hashes)

    def subject(self, group: str) -> Subject:
        return Subject(*group_of(group))

    def place(self, setpoint: Setpoint) -> LawPlace | None:
        """Return the variables at a setpoint; the surface is that of the axis, "" for the run's."""
        held = held_by(setpoint)
        subject = Subject(setpoint.compound, held.interface, held.surface)
        return LawPlace(subject, held.temperature_c, held.load_n, held.track_m_s)

    def _with_glass(self, law: Law, compound: str) -> Law:
        """Return the bell; the band of its t_ref comes from the glass transition in a compound's file."""
        try:
            glass_c = self._materials().rubber(compound).glass_c
        except (ValueError, InvalidSource):
            # No file, or a file without moduli: the band of all rubbers is used.
            return law
        bands = {"t_ref": reference_band(glass_c)}
        return replace(law, parameters=tuple(replace(p, band=bands.get(p.name, p.band)) for p in law.parameters))


FITS: Final = TrackFits()
