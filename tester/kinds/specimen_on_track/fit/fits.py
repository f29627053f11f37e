"""What this machine says about fitting (``tester.analysis.fit.fit_part``)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from tester.analysis.fit.fit_law import FitError, FitPoint, Law, Sourced
from tester.analysis.fit.fit_part import FitPart, PublishedTable
from tester.base.axes import Setpoint
from tester.base.source import InvalidSource
from tester.kinds.specimen_on_track.axes import INTERFACES
from tester.kinds.specimen_on_track.fit.groups import TrackGroup, group_of
from tester.kinds.specimen_on_track.fit.laws import GRETA, LAWS, OF_MATERIALS, WLF_BELL, reference_band
from tester.kinds.specimen_on_track.fit.run_data import INTERFACE, LOAD, SPEED

if TYPE_CHECKING:
    from sim.physics.materials import Materials


def _library() -> Materials:
    from tester.inputs.materials.library import Library

    return Library.beside()


class TrackFits:
    """Laws of a specimen on a track, and the conditions of runs; nothing ships, and nothing is published."""

    def __init__(self, materials: Callable[[], Materials] = _library) -> None:
        """Take where compounds and surfaces are found."""
        self._materials = materials

    laws: Mapping[str, Law] = LAWS
    cells: tuple[int, ...] = (SPEED, LOAD)
    packaged: Sequence[str] = ()

    def packaged_points(self, name: str) -> Sourced:
        """Raise KeyError: none ship."""
        raise KeyError(name)

    def run_points(self, folder: Path) -> Sourced:
        """Return the conditions of a run, a group for each compound, interface and surface; raises StoreError."""
        from tester.kinds.specimen_on_track.fit.run_data import run_points
        from tester.store.run_reader import RunReader

        found = run_points(folder)
        with RunReader(folder) as reader:
            surface = reader.run().info.metadata.get("abrasive", "")
        return Sourced(tuple(_grouped(one, surface) for one in found.points), found.left_out)

    def bound(self, law: Law, group: str, surface: str, figures: Mapping[str, float]) -> Law:
        """Return a law for a group: of its compound's moduli and its surface where it needs them; raises FitError."""
        if law.name not in OF_MATERIALS:
            if figures:
                raise FitError(f"the law {law.name} is given no figures, not {', '.join(figures)}")
            return self._with_glass(law, group_of(group).compound) if law.name == WLF_BELL.name else law
        own = group_of(group)
        if law.name == GRETA.name and own.interface != INTERFACES[0]:
            raise FitError(f"{group}: the law {law.name} has an adhesion, and is of dry contact")
        named = surface or own.surface
        if not named:
            raise FitError(f"{group}: the run does not say on what surface (expected --surface NAME)")
        from tester.kinds.specimen_on_track.fit import greta_fit, persson_fit

        bound = greta_fit.bound if law.name == GRETA.name else persson_fit.bound
        try:
            materials = self._materials()
            return bound(materials.rubber(own.compound), materials.surface(named), figures)
        except (ValueError, InvalidSource) as error:
            raise FitError(f"{group}: {error}") from error

    def _with_glass(self, law: Law, compound: str) -> Law:
        """Return the bell with the band of its t_ref for a compound, whose glass transition its file may say."""
        try:
            glass_c = self._materials().rubber(compound).glass_c
        except (ValueError, InvalidSource):  # without a file, or without moduli in it, any rubber's is as good
            return law
        bands = {"t_ref": reference_band(glass_c)}
        return replace(
            law, parameters=tuple(replace(one, band=bands.get(one.name, one.band)) for one in law.parameters)
        )

    def published_values(self) -> Sequence[tuple[Setpoint, float]]:
        """Return none."""
        return ()

    published_laws: Sequence[str] = ()

    def law_caveats(self, setpoint: Setpoint) -> Sequence[str]:
        """Return none."""
        return ()

    def law_at(self, name: str) -> Callable[[Setpoint], float]:
        """Raise KeyError: no law has published parameters of a specimen on a track."""
        raise KeyError(name)

    def checked(self, sources: Sequence[str], validation: Sequence[str]) -> bool:
        """Tell that nothing is known of what has to come out."""
        return False

    def published_table(self) -> PublishedTable:
        """Raise FitError: there is no publication."""
        raise FitError("nothing is published of a specimen on a track")


def _grouped(point: FitPoint, surface: str) -> FitPoint:
    """Return a point without its interface, of the group that has it."""
    interface = INTERFACES[round(point.nominal[INTERFACE])]
    group = TrackGroup(point.group, interface, surface).text
    return replace(point, group=group, nominal=point.nominal[:INTERFACE], measured=point.measured[:INTERFACE])


FITS: Final[FitPart] = TrackFits()
"""A specimen on a track."""
