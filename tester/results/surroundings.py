"""Sources of the uncertainty of a run's conditions beside their repeats, read from the run's record."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from math import inf, isfinite, sqrt

from tester.analysis.kelvin import UNKNOWN, Slope, SurfaceWarmth, slope_of_pairs
from tester.analysis.left_out import REPEATABILITY
from tester.analysis.measurand import Surroundings, with_budget
from tester.analysis.reference import CounterfaceDrift, KnownScatter, Reference, counterface_drift
from tester.analysis.reference_watch import ReferenceWatch, control_charts
from tester.analysis.repeats import ConditionResult
from tester.analysis.results import NAN
from tester.analysis.terms import NO_SIZE, Acts, Size, with_settings
from tester.analysis.uncertainty import Pool
from tester.analysis.wear_rate import WearCheck, Worn
from tester.base.axes import AxisValue, Setpoint, surface_of
from tester.results.table_rows import Measured
from tester.store.record_schema import StoreError
from tester.store.records import ConditionInfo, PieceInfo, StoredRepeat, StoredRun, Travel
from tester.store.run_reader import RunReader

_Held = tuple[str, tuple[AxisValue, ...]]
"""Common to conditions of a pair: the compound, and every axis but temperature."""
_SAME_K = 0.5
"""Range of a compound's known sensitivity about its temperature, K."""


class SurroundingsOf:
    """Sources of the uncertainty of a run's conditions."""

    def __init__(
        self,
        reader: RunReader,
        run: StoredRun,
        pieces: Sequence[PieceInfo],
        checks: Sequence[WearCheck],
        pool: Pool,
        measured: Iterable[tuple[Setpoint, ConditionResult]],
    ) -> None:
        """Read the data common to all conditions; raises StoreError for a setting of the budget that is no number.

        ``measured``: every condition but references; pairs of them give the sensitivity to temperature.
        """
        try:
            self.terms = with_settings(run.info.terms, run.info.metadata)
        except ValueError as error:
            raise StoreError(f"{reader.path}: {error}") from error
        self._known = run.info.known
        self._worn = _worn(pieces, checks)
        self._pool = pool
        self._drifts: dict[str, CounterfaceDrift | None] = {}
        quantities = reader.quantities()
        role = quantities.roles.temperature
        screen = quantities[role].screen if role else None
        self._axis = screen.axis if screen is not None else ""
        self._points: defaultdict[_Held, list[tuple[float, float]]] = defaultdict(list)
        for held, result in measured:
            if result.ok and result.mu_resultant > 0.0 and isfinite(result.measured.temperature):
                self._points[held.key(self._axis)].append((result.measured.temperature, result.mu_resultant))
        self._warming = reader.warming()
        self._travels = reader.travels()
        self._marks = reader.slid()

    def of(self, info: ConditionInfo, repeats: Sequence[StoredRepeat], result: ConditionResult) -> Surroundings:
        """Return the sources of uncertainty of a condition, or of replicates of one."""
        warmth = self._warmth(info.setpoint, repeats, result.measured.temperature)
        travel_m = self._travel(repeats).counterface_m
        drift = self._drifts.get(surface_of(info.setpoint))
        return Surroundings(self.terms, self._pool, warmth, self._size(repeats), drift, travel_m)

    def watch(self, references: Sequence[Measured], *, reserved: bool) -> ReferenceWatch:
        """Return the result of the reference conditions, and count the counterfaces' drift among the sources from now
        on; ``reserved``: a piece is reserved for them.
        """
        in_order = sorted(references, key=lambda condition: condition.info.condition)
        listed = [self._reference(number, condition) for number, condition in enumerate(in_order, start=1)]
        between = sum(term.standard for term in self.terms if term.acts is Acts.PIECE)
        known = KnownScatter(float(self._pool.df) if self._pool.df else inf, between, reserved)
        for surface in dict.fromkeys(reference.surface for reference in listed):
            own = [reference for reference in listed if reference.surface == surface]
            self._drifts[surface] = counterface_drift(own, known)
        return ReferenceWatch(tuple(listed), self._drifts, control_charts(listed, known))

    def _reference(self, number: int, condition: Measured) -> Reference:
        """Return a reference condition for the analysis, its coefficient at the nominal temperature."""
        info, repeats = condition.info, condition.repeats
        result = with_budget(condition.result, self.of(info, repeats, condition.result))
        travel = self._travel(repeats)
        return Reference(
            number,
            info.condition,
            condition.condition.started_s,
            info.compound,
            condition.last_piece,
            result.mu if result.ok else NAN,
            self._share() / sqrt(max(result.n_valid, 1)),
            travel.counterface_m,
            travel.piece_m,
            surface_of(info.setpoint),
        )

    def _share(self) -> float:
        return 0.01 * self._pool.s_percent if self._pool.df else REPEATABILITY

    def _travel(self, repeats: Sequence[StoredRepeat]) -> Travel:
        """Return the travel of counterface and piece, the mean over the repeats that count."""
        travels = [
            self._travels[repeat.key] for repeat in repeats if repeat.result.valid and repeat.key in self._travels
        ]
        if not travels:
            return Travel(NAN, NAN)
        n = len(travels)
        return Travel(
            sum(travel.counterface_m for travel in travels) / n, sum(travel.piece_m for travel in travels) / n
        )

    def _nominal_c(self, held: Setpoint) -> float:
        return next((held.number(axis.name) for axis in held.axes if axis.name == self._axis), NAN)

    def _warmth(self, held: Setpoint, repeats: Sequence[StoredRepeat], shown_c: float) -> SurfaceWarmth:
        nominal_c = self._nominal_c(held)
        rates = [self._warming.get(repeat.key, NAN) for repeat in repeats if repeat.result.valid]
        rates = [rate for rate in rates if isfinite(rate)]
        rate = sum(rates) / len(rates) if rates else 0.0
        return SurfaceWarmth(nominal_c, shown_c, rate, self._slope(held, nominal_c, shown_c))

    def _slope(self, held: Setpoint, nominal_c: float, shown_c: float) -> Slope:
        points = self._points.get(held.key(self._axis), [])
        slope = slope_of_pairs(shown_c, points) if isfinite(shown_c) else None
        if slope is not None:
            return slope
        for known_slope in self._known:
            if known_slope.compound == held.compound and abs(known_slope.temperature_c - nominal_c) <= _SAME_K:
                return known_slope.slope
        return UNKNOWN

    def _size(self, repeats: Sequence[StoredRepeat]) -> Size:
        """Return the diameter of the measured pieces, the least certain of several."""
        pieces = dict.fromkeys(repeat.piece for repeat in repeats)
        sizes = [self._worn[piece].size(self._slid(piece, repeats)) for piece in pieces if piece in self._worn]
        return max(sizes, key=lambda size: (not size.checked, size.checked_u_mm, size.loss_mm), default=NO_SIZE)

    def _slid(self, piece: int, repeats: Sequence[StoredRepeat]) -> float:
        """Return the middle of a piece's sliding in its repeats that count, m; NaN without a record."""
        marks = sorted([*self._marks.get(piece, ()), *(check.sliding_m for check in self._worn[piece].checks)])
        begun = [self._travels[repeat.key].piece_m for repeat in repeats
                 if repeat.piece == piece and repeat.result.valid and repeat.key in self._travels]  # fmt: skip
        middles = [0.5 * (at + next((mark for mark in marks if mark > at), at)) for at in begun if isfinite(at)]
        return sum(middles) / len(middles) if middles else NAN


def _worn(pieces: Sequence[PieceInfo], checks: Sequence[WearCheck]) -> dict[int, Worn]:
    return {
        piece.piece: Worn(
            piece.installed_diameter_mm,
            piece.diameter_mm if isfinite(piece.diameter_mm) else piece.installed_diameter_mm,
            piece.sliding_m,
            tuple(check for check in checks if check.used and check.piece == piece.piece),
        )
        for piece in pieces
    }
