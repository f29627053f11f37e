"""Equations 1 to 9 and Table 3: as printed, as meant, and as fitted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import exp, log, sqrt
from typing import Final

import numpy as np

from sim.physics.friction import COMPOUNDS, PaperParameters, coefficient, thermal_factor
from tester.analysis.fit.check import Errors, errors_of
from tester.analysis.fit.fit_law import FitPoint, by_group
from tester.analysis.fit.joint import fit_only
from tester.analysis.papers import PaperFinding, PaperItem, PaperVerdict, judged, slight, unjudged
from tester.base.arrays import Array
from tester.kinds.wheel_on_belt.fit.data import Reading, appendix
from tester.kinds.wheel_on_belt.fit.laws import LOAD, PAPER, SLIP, TEMPERATURE
from tester.kinds.wheel_on_belt.fit.published import FIT, VALIDATION, Predicted, by_compound, errors_on, of_table_3
from tester.kinds.wheel_on_belt.fit.staged import staged_table_3
from tester.kinds.wheel_on_belt.papers.digits import (
    COVERAGE,
    HALF_DIGIT,
    digits_u,
    each_once,
    errors_u,
    per_cent_u,
)
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


STAGED: Final = each_once(lambda rows: staged_table_3(rows)[rows[0].group])
"""Table 3 by the paper's way, from rows."""


def _off(names: Sequence[str], points: Sequence[FitPoint]) -> list[float]:
    """Return the relative differences of parameters from Table 3's, compound by compound."""
    result = STAGED(points)
    return [
        getattr(table, name) / getattr(COMPOUNDS[compound], name) - 1.0
        for compound, table in result.items()
        for name in names
    ]


def _of(compounds: Sequence[str], reading: Reading = Reading.WITHOUT) -> list[FitPoint]:
    return [entry for entry in appendix(FIT, reading).points if entry.group in compounds]


def _parameters(names: Sequence[str], compounds: Sequence[str]) -> PaperFinding:
    points = _of(compounds)
    off, u = _off(names, points), digits_u(lambda rows: _off(names, rows), points)
    labels = [f"{name} of {compound}" for compound in compounds for name in names]
    phrase = ", ".join(f"{label} {100.0 * entry:+.2f} %" for label, entry in zip(labels, off, strict=True))
    return judged(all(abs(entry) <= SAME for entry in off), phrase, per_cent_u(u))


def _open(names: Sequence[str], compounds: Sequence[str]) -> PaperFinding:
    labels = [f"{name} of {compound}" for compound in compounds for name in names]
    phrase = [
        f"{reading.value}: "
        + ", ".join(
            f"{label} {100.0 * entry:+.1f} %"
            for label, entry in zip(labels, _off(names, _of(compounds, reading)), strict=True)
        )
        for reading in Reading
    ]
    return unjudged(f"hangs on A027 and A036, which cannot be read. {'; '.join(phrase)} (chosen to give Table 3)")


def _heat_factor() -> PaperFinding:
    points = appendix(FIT).points
    off, peaks = _heat_off(points)[:3], _heat_off(points)[3:]
    u = digits_u(_heat_off, points)
    phrase = ", ".join(f"{100.0 * entry:.1f} % ({name})" for name, entry in zip(COMPOUNDS, off, strict=True))
    kelvins = ", ".join(f"{entry:+.1f} K" for entry in peaks)
    return judged(
        max(off) <= CURVE,
        f"f(T) / f(25) off by at most {phrase}; tm off by {kelvins}",
        f"{per_cent_u(u[:3])}; {', '.join(f'{entry:.1f}' for entry in u[3:])} K",
    )


def _heat_off(points: Sequence[FitPoint]) -> list[float]:
    """Return each compound's greatest difference of the factor, as a share, then each one's of tm in K."""
    result = STAGED(points)
    off = [
        max(
            abs(_relative(table, celsius) / _relative(COMPOUNDS[name], celsius) - 1.0)
            for celsius in np.linspace(25.0, 85.0, 61)
        )
        for name, table in result.items()
    ]
    return [*off, *(table.tm - COMPOUNDS[name].tm for name, table in result.items())]


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
    both = entry.verdict is other.verdict is PaperVerdict.REPRODUCED
    return judged(both, f"{entry.error}, {other.error}", f"{entry.u}, {other.u}")


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
    off: list[float] = []
    u: list[float] = []
    for subset in _cold(moving=True).values():
        off += _power_law(subset)
        u += digits_u(_power_law, subset)
    still = [subset.value for rows in _cold(moving=False).values() for subset in rows if subset.nominal[SLIP] == 0.0]
    phrase = ", ".join(f"{100.0 * entry:.1f}" for entry in off)
    return judged(
        False,
        f"fitted at 25 degC: mean error {phrase} % (1#, 2#, 3#) where it slips; at 0 mm/s it gives 0, the data"
        f" {min(still):g} to {max(still):g}",
        f"{per_cent_u(u)}; {COVERAGE / sqrt(3.0) * HALF_DIGIT:.3f}",
    )


def _power_law(subset: Sequence[FitPoint]) -> list[float]:
    result = _linear(
        lambda entry: (1.0, log(entry.nominal[LOAD]), log(entry.nominal[SLIP])),
        lambda entry: log(entry.value),
        subset,
    )
    return [errors_of([exp(entry) for entry in result.tolist()], [entry.value for entry in subset]).mean]


def _quadratic_law(subset: Sequence[FitPoint]) -> list[float]:
    meant = _linear(
        lambda entry: _meant(entry.nominal[LOAD] / 200.0, entry.nominal[SLIP] / 0.3),
        lambda entry: entry.value,
        subset,
    )
    return [errors_of(meant.tolist(), [entry.value for entry in subset]).mean]


def _eq_2() -> PaperFinding:
    printed: list[int] = []
    off: list[float] = []
    u: list[float] = []
    for subset in _cold(moving=False).values():
        as_printed = np.array([_quadratic(entry.nominal[LOAD] / 200.0, entry.nominal[SLIP] / 0.3) for entry in subset])
        printed.append(int(np.linalg.matrix_rank(as_printed)))
        off += _quadratic_law(subset)
        u += digits_u(_quadratic_law, subset)
    phrase = ", ".join(f"{100.0 * entry:.1f}" for entry in off)
    return judged(
        False,
        f"as printed p^2 occurs twice: {max(printed)} of 6 coefficients can be told from each other. With a constant"
        f" in place of one, mean error {phrase} % on the rows at 25 degC that were fitted",
        f"0 of the count; {per_cent_u(u)}",
    )


def _quadratic(p: float, v: float) -> tuple[float, ...]:
    return p, p * p, v, p * p, p * v, v * v


def _meant(p: float, v: float) -> tuple[float, ...]:
    return 1.0, p, v, p * p, v * v  # p v cannot be resolved: no row at 25 degC varies both


def _eq_3() -> PaperFinding:
    rising = [
        entry for entry in appendix(FIT).points
        if entry.nominal[1:] == (200.0, 0.3) and entry.nominal[TEMPERATURE] <= 70.0
    ]  # fmt: skip
    phrase = ", ".join(f"{entry:.1f}" for entry in _energies(rising))
    u = ", ".join(f"{entry:.1f}" for entry in digits_u(_energies, rising))
    return judged(
        False,
        f"as printed, exp(+E / RT) with E above 0 falls with temperature; up to 70 degC the data want E = {phrase}"
        " kJ/mol (1#, 2#, 3#), and beyond 70 degC the other sign: no such factor has a peak",
        f"{u} kJ/mol",
    )


def _energies(points: Sequence[FitPoint]) -> list[float]:
    """Return each compound's E in kJ/mol."""
    result: list[float] = []
    for subset in by_group(points).values():
        x = np.array([1.0 / (entry.nominal[TEMPERATURE] + CELSIUS_0_K) for entry in subset])
        slope = float(np.polyfit(x, np.log([entry.value for entry in subset]), 1)[0])
        result.append(slope * GAS_J_MOL_K / 1000.0)
    return result


def _eq_4() -> PaperFinding:
    off: list[float] = []
    for name, result in STAGED(appendix(FIT).points).items():
        subset = [entry for entry in appendix(FIT).points if entry.group == name and entry.nominal[1:] == (200.0, 0.3)]
        cold = next(entry.value for entry in subset if entry.nominal[TEMPERATURE] == COLD_C)
        off += [thermal_factor(result, entry.nominal[TEMPERATURE]) * cold / entry.value - 1.0 for entry in subset]
    largest = max(map(abs, off))
    return judged(
        largest <= CLAIMED, f"fitted to 5 temperatures a compound: largest error {100.0 * largest:.1f} % (4 parameters)"
    )


def _eq_5() -> PaperFinding:
    points = appendix(FIT).points
    cold = [entry for entry in points if entry.nominal[TEMPERATURE] == COLD_C]
    phrase = ", ".join(f"{100.0 * entry:+.0f}" for entry in _heavy(points))
    return judged(
        errors_on(eq_6(points), cold).largest <= CLAIMED,
        f"fitted to appendix A: measured at 400 N and 25 degC {phrase} % off it (1#, 2#, 3#): the load is a factor of"
        " the whole, not of the term of speed",
        per_cent_u(digits_u(_heavy, points)),
    )


_EQ_6: Final = each_once(lambda rows: fit_only(PAPER, rows[0].group, rows))


def eq_6(points: Sequence[FitPoint]) -> Predicted:
    """Return the predictions of Eq 6, fitted to rows with all parameters at once."""
    return by_compound(PAPER, _EQ_6(points))


def _heavy(points: Sequence[FitPoint]) -> list[float]:
    """Return how far the coefficients at 25 degC and 400 N are off Eq 6, which is fitted to the rows."""
    heavy = [entry for entry in points if entry.nominal[TEMPERATURE] == COLD_C and entry.nominal[LOAD] == 400.0]
    return [entry.value / value - 1.0 for entry, value in zip(heavy, eq_6(points)(heavy), strict=True)]


def _eq_6() -> PaperFinding:
    a, b = appendix(FIT).points, appendix(VALIDATION).points
    errors = errors_on(eq_6(a), b)

    def sizes(points: Sequence[FitPoint]) -> list[float]:
        result = errors_on(eq_6(points), b)
        return [result.mean, result.largest]

    of_fit = per_cent_u(digits_u(sizes, a))
    return judged(
        errors.near == errors.rows,
        f"fitted to appendix A, seen on B: {words(errors)}",
        f"by A {of_fit}; by B {errors_u(eq_6(a), b)}",
    )


def _t_0() -> PaperFinding:
    def means(points: Sequence[FitPoint]) -> list[float]:
        return [errors_on(colder, points).mean, errors_on(of_table_3, points).mean]

    def colder(points: Sequence[FitPoint]) -> list[float]:
        return of_table_3([replace(entry, measured=_less_25(entry), nominal=_less_25(entry)) for entry in points])

    rows = readable()
    moved, as_it_is = means(rows)
    phrase = f"Eqs 7 to 9 are {100.0 * moved:.0f} % off the data in the mean, with T itself {100.0 * as_it_is:.1f} %"
    return judged(moved <= as_it_is, phrase, per_cent_u(digits_u(means, rows)))


def _less_25(entry: FitPoint) -> tuple[float, ...]:
    return entry.nominal[TEMPERATURE] - COLD_C, *entry.nominal[1:]


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
