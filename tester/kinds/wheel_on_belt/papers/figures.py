"""Figures 6 to 11, 14 and 15: their printed values and trends, and the values of Eqs 7 to 9."""

from __future__ import annotations

from math import sqrt
from typing import Final

from sim.physics.slip import predict
from tester.analysis.fit.check import errors_of
from tester.analysis.papers import PaperFinding, PaperItem, judged, not_attempted
from tester.kinds.wheel_on_belt.fit.data import READABLE, rows
from tester.kinds.wheel_on_belt.fit.laws import LOAD, SLIP
from tester.kinds.wheel_on_belt.fit.published import errors_on, of_table_3
from tester.kinds.wheel_on_belt.papers.digits import COVERAGE, HALF_DIGIT, errors_u
from tester.kinds.wheel_on_belt.papers.equations import words
from tester.kinds.wheel_on_belt.papers.paper_rows import (
    by_compound_words,
    over_load,
    over_slip,
    peaks,
    steps,
)

DRAWS: Final = "tester figure RUN --law paper"
NEARLY: Final = 0.95
"""Least share of steps or series that follow a stated trend [A]: scatter may spoil one value in twenty."""


def _trend(variable: int, up: bool) -> PaperFinding:
    subset = over_load() if variable == LOAD else over_slip()
    agree, count = steps(subset, variable, up)
    return judged(
        agree >= NEARLY * count,
        f"{agree} of {count} steps in the data; Eqs 7 to 9, the twin's law, {by_compound_words(subset)}",
    )


def _sideslip() -> PaperFinding:
    cold = [row for row in rows("appendix-a") if row["quality"] in READABLE and float(row["angle_deg"]) > 0.0]
    measured = [float(row["mu"]) for row in cold]
    predicted = [
        predict(
            row["formula"],
            1e-3 * float(row["slip_mm_s"]),
            float(row["load_N"]),
            float(row["temp_C"]),
            float(row["angle_deg"]),
        )
        for row in cold
    ]
    rising = sum(
        b > a for a, b, row in zip(measured, measured[1:], cold[1:], strict=False) if float(row["angle_deg"]) > 10.0
    )
    steps_there = sum(float(row["angle_deg"]) > 10.0 for row in cold)
    errors = errors_of(predicted, measured)
    return judged(
        rising == steps_there,
        f"{rising} of {steps_there} steps at 25 degC rise (1#, 2#); the twin, with the slip as a vector and a factor"
        f" of 1# fitted to these rows, {words(errors)}. Above 25 degC the paper prints no values",
    )


def _sideslip_3() -> PaperFinding:
    subset = {
        name: [row["mu"] for row in rows("appendix-a") if row["formula"] == name and float(row["angle_deg"])]
        for name in ("2#", "3#")
    }
    straight = next(
        float(row["mu"]) for row in rows("appendix-a")
        if row["formula"] == "3#" and (row["slip_mm_s"], row["load_N"], row["temp_C"]) == ("300", "200", "25")
    )  # fmt: skip
    same = subset["2#"] == subset["3#"]
    return judged(
        not same,
        f"the values are those of 2# ({', '.join(subset['3#'])}), below {straight:g} of 3# at 0 degrees: copied",
        f"{COVERAGE / sqrt(3.0) * HALF_DIGIT:.3f} of each",
    )


def _peaked(variable: int) -> PaperFinding:
    result, count, others = peaks(over_load() if variable == LOAD else over_slip())
    odd = f"; not {', '.join(others)}" if others else ""
    return judged(
        result >= NEARLY * count, f"{result} of {count} series that reach 85 degC are largest at 70 degC{odd}"
    )


def _model(variable: int) -> PaperFinding:
    from tester.kinds.wheel_on_belt.fit.data import appendix

    subset = [entry for entry in appendix("appendix-b").points if (entry.nominal[SLIP] == 0.3) is (variable == LOAD)]
    errors = errors_on(of_table_3, subset)
    phrase = f"Eqs 7 to 9 on the rows of appendix B: {words(errors)}"
    return judged(errors.near == errors.rows, phrase, errors_u(of_table_3, subset))


FIGURES: Final = (
    PaperItem("Fig 6", "mu falls with load at every temperature", DRAWS, lambda: _trend(LOAD, up=False)),
    PaperItem("Fig 7", "mu rises with slip velocity at every temperature", DRAWS, lambda: _trend(SLIP, up=True)),
    PaperItem("Fig 8", "mu rises with the sideslip angle", DRAWS, _sideslip),
    PaperItem("Fig 8c", "the same for 3#", "tester fit appendix-a", _sideslip_3),
    PaperItem("Fig 9", "at every load mu rises to about 70 degC, then falls", DRAWS, lambda: _peaked(LOAD)),
    PaperItem("Fig 10", "the same at every slip velocity", DRAWS, lambda: _peaked(SLIP)),
    not_attempted(
        "Fig 11", "the same at every sideslip angle", "no value above 25 degC is printed, and curves are not read off"
    ),
    PaperItem("Fig 14", "model beside data over temperature, by load", DRAWS, lambda: _model(LOAD)),
    PaperItem("Fig 15", "model beside data over temperature, by slip velocity", DRAWS, lambda: _model(SLIP)),
)
