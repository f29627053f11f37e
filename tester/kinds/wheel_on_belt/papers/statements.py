"""Statements of the paper in words: numbers of its text, errors that it quotes, its appendices, its conclusions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from math import log
from typing import Final

from sim.physics.friction import coefficient
from tester.analysis.fit.fit_law import FitPoint, by_group
from tester.analysis.fit.joint import fit_only, predict
from tester.analysis.papers import PaperFinding, PaperItem, judged, not_attempted, unjudged
from tester.kinds.wheel_on_belt.fit.data import READABLE, Reading, appendix, rows
from tester.kinds.wheel_on_belt.fit.laws import V2_LAW
from tester.kinds.wheel_on_belt.fit.master_conditions import MASTERS
from tester.kinds.wheel_on_belt.fit.published import (
    FIT,
    QUOTED,
    VALIDATION,
    Quoted,
    errors_on,
    of_table_3,
    quoted_rows,
    scaled,
)
from tester.kinds.wheel_on_belt.image.axes import AXES
from tester.kinds.wheel_on_belt.papers.digits import digits_u, errors_u, fit_u, per_cent_u
from tester.kinds.wheel_on_belt.papers.equations import CLAIMED, words
from tester.kinds.wheel_on_belt.papers.paper_rows import (
    COMPOUND_NAMES,
    at,
    bias,
    over_load,
    over_slip,
    readable,
)

PRINTED_2: Final[Mapping[str, float]] = {"A009": 0.65, "A010": 0.48, "A012": 0.35}
PRINTED_1: Final[Mapping[str, float]] = {"B001": 0.96, "A005": 0.78, "B009": 0.60}
"""Coefficients of section 3.1 by the row that should have them."""
STATED_PEAK_C: Final = 70.0
NEAR_PEAK_K: Final = 5.0
"""Tolerance of "about 70 degC" [A]."""
QUOTED_WITHIN: Final = 0.01
"""Tolerance of a quoted error: both coefficients have two decimals, and half of the last is 0.5 % each."""


def _named(printed: Mapping[str, float]) -> PaperFinding:
    result = {row["row_id"]: row for name in (FIT, VALIDATION) for row in rows(name)}
    off = max(abs(float(result[label]["mu"]) - value) for label, value in printed.items())
    helped = [label for label in printed if result[label]["quality"] != "ok"]
    note = f"; {', '.join(helped)} was read with the help of this sentence" if helped else ""
    return judged(off < 0.005, f"rows {', '.join(printed)} differ by {off:.2f}{note}")


def _interaction() -> PaperFinding:
    phrase: list[str] = []
    stronger = 0
    for name in COMPOUND_NAMES:
        light, heavy = (
            {entry.nominal[0]: entry.value for entry in at(over_load(), name, load=load)} for load in (100.0, 400.0)
        )
        common = sorted(set(light) & set(heavy))
        spans = [(max(subset[t] for t in common), min(subset[t] for t in common)) for subset in (light, heavy)]
        (most, least), (most_4, least_4) = spans
        stronger += most - least > most_4 - least_4
        phrase.append(
            f"{name} {most - least:.2f} and {most_4 - least_4:.2f} (in shares {100.0 * (most / least - 1.0):.0f} % and"
            f" {100.0 * (most_4 / least_4 - 1.0):.0f} %)"
        )
    return judged(stronger == len(phrase), f"mu changes over temperature at 100 N and 400 N by {', '.join(phrase)}")


def _bias_at(
    stated: str, compound: str, *, celsius: float | None = None, load: float | None = None, slip: float | None = None,
    of_slip: bool = False,
) -> PaperFinding:  # fmt: skip
    """Judge "above" or "below" the model by the mean of the rows, "near" and "gap" by their mean error and 5 %."""
    subset = at(over_slip() if of_slip else over_load(), compound, celsius=celsius, load=load, slip=slip)
    result, spread = bias(subset), errors_on(of_table_3, subset)
    holds = {"above": result > 0.0, "below": result < 0.0, "near": spread.mean <= CLAIMED, "gap": spread.mean > CLAIMED}
    return judged(
        holds[stated],
        f"data {100.0 * result:+.1f} % off Eqs 7 to 9 in the mean of {len(subset)} rows; mean error"
        f" {100.0 * spread.mean:.1f} %, largest {100.0 * spread.largest:.0f} %",
    )


def _better() -> PaperFinding:
    celsius = (40.0, 55.0, 70.0, 85.0)

    def means(points: Sequence[FitPoint]) -> list[float]:
        return [errors_on(of_table_3, at(points, "1#", celsius=one)).mean for one in celsius]

    points = at(over_load(), "1#")
    off = dict(zip(celsius, means(points), strict=True))
    phrase = ", ".join(f"{100.0 * entry:.1f} % at {one:g} degC" for one, entry in off.items())
    return judged(
        max(off[55.0], off[70.0]) < min(off[40.0], off[85.0]),
        f"mean error {phrase}",
        per_cent_u(digits_u(means, points)),
    )


def _others_3() -> PaperFinding:
    subset = [entry for entry in at(over_load(), "3#") if entry.nominal[1] != 300.0]
    errors = errors_on(of_table_3, subset)
    return judged(errors.near == errors.rows, words(errors), errors_u(of_table_3, subset))


def _few_below(compound: str, celsius: float, of_slip: bool) -> PaperFinding:
    subset = at(over_slip() if of_slip else over_load(), compound, celsius=celsius)
    below = sum(entry.value < value for entry, value in zip(subset, of_table_3(subset), strict=True))
    return judged(
        below > 0, f"{below} of {len(subset)} rows are below Eqs 7 to 9; {100.0 * bias(subset):+.1f} % in the mean"
    )


def _log_at_v() -> PaperFinding:
    refusals = [MASTERS.packaged(name).refusal for name in (FIT, VALIDATION)]
    reason = next((entry for entry in reversed(refusals) if entry), "")
    return unjudged(f"of unfilled rubber, without data. The paper's own data make no such curve: {reason}")


def _quoted(quoted: Sequence[Quoted], of_scaled: bool) -> PaperFinding:
    subset = quoted_rows(quoted)
    if not of_scaled:
        off = [abs(entry) for entry in _each_off(subset)]
        u = per_cent_u(digits_u(_each_off, subset))
        return judged(_as_quoted(off, quoted), f"{_per_cent(off)} by Eq 7", u)
    ways = {reading: scaled(subset, reading) for reading in Reading}
    result = {
        reading: [abs(values[entry.label] / entry.value - 1.0) for entry in subset]
        for reading, values in ways.items()
        if values
    }
    if Reading.WITHOUT in result:
        return judged(_as_quoted(result[Reading.WITHOUT], quoted), _per_cent(result[Reading.WITHOUT]))
    phrase = "; ".join(f"{_per_cent(off)} {reading.value}" for reading, off in result.items())
    return unjudged(f"needs A027, which cannot be read: {phrase} (chosen to give these)")


def _each_off(points: Sequence[FitPoint]) -> list[float]:
    return [value / entry.value - 1.0 for entry, value in zip(points, of_table_3(points), strict=True)]


def _as_quoted(off: Sequence[float], quoted: Sequence[Quoted]) -> bool:
    return all(
        abs(entry - 0.01 * float(printed_error.printed)) <= QUOTED_WITHIN
        for entry, printed_error in zip(off, quoted, strict=True)
    )


def _per_cent(off: Sequence[float]) -> str:
    return ", ".join(f"{100.0 * entry:.1f}" for entry in off) + " %"


def _within() -> PaperFinding:
    errors = errors_on(of_table_3, appendix(VALIDATION).points)
    phrase = f"Eqs 7 to 9 on appendix B: {words(errors)}"
    return judged(errors.near == errors.rows, phrase, errors_u(of_table_3, appendix(VALIDATION).points))


def _appendix_a() -> PaperFinding:
    counted = Counter(row["quality"] for row in rows(FIT))
    phrase = ", ".join(f"{count} {quality}" for quality, count in counted.items())
    return judged(
        counted["suspect"] + counted["inferred"] == 0,
        f"{phrase}; without repeated rows and sideslip {len(appendix(FIT).points)} are fitted. As text it was read by"
        " machine: columns drift",
        "0 of a count",
    )


def _appendix_b() -> PaperFinding:
    counted = Counter(row["quality"] for row in rows(VALIDATION))
    phrase = ", ".join(f"{count} {quality}" for quality, count in counted.items())
    return judged(
        counted["suspect"] + counted["missing"] == 0,
        f"{phrase}; {len(appendix(VALIDATION).points)} are held against laws",
        "0 of a count",
    )


def _largest() -> PaperFinding:
    from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES

    top = max(
        (float(row["mu"]), row["row_id"])
        for name in (FIT, VALIDATION)
        for row in rows(name)
        if row["quality"] in READABLE
    )
    bar = next(entry for entry in QUANTITIES.channels if entry.name == "friction").screen
    assert bar is not None
    return judged(bar.high.offset >= top[0], f"{top[0]:g} (row {top[1]}); the screen's bar ends at {bar.high.offset:g}")


def _peak() -> PaperFinding:
    result = {name: fit_only(V2_LAW, name, subset)[2] for name, subset in by_group(readable()).items()}
    phrase = ", ".join(f"{celsius - STATED_PEAK_C:+.1f}" for celsius in result.values())
    return judged(
        max(abs(entry - STATED_PEAK_C) for entry in result.values()) <= NEAR_PEAK_K,
        f"v2 fitted to both appendices peaks {phrase} K from 70 degC (1#, 2#, 3#)",
    )


def _exponents(variable: int, sign: float) -> PaperFinding:
    result: dict[str, float] = {}
    for name, subset in by_group(readable()).items():
        parameters = fit_only(V2_LAW, name, subset)
        low, high = (_moved(subset[0], variable, factor) for factor in (0.999, 1.001))
        a, b = predict(V2_LAW, parameters, [low, high])
        result[name] = log(b / a) / log(1.001 / 0.999)
    phrase = ", ".join(f"{entry:+.2f}" for entry in result.values())
    return judged(
        all(sign * entry > 0.0 for entry in result.values()),
        f"exponents {phrase} at 25 degC, 200 N, 300 mm/s (v2, 1#, 2#, 3#)",
    )


def _moved(like: FitPoint, variable: int, factor: float) -> FitPoint:
    at_usual = [25.0, 200.0, 0.3]
    at_usual[variable] *= factor
    setting = tuple(at_usual)
    return FitPoint("", like.group, setting, setting, 1.0, like.source)


def _paper_exponent() -> PaperFinding:
    low, high = (coefficient("1#", 25.0, 200.0 * factor, 0.3) for factor in (0.999, 1.001))
    of_paper = log(high / low) / log(1.001 / 0.999)
    subset = by_group(readable())["1#"]
    parameters = fit_only(V2_LAW, "1#", subset)
    of_data = _of_load(parameters, subset)
    u = fit_u(V2_LAW, parameters, subset, lambda moved: _of_load(moved, subset))
    return judged(
        abs(of_paper / of_data - 1.0) <= 0.1,
        f"Eq 7 falls with the load to the power {of_paper:+.2f}, the data of 1# to {of_data:+.2f}: a run on the twin,"
        " which rubs by Eq 7, shows the first",
        f"{u:.3f} of the second",
    )


def _of_load(parameters: Sequence[float], points: Sequence[FitPoint]) -> float:
    """Return the exponent of the load of v2 with a compound's parameters."""
    a, b = predict(V2_LAW, parameters, [_moved(points[0], 1, factor) for factor in (0.999, 1.001)])
    return log(b / a) / log(1.001 / 0.999)


def _variables() -> PaperFinding:
    axes = ", ".join(axis.name for axis in AXES if axis.name in ("temperature", "slip_velocity", "load"))
    return unjudged(f"{axes} are axes, formula and abrasive keys of a recipe; no test of the paper has a frequency")


TEXT: Final = (
    PaperItem("3.1", "2# at 25 degC: 0.65, 0.48, 0.35 at 100, 200, 400 N", "", lambda: _named(PRINTED_2)),
    PaperItem("3.1", "1# at 40 degC: 0.96, 0.78, 0.60 at 100, 200, 400 N", "", lambda: _named(PRINTED_1)),
    PaperItem("3.1", "temperature matters more at low load", "", _interaction),
    PaperItem("4.1", "mu over log aT v is a bell (of others' unfilled rubber)", "tester master appendix-b", _log_at_v),
    PaperItem("4.2.1", "1# at 40 degC lies slightly above the model", "",
              lambda: _bias_at("above", "1#", celsius=40.0)),
    PaperItem("4.2.1", "1# at 85 degC lies slightly below", "", lambda: _bias_at("below", "1#", celsius=85.0)),
    PaperItem("4.2.1", "1# agrees better at 55 and 70 degC than at 40 and 85", "", _better),
    PaperItem("4.2.1", "some of 2# at 40 degC lie below", "", lambda: _few_below("2#", 40.0, of_slip=False)),
    PaperItem("4.2.1", "some of 2# at 55 degC lie below", "", lambda: _few_below("2#", 55.0, of_slip=False)),
    PaperItem("4.2.1", "3# at 300 N has a gap to the model", "", lambda: _bias_at("gap", "3#", load=300.0)),
    PaperItem("4.2.1", "3# agrees at the other loads", "", _others_3),
    *(
        PaperItem("4.2.2", f"{name} at 100 mm/s has a gap to the model", "",
                  lambda name=name: _bias_at("gap", name, slip=0.1, of_slip=True))
        for name in COMPOUND_NAMES
    ),
    PaperItem("4.2.2", "1# at 40 degC lies slightly above", "",
              lambda: _bias_at("above", "1#", celsius=40.0, of_slip=True)),
    PaperItem("4.2.2", "1# agrees at 55 degC", "", lambda: _bias_at("near", "1#", celsius=55.0, of_slip=True)),
    PaperItem("4.2.2", "1# agrees at 85 degC", "", lambda: _bias_at("near", "1#", celsius=85.0, of_slip=True)),
    PaperItem("4.2.2", "2# at 55 degC lies slightly below", "",
              lambda: _bias_at("below", "2#", celsius=55.0, of_slip=True)),
    PaperItem("4.2.2", "some of 3# at 70 degC lie below", "", lambda: _few_below("3#", 70.0, of_slip=True)),
    not_attempted("4.2", "why: belt tension, debris, softening, wear, order of the tests",
                  "nothing printed tells one from another; the rig has no sensor of the belt's tension"),
)  # fmt: skip
ERRORS: Final = tuple(
    PaperItem("4.2", f"errors of 1# at {where}: {', '.join(entry.printed for entry in quoted)} %{way}", "tester paper",
              lambda quoted=quoted, of_scaled=of_scaled: _quoted(quoted, of_scaled))
    for where, quoted in QUOTED.items()
    for way, of_scaled in (("", False), (", as a value measured at 25 degC times f(T)", True))
)  # fmt: skip
APPENDICES_ITEMS: Final = (
    PaperItem("Appendix A", "57 rows", "tester fit appendix-a", _appendix_a),
    PaperItem("Appendix B", "84 rows", "tester fit appendix-b", _appendix_b),
    PaperItem("Appendix B", "the largest coefficient", "tester tui", _largest),
)
CONCLUSIONS: Final = (
    PaperItem(
        "5 (1)", "tests over temperature, slip, load, frequency, formula, road", "tester schema --of recipe", _variables
    ),
    PaperItem("5 (2)", "mu falls with load", "tester fit appendix-a appendix-b", lambda: _exponents(1, -1.0)),
    PaperItem("5 (2)", "... as steeply as by the model (1#)", "tester fit appendix-a appendix-b", _paper_exponent),
    PaperItem("5 (2)", "mu rises with slip velocity", "tester fit appendix-a appendix-b", lambda: _exponents(2, 1.0)),
    PaperItem("3.4, 4.1, 5 (2)", "mu peaks at about 70 degC", "tester fit appendix-a appendix-b", _peak),
    not_attempted("5 (2)", "why: adhesion rises, hysteresis falls", "coefficients alone do not separate the two"),
    PaperItem("Abstract, 4.2, 5 (3)", "errors within 5 %", "tester paper", _within),
)
