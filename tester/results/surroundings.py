"""What the uncertainty of a run's conditions comes from beside their repeats, read off the run's record."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite, sqrt
from typing import NamedTuple

from tester.analysis.kelvin import UNKNOWN, Slope, SurfaceWarmth, slope_of_pairs
from tester.analysis.measurand import Surroundings
from tester.analysis.reference import CounterfaceDrift, KnownScatter, Reference
from tester.analysis.repeats import REPEATABILITY, ConditionResult
from tester.analysis.results import NAN
from tester.analysis.terms import NO_SIZE, Acts, Size, with_settings
from tester.analysis.uncertainty import Pool
from tester.analysis.wear import WearCheck
from tester.analysis.worn import Worn
from tester.base.axes import AxisValue, Setpoint
from tester.store.reader import RunReader
from tester.store.records import ConditionInfo, PieceInfo, StoredRepeat, StoredRun, Travel
from tester.store.schema import StoreError

_Held = tuple[str, tuple[AxisValue, ...]]
"""What conditions of a pair have in common: the compound, and every axis but temperature."""
_SAME_K = 0.5
"""What is known of a compound holds this near to its temperature."""


class Reduced(NamedTuple):
    """A condition's result, and the rig time at which it began."""

    started_s: float
    result: ConditionResult


class SurroundingsOf:
    """Finds what a condition's uncertainty comes from; ``add`` every condition first: pairs of them say how the
    coefficient depends on temperature."""

    def __init__(
        self,
        reader: RunReader,
        run: StoredRun,
        pieces: Sequence[PieceInfo],
        checks: Sequence[WearCheck],
        pool: Pool,
    ) -> None:
        """Read what all conditions share; raises StoreError for a setting of the budget that is no number."""
        try:
            self.terms = with_settings(run.info.terms, run.info.metadata)
        except ValueError as error:
            raise StoreError(f"{reader.path}: {error}") from error
        self._known = run.info.known
        self._worn = _worn(pieces, checks)
        self._pool = pool
        self._warming = reader.warming()
        self._travels = reader.travels()
        self._marks = reader.slid()
        self._drift: CounterfaceDrift | None = None
        quantities = reader.quantities()
        role = quantities.roles.temperature
        screen = quantities[role].screen if role else None
        self._axis = screen.axis if screen is not None else ""
        self._points: dict[_Held, list[tuple[float, float]]] = {}

    def add(self, held: Setpoint, result: ConditionResult) -> None:
        """Take a condition's temperature and coefficient in."""
        if result.ok and result.mu_resultant > 0.0 and isfinite(result.measured.temperature):
            self._points.setdefault(self._held(held), []).append((result.measured.temperature, result.mu_resultant))

    def of(self, info: ConditionInfo, repeats: Sequence[StoredRepeat], result: ConditionResult) -> Surroundings:
        """Return what the uncertainty of a condition, or of replicates of one, comes from."""
        warmth = self._warmth(info.setpoint, repeats, result.measured.temperature)
        travel_m = self._travel(repeats).counterface_m
        return Surroundings(self.terms, self._pool, warmth, self._size(repeats), self._drift, travel_m)

    def reference(self, number: int, info: ConditionInfo, repeats: Sequence[StoredRepeat], at: Reduced) -> Reference:
        """Return a reference condition as the analysis wants it; ``at``: when it began, and its result."""
        result, travel = at.result, self._travel(repeats)
        n = max(result.n_valid, 1)
        kept = [one.piece for one in repeats if one.result.valid]
        return Reference(
            number,
            info.condition,
            at.started_s,
            info.compound,
            kept[-1] if kept else 0,
            result.mu if result.ok else NAN,
            self._share() / sqrt(n),
            travel.counterface_m,
            travel.piece_m,
        )

    def known(self, reserved: bool) -> KnownScatter:
        """Return what is known of scatter beside references."""
        between = sum(one.standard for one in self.terms if one.acts is Acts.PIECE)
        return KnownScatter(float(self._pool.df) if self._pool.df else inf, between, reserved)

    def watched(self, drift: CounterfaceDrift | None) -> None:
        """Take in what reference conditions say of the counterface."""
        self._drift = drift

    def _share(self) -> float:
        return 0.01 * self._pool.s_percent if self._pool.df else REPEATABILITY

    def _travel(self, repeats: Sequence[StoredRepeat]) -> Travel:
        """Return how far counterface and piece had come at the mean of the repeats that count."""
        found = [self._travels[one.key] for one in repeats if one.result.valid and one.key in self._travels]
        if not found:
            return Travel(NAN, NAN)
        n = len(found)
        return Travel(sum(one.counterface_m for one in found) / n, sum(one.piece_m for one in found) / n)

    def _held(self, held: Setpoint) -> _Held:
        return held.compound, tuple(axis.of(held) for axis in held.axes if axis.name != self._axis)

    def _nominal_c(self, held: Setpoint) -> float:
        return next((held.number(axis.name) for axis in held.axes if axis.name == self._axis), NAN)

    def _warmth(self, held: Setpoint, repeats: Sequence[StoredRepeat], shown_c: float) -> SurfaceWarmth:
        nominal_c = self._nominal_c(held)
        rates = [self._warming.get(one.key, NAN) for one in repeats if one.result.valid]
        rates = [rate for rate in rates if isfinite(rate)]
        rate = sum(rates) / len(rates) if rates else 0.0
        return SurfaceWarmth(nominal_c, shown_c, rate, self._slope(held, nominal_c, shown_c))

    def _slope(self, held: Setpoint, nominal_c: float, shown_c: float) -> Slope:
        points = self._points.get(self._held(held), [])
        found = slope_of_pairs(shown_c, points) if isfinite(shown_c) else None
        if found is not None:
            return found
        for one in self._known:
            if one.compound == held.compound and abs(one.temperature_c - nominal_c) <= _SAME_K:
                return one.slope
        return UNKNOWN

    def _size(self, repeats: Sequence[StoredRepeat]) -> Size:
        """Return the diameter of the pieces that were measured on, the worst known of them."""
        pieces = dict.fromkeys(one.piece for one in repeats)
        sizes = [self._worn[one].size(self._slid(one, repeats)) for one in pieces if one in self._worn]
        return max(sizes, key=lambda one: (not one.checked, one.checked_u_mm, one.loss_mm), default=NO_SIZE)

    def _slid(self, piece: int, repeats: Sequence[StoredRepeat]) -> float:
        """Return how far a piece had slid in the middle of the repeats on it that count, m; NaN where nothing says."""
        marks = sorted([*self._marks.get(piece, ()), *(one.sliding_m for one in self._worn[piece].checks)])
        begun = [self._travels[one.key].piece_m for one in repeats
                 if one.piece == piece and one.result.valid and one.key in self._travels]  # fmt: skip
        middles = [0.5 * (at + next((mark for mark in marks if mark > at), at)) for at in begun if isfinite(at)]
        return sum(middles) / len(middles) if middles else NAN


def _worn(pieces: Sequence[PieceInfo], checks: Sequence[WearCheck]) -> dict[int, Worn]:
    return {
        one.piece: Worn(
            one.installed_diameter_mm,
            one.diameter_mm if isfinite(one.diameter_mm) else one.installed_diameter_mm,
            one.sliding_m,
            tuple(check for check in checks if check.used and check.piece == one.piece),
        )
        for one in pieces
    }
