"""Mutants of code other than a machine's terms: repeats, drift, temperature, diameter, counterface, sums,
differences."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tests.campaigns.budget.mutant import SIGNED, SIZES, Mutant, scaled, tests_of

_MEASURAND, _KELVIN = "tester/analysis/measurand.py", "tester/analysis/kelvin.py"
_REFERENCE, _WORN = "tester/analysis/reference.py", "tester/analysis/wear_rate.py"
_UNCERTAINTY, _DIFFERENCE = "tester/analysis/uncertainty.py", "tester/analysis/difference.py"
_SURROUNDINGS = "tester/results/surroundings.py"
_TESTS = tests_of(*(f"analysis/{name}" for name in ("kelvin", "measurand", "reference", "uncertainty", "difference")))
_OF_WORN, _OF_RUNS = tests_of("analysis/worn"), tests_of("results/budget_table")

_OF_MEASURAND: Final = (
    ("repeatability", "contribution(REPEATABILITY, s, mu * share, df=float(pool.df)",
     "contribution(REPEATABILITY, {} * s, mu * share, df=float(pool.df)"),
    ("repeatability of its own", "contribution(REPEATABILITY, own_s, mu * share",
     "contribution(REPEATABILITY, {} * own_s, mu * share"),
    ("repeatability of a run of one condition", "contribution(REPEATABILITY, result.s, share",
     "contribution(REPEATABILITY, {} * result.s, share"),
    ("drift", '("drift", unsteady.drift_percent,', '("drift", {} * unsteady.drift_percent,'),
    ("carry-over", '("carry-over", unsteady.carry_over_percent,', '("carry-over", {} * unsteady.carry_over_percent,'),
    ("between replicates", "contribution(BETWEEN, s, mu", "contribution(BETWEEN, {} * s, mu"),
    ("repeatability of replicates", "of_mean = Contribution(\n        REPEATABILITY, repeats.standard / n",
     "of_mean = Contribution(REPEATABILITY, {} * repeats.standard / n"),
)  # fmt: skip
_OF_KELVIN: Final = (
    ("temperature sensitivity", "self.slope.u_per_kelvin, mu * over_k", "{} * self.slope.u_per_kelvin, mu * over_k"),
    ("scatter of conditions in a sensitivity", "scattered = CONDITION_SCATTER", "scattered = {} * CONDITION_SCATTER"),
    ("curvature of a chord", "curved = 0.5 * abs(chord)", "curved = {} * 0.5 * abs(chord)"),
    ("curvature of a parabola", "curved = abs(parabola - chord)", "curved = {} * abs(parabola - chord)"),
)
_OF_REFERENCE: Final = (
    ("counterface", "rate = hypot(self.per_m, self.standard)", "rate = {} * hypot(self.per_m, self.standard)"),
    ("piece to piece in the counterface's drift", "(between * float(np.linalg.norm(",
     "({} * between * float(np.linalg.norm("),
    ("sliding of the piece in the counterface's drift", "abs(float(taken[-1])) * PIECE_PER_M",
     "{} * abs(float(taken[-1])) * PIECE_PER_M"),
)  # fmt: skip
_OF_UNCERTAINTY: Final = (
    ("drift in what moves", "drift = (abs(judged.drift_percent)", "drift = {} * (abs(judged.drift_percent)"),
    ("the drift's own error", "+ judged.drift_error_percent)", "+ {} * judged.drift_error_percent)"),
    ("carry-over in what moves", "carried = abs(judged.trend_percent)", "carried = {} * abs(judged.trend_percent)"),
    ("a contribution", "standard = input_u * abs(sensitivity)", "standard = {} * input_u * abs(sensitivity)"),
    ("the coverage factor", "coverage * standard)", "{} * coverage * standard)"),
)
_OF_WORN_PIECES: Final = (
    ("what a belief was off by between checks", "share * off_mm)", "{} * share * off_mm)"),
    ("what wore off since the last check", "since_mm * self._rate_share())\n        return self._sized",
     "{} * since_mm * self._rate_share())\n        return self._sized"),
    ("how a series began", "return abs(begun_mm)", "return {} * abs(begun_mm)"),
    ("how a series began, by its rate", "return hypot(by_rate_mm - begun_mm, u_mm)",
     "return {} * hypot(by_rate_mm - begun_mm, u_mm)"),
    ("reading of a check", "hypot(*(share * reading.u_mm", "hypot(*({} * share * reading.u_mm"),
    ("loss by interpolation", "self._loss(before) + share * worn_mm", "self._loss(before) + {} * share * worn_mm"),
    ("loss that is believed", "self._sized(loss_mm * _share(", "self._sized({} * loss_mm * _share("),
)  # fmt: skip


def of_formulas() -> Iterator[Mutant]:
    """Yield mutants with a wrong scale."""
    yield from scaled(_MEASURAND, _TESTS, _OF_MEASURAND)
    yield from scaled(_KELVIN, _TESTS, _OF_KELVIN)
    yield from scaled(_KELVIN, _TESTS, [("correction of temperature", "exp(-self.slope.per_kelvin",
                                         "exp(-{} * self.slope.per_kelvin")], SIGNED)  # fmt: skip
    yield from scaled(_REFERENCE, _TESTS, _OF_REFERENCE)
    yield from scaled(_UNCERTAINTY, _TESTS, _OF_UNCERTAINTY)
    yield from scaled(_WORN, _OF_WORN, _OF_WORN_PIECES)
    yield from scaled(_MEASURAND, tests_of("kinds/specimen_on_track/track_budget"), [
        ("sensitivity in what is expected", "SurfaceWarmth(slope=slope).contribution(at.mu, chain)",
         "SurfaceWarmth(slope=slope).contribution({} * at.mu, chain)"),
    ], SIZES)  # fmt: skip


def of_structure() -> Iterator[Mutant]:
    """Yield mutants with a wrong combination."""
    for name, path, old, new, tests in (
        ("common errors stay in a difference", _DIFFERENCE, "abs(first_term.error - second_term.error)",
         "abs(first_term.error) + abs(second_term.error)", _TESTS),
        ("own errors of the second drop out", _DIFFERENCE,
         "for budget in budgets\n        for first_term in budget\n        if not",
         "for budget in budgets[:1] for first_term in budget if not", _TESTS),
        ("degrees of freedom are forgotten", _UNCERTAINTY, "return standard**4 / limited if limited > 0.0 else inf",
         "return inf", _TESTS),
        ("the wheel is in both measurands", _MEASURAND, "budget=budget(this)", "budget=budget([*this, *between])",
         _TESTS),
        ("the wheel is in neither", _MEASURAND, "budget([*this, *between, *by.counterface(mu)])", "budget(this)",
         _TESTS),
        ("the counterface is in no measurand", _MEASURAND, "budget([*this, *between, *by.counterface(mu)])",
         "budget([*this, *between])", _TESTS),
        ("the counterface is not in replicates", _MEASURAND, "budget([*chain, *between, *by.counterface(mu)])",
         "budget([*chain, *between])", _TESTS),
        ("the lag is not corrected", _KELVIN, "self.shown_c + lag_s * self.rate_k_s", "self.shown_c", _TESTS),
        ("an unknown sensitivity corrects", _KELVIN, "if self.slope.known else 1.0", "if True else 1.0", _TESTS),
        ("a thermometer's error is left out of the sensitivity's", _KELVIN,
         "over_k = hypot(self.offset_k(terms), thermometer_k)", "over_k = abs(self.offset_k(terms))", _TESTS),
        ("an offset is left out of the sensitivity's", _KELVIN,
         "over_k = hypot(self.offset_k(terms), thermometer_k)", "over_k = thermometer_k", _TESTS),
        ("the degrees of freedom of a pool are those of a condition", _MEASURAND,
         "s, mu * share, df=float(pool.df), source=source)", "s, mu * share, df=df, source=source)", _TESTS),
        ("a file is believed before the run's own pairs", _SURROUNDINGS,
         "if slope is not None:\n            return slope", "if slope is None:\n            return UNKNOWN", _OF_RUNS),
        ("what is known at another temperature is taken", _SURROUNDINGS,
         "abs(known_slope.temperature_c - nominal_c) <= _SAME_K", "True", _OF_RUNS),
        ("another compound's sensitivity is taken", _SURROUNDINGS,
         "known_slope.compound == held.compound and abs", "abs",
         _OF_RUNS),
        ("a pair may differ in more than temperature", _SURROUNDINGS,
         "self._points.get(held.key(self._axis), [])", "[p for points in self._points.values() for p in points]",
         _OF_RUNS),
        ("the wheel's end stands for every condition", _SURROUNDINGS,
         "self._worn[piece].size(self._slid(piece, repeats))",
         "self._worn[piece].size(NAN)", _OF_RUNS),
        ("a check of another series is taken", _WORN,
         "check.sliding_m > at_m and check.reference_s == before.reference_s",
         "check.sliding_m > at_m", _OF_WORN),
        ("a person's check has the offset of a roll's", _WORN, 'if check.method != "roll":', "if False:", _OF_WORN),
        ("a series is read without its first check", _WORN, "weights[first] = weights.get(first, 0.0) - 1.0",
         "weights[first] = weights.get(first, 0.0)", _OF_WORN),
        ("a rate that checks have not resolved is believed", _WORN, "if rate.resolved else 1.0", "if True else 1.0",
         _OF_WORN),
        ("checks that were not believed count", _WORN,
         "used = [check for check in self.checks if check.used]\n        before",
         "used = [*self.checks]\n        before",
         _OF_WORN),
    ):  # fmt: skip
        yield Mutant(name, path, old, new, tests)
