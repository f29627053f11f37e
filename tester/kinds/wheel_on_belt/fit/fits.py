"""What this machine says about fitting (``tester.analysis.fit.fit_part``)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from sim.physics.friction import MODEL_NAMES
from tester.analysis.fit.fit_law import FitError, Law, Sourced
from tester.analysis.fit.fit_part import FitPart, PublishedTable
from tester.kinds.wheel_on_belt.fit import data
from tester.kinds.wheel_on_belt.fit.laws import LAWS, LOAD, SLIP


class WheelFits:
    """Laws of a wheel on a belt, the paper's appendices, and the conditions of runs."""

    laws: Mapping[str, Law] = LAWS
    cells: tuple[int, ...] = (LOAD, SLIP)
    packaged: Sequence[str] = tuple(data.APPENDICES)

    published_laws: Sequence[str] = MODEL_NAMES
    packaged_points = staticmethod(data.appendix)
    published_values = staticmethod(data.published_values)
    law_caveats = staticmethod(data.law_caveats)
    law_at = staticmethod(data.law_at)

    def run_points(self, folder: Path) -> Sourced:
        """Return the conditions of a run; raises StoreError."""
        from tester.kinds.wheel_on_belt.fit.run_data import run_points

        return run_points(folder)

    def bound(self, law: Law, group: str, surface: str, figures: Mapping[str, float]) -> Law:
        """Return the law as it is; raises FitError for figures: a wheel's laws are given none."""
        if surface or figures:
            raise FitError(f"the law {law.name} is given no surface and no figures")
        return law

    def checked(self, sources: Sequence[str], validation: Sequence[str]) -> bool:
        """Return whether this is the paper's own split: fitted to appendix A, seen on B."""
        from tester.kinds.wheel_on_belt.fit.published import FIT, VALIDATION

        return [*sources] == [FIT] and [*validation] == [VALIDATION]

    def published_table(self) -> PublishedTable:
        """Return the paper's table; raises MissingExtraError."""
        from tester.kinds.wheel_on_belt.fit.published import published_table

        return published_table()


FITS: Final[FitPart] = WheelFits()
