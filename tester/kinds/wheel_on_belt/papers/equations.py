"""Equations 1 to 9 and Table 3: as printed, as meant, and as fitted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import exp, log
from statistics import fmean
from typing import Final

import numpy as np

from sim.physics.friction import COMPOUNDS, PaperParameters, coefficient, thermal_factor
from tester.analysis.fit.check import Errors, errors_of
from tester.analysis.fit.fit_law import FitPoint, by_group
from tester.analysis.papers import PaperFinding, PaperItem, judged, slight, unjudged
from tester.base.arrays import Array
from tester.kinds.wheel_on_belt.fit.data import Reading, appendix
from tester.kinds.wheel_on_belt.fit.laws import LOAD, PAPER, SLIP, TEMPERATURE
from tester.kinds.wheel_on_belt.fit.published import FIT, VALIDATION, errors_on, fitted, of_table_3
from tester.kinds.wheel_on_belt.fit.staged import staged_table_3
from tester.kinds.wheel_on_belt.papers.paper_rows import COMPOUND_NAMES, readable

COLD_C: Final = 25.0
CELSIUS_0_K, GAS_J_MOL_K = 273.15, 8.314
SAME: Final = 0.002
"""Greatest relative difference of a parameter from Table 3's: its last printed digit."""
CLAIMED: Final = 0.05
"""Error that the paper claims."""
CURVE: Final = 0.02
"""Greatest relative difference of two temperature factors on one curve [A]: the last digit of a coefficient of 0.5."""


def words(errors: Errors) -> str:
    """Return errors in words."""
    return (
        f"mean {100.0 * errors.mean:.1f} %, largest {100.0 * errors.largest:.0f} %,"
        f" {errors.near} of {errors.rows} rows within 5 %"
    )


# -- Table 3 ----------------------------------------------------------------------------------------------------------


def _off(name: str, compound: str, reading: Reading = Reading.WITHOUT) -> float:
    result = staged_table_3(appendix(FIT, reading).points)[compound]
    return getattr(result, name) / getattr(COMPOUNDS[compound], name) - 1.0


def _parameters(names: Sequence[str], compounds: Sequence[str]) -> PaperFinding:
    off = {(name, compound): _off(name, compound) for compound in compounds for name in names}
    phrase = ", ".join(f"{name} of {compound} {100.0 * entry:+.2f} %" for (name, compound), entry in off.items())
    return judged(all(abs(entry) <= SAME for entry in off.values()), phrase)


def _open(names: Sequence[str], compounds: Sequence[str]) -> PaperFinding:
    phrase = [
        f"{reading.value}: "
        + ", ".join(
            f"{name} of {entry} {100.0 * _off(name, entry, reading):+.1f} %" for entry in compounds for name in names
        )
        for reading in Reading
    ]
    return unjudged(f"hangs on A027 and A036, which cannot be read. {'; '.join(phrase)} (chosen to give Table 3)")


def _heat_factor() -> PaperFinding:
    result = staged_table_3(appendix(FIT).points)
    off = {
        name: max(
            abs(_relative(result[name], celsius) / _relative(printed, celsius) - 1.0)
            for celsius in np.linspace(25.0, 85.0, 61)
        )
        for name, printed in COMPOUNDS.items()
    }
    phrase = ", ".join(f"{100.0 * entry:.1f} % ({name})" for name, entry in off.items())
    peaks = ", ".join(f"{result[name].tm - printed.tm:+.1f} K" for name, printed in COMPOUNDS.items())
    return judged(max(off.values()) <= CURVE, f"f(T) / f(25) off by at most {phrase}; tm off by {peaks}")


def _relative(table: PaperParameters, celsius: float) -> float:
    return thermal_factor(table, celsius) / thermal_factor(table, COLD_C)


TABLE_3: Final = (
    PaperItem("Table 3", "b2, a2 of 3# and b1 of 2#, fitted factor by factor", "", lambda: _together()),
    PaperItem("Table 3", "b2, a2 of 1# and 2#", "", lambda: _open(("b2", "a2"), ("1#", "2#"))),
    PaperItem("Table 3", "b1 of 1# and 3#", "", lambda: _parameters(("b1",), ("1#", "3#"))),
    PaperItem("Table 3", "a1 of 3#; that of 1# and 2# hangs on b2", "", lambda: _parameters(("a1",), ("3#",))),
    PaperItem("Table 3", "alpha, beta, gamma, tm: the factor of temperature", "", _heat_factor),
)


def _together() -> PaperFinding:
    entry, other = _parameters(("b2", "a2"), ("3#",)), _parameters(("b1",), ("2#",))
    return PaperFinding(max(entry.verdict, other.verdict), f"{entry.error}, {other.error}")


# -- Equations --------------------------------------------------------------------------------------------------------


def _cold(moving: bool) -> dict[str, list[FitPoint]]:
    """Return the rows at 25 degC by compound; ``moving``: without rows at zero slip."""
    subset = [entry for entry in readable() if entry.nominal[TEMPERATURE] == COLD_C]
    return by_group(entry for entry in subset if not moving or entry.nominal[SLIP] > 0.0)


def _linear(
    columns: Callable[[FitPoint], Sequence[float]], y: Callable[[FitPoint], float], subset: Sequence[FitPoint]
) -> Array:
    x = np.array([[*columns(entry)] for entry in subset])
    solution: Array = np.linalg.lstsq(x, np.array([y(entry) for entry in subset]), rcond=None)[0]
    return np.asarray(x @ solution)


def _eq_1() -> PaperFinding:
    off: list[Errors] = []
    for subset in _cold(moving=True).values():
        result = _linear(
            lambda entry: (1.0, log(entry.nominal[LOAD]), log(entry.nominal[SLIP])),
            lambda entry: log(entry.value),
            subset,
        )
        off.append(errors_of([exp(entry) for entry in result.tolist()], [entry.value for entry in subset]))
    still = [subset.value for rows in _cold(moving=False).values() for subset in rows if subset.nominal[SLIP] == 0.0]
    phrase = ", ".join(f"{100.0 * entry.mean:.1f}" for entry in off)
    return judged(
        False,
        f"fitted at 25 degC: mean error {phrase} % (1#, 2#, 3#) where it slips; at 0 mm/s it gives 0, the data"
        f" {min(still):g} to {max(still):g}",
    )


def _eq_2() -> PaperFinding:
    printed: list[int] = []
    off: list[Errors] = []
    for subset in _cold(moving=False).values():
        as_printed = np.array([_quadratic(entry.nominal[LOAD] / 200.0, entry.nominal[SLIP] / 0.3) for entry in subset])
        printed.append(int(np.linalg.matrix_rank(as_printed)))
        meant = _linear(
            lambda entry: _meant(entry.nominal[LOAD] / 200.0, entry.nominal[SLIP] / 0.3),
            lambda entry: entry.value,
            subset,
        )
        off.append(errors_of(meant.tolist(), [entry.value for entry in subset]))
    phrase = ", ".join(f"{100.0 * entry.mean:.1f}" for entry in off)
    return judged(
        False,
        f"as printed p^2 occurs twice: {max(printed)} of 6 coefficients can be told from each other. With a constant"
        f" in place of one, mean error {phrase} % on the rows at 25 degC that were fitted",
    )


def _quadratic(p: float, v: float) -> tuple[float, ...]:
    return p, p * p, v, p * p, p * v, v * v


def _meant(p: float, v: float) -> tuple[float, ...]:
    return 1.0, p, v, p * p, v * v  # p v cannot be resolved: no row at 25 degC varies both


def _eq_3() -> PaperFinding:
    energies: list[float] = []
    for subset in by_group(
        entry for entry in appendix(FIT).points if entry.nominal[LOAD] == 200.0 and entry.nominal[SLIP] == 0.3
    ).values():
        rising = [entry for entry in subset if entry.nominal[TEMPERATURE] <= 70.0]
        x = np.array([1.0 / (entry.nominal[TEMPERATURE] + CELSIUS_0_K) for entry in rising])
        slope = float(np.polyfit(x, np.log([entry.value for entry in rising]), 1)[0])
        energies.append(slope * GAS_J_MOL_K / 1000.0)
    phrase = ", ".join(f"{entry:.1f}" for entry in energies)
    return judged(
        False,
        f"as printed, exp(+E / RT) with E above 0 falls with temperature; up to 70 degC the data want E = {phrase}"
        " kJ/mol (1#, 2#, 3#), and beyond 70 degC the other sign: no such factor has a peak",
    )


def _eq_4() -> PaperFinding:
    off: list[float] = []
    for name, result in staged_table_3(appendix(FIT).points).items():
        subset = [entry for entry in appendix(FIT).points if entry.group == name and entry.nominal[1:] == (200.0, 0.3)]
        cold = next(entry.value for entry in subset if entry.nominal[TEMPERATURE] == COLD_C)
        off += [thermal_factor(result, entry.nominal[TEMPERATURE]) * cold / entry.value - 1.0 for entry in subset]
    largest = max(map(abs, off))
    return judged(
        largest <= CLAIMED, f"fitted to 5 temperatures a compound: largest error {100.0 * largest:.1f} % (4 parameters)"
    )


def _eq_5() -> PaperFinding:
    predicted = fitted(PAPER, appendix(FIT).points)
    cold = [entry for entry in appendix(FIT).points if entry.nominal[TEMPERATURE] == COLD_C]
    heavy = [entry for entry in cold if entry.nominal[LOAD] == 400.0]
    phrase = ", ".join(
        f"{100.0 * (entry.value / value - 1.0):+.0f}" for entry, value in zip(heavy, predicted(heavy), strict=True)
    )
    return judged(
        errors_on(predicted, cold).largest <= CLAIMED,
        f"fitted to appendix A: measured at 400 N and 25 degC {phrase} % off it (1#, 2#, 3#): the load is a factor of"
        " the whole, not of the term of speed",
    )


def _eq_6() -> PaperFinding:
    errors = errors_on(fitted(PAPER, appendix(FIT).points), appendix(VALIDATION).points)
    return judged(errors.near == errors.rows, f"fitted to appendix A, seen on B: {words(errors)}")


def _t_0() -> PaperFinding:
    rows = readable()
    as_it_is = errors_on(of_table_3, rows).mean
    moved = fmean(
        abs(
            coefficient(entry.group, entry.nominal[TEMPERATURE] - COLD_C, entry.nominal[LOAD], entry.nominal[SLIP])
            / entry.value
            - 1.0
        )
        for entry in rows
    )
    phrase = f"Eqs 7 to 9 are {100.0 * moved:.0f} % off the data in the mean, with T itself {100.0 * as_it_is:.1f} %"
    return judged(moved <= as_it_is, phrase)


def _formula(name: str) -> PaperFinding:
    table, rows = COMPOUNDS[name], [entry for entry in readable() if entry.group == name]
    off = 0.0
    for t, p, v in (entry.nominal for entry in rows):
        heat = table.alpha * exp(-table.beta * (t - table.tm) ** 2) + table.gamma
        speed = table.a1 * p**table.b1 * v**table.b2 + table.a2
        off = max(off, abs(heat * speed / coefficient(name, t, p, v) - 1.0))
    printed = thermal_factor(table, 25.0) * (table.a1 * 200.0**table.b1 * 300.0**table.b2 + table.a2)
    return judged(
        off < 1e-9,
        f"the formula to {slight(off)}; as printed with v in mm/s it gives {printed:.0f} at 25 degC, 200 N, 300 mm/s,"
        " with m/s"
        f" {coefficient(name, 25.0, 200.0, 0.3):.3f}. On {len(rows)} rows: {words(errors_on(of_table_3, rows))}",
    )


EQUATIONS: Final = (
    PaperItem("Eq 1", "mu = c1 p^c2 v^c3", "", _eq_1),
    PaperItem("Eq 2", "a quadratic in p and v", "", _eq_2),
    PaperItem("Eq 3", "Arrhenius' rate as the factor of temperature", "", _eq_3),
    PaperItem("Eq 4", "a bell over temperature", "tester fit appendix-a --law paper", _eq_4),
    PaperItem("Eq 5", "a1 p^b1 v^b2 + a2", "tester fit appendix-a --law paper", _eq_5),
    PaperItem("Eq 6", "the product of both, to describe the data", "tester paper", _eq_6),
    PaperItem("4.1", "t is T less 25 degC in the fitted factor", "", _t_0),
    *(
        PaperItem(f"Eq {number}", f"Eq 6 with Table 3 for {name}",
                  f'tester predict --compound "{name}" --slip "300 mm/s" --load "200 N" --temperature "25 degC"',
                  lambda name=name: _formula(name))
        for number, name in zip((7, 8, 9), COMPOUND_NAMES, strict=True)
    ),
)  # fmt: skip
