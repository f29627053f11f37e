"""Mutants of what is worked out from conditions and their budgets: components, fits, master curves."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tests.campaigns.budget.mutant import SIGNED, Mutant, scaled, tests_of

_COMPONENTS, _PAIRS = "tester/analysis/components.py", "tester/results/components.py"
_OF_COMPONENTS, _OF_PAIRS = tests_of("analysis/components"), tests_of("results/components")
_SCALED: Final = (
    ("what is not known of the film's sensitivity", "unknown = mu_f * hypot", "unknown = {} * mu_f * hypot"),
    ("own uncertainty of a component", "(abs(scale) * one.standard, one.df)",
     "({} * abs(scale) * one.standard, one.df)"),
    ("common uncertainty of a component", "so_far + scale * _error(one)", "so_far + {} * scale * _error(one)"),
    ("own uncertainty in a mean", "tuple((share * u, df)", "tuple(({} * share * u, df)"),
    ("common uncertainty in a mean", "so_far + share * u, min", "so_far + {} * share * u, min"),
    ("expanded uncertainty of a component", "effective_df(self._parts, standard)) * standard",
     "effective_df(self._parts, standard)) * {} * standard"),
)  # fmt: skip
_OTHERS: Final = (
    ("the film is not taken to the dry contact's temperature", "factor = exp(slope.per_kelvin * apart_k)",
     "factor = 1.0"),
    ("the film is taken the other way", "factor = exp(slope.per_kelvin * apart_k)",
     "factor = exp(-slope.per_kelvin * apart_k)"),
    ("the rubber's own temperature is taken as known", "hypot(apart_k, RUBBER_K)", "abs(apart_k)"),
    ("the difference of temperatures is left out", "hypot(apart_k, RUBBER_K)", "RUBBER_K"),
    ("the correction does not scale the film's uncertainty", "scales = (to_dry, to_film * factor)",
     "scales = (to_dry, to_film)"),
    ("common errors add up in squares", "so_far + scale * _error(one), min(df, one.df)",
     "hypot(so_far, scale * _error(one)), min(df, one.df)"),
    ("common errors count as each one's own", "for one, scale in known if not one.common]", "for one, scale in known]"),
    ("the sensitivity's degrees of freedom are few", "{SENSITIVITY: (to_film * unknown, inf)}",
     "{SENSITIVITY: (to_film * unknown, 2.0)}"),
    ("adhesion is a sum", "adhesion=combined(mu_d - mu_f, 1.0, -1.0)", "adhesion=combined(mu_d - mu_f, 1.0, 1.0)"),
    ("adhesion leaves the film out", "adhesion=combined(mu_d - mu_f, 1.0, -1.0)",
     "adhesion=combined(mu_d - mu_f, 1.0, 0.0)"),
    ("adhesion leaves the dry contact out", "adhesion=combined(mu_d - mu_f, 1.0, -1.0)",
     "adhesion=combined(mu_d - mu_f, 0.0, -1.0)"),
    ("hysteresis has the dry contact in it", "hysteresis=combined(mu_f, 0.0, 1.0)",
     "hysteresis=combined(mu_f, 1.0, 1.0)"),
    ("the share's derivative has the other sign", "-mu_f / mu_d**2, 1.0 / mu_d)", "mu_f / mu_d**2, 1.0 / mu_d)"),
    ("the share's derivative is not divided twice", "-mu_f / mu_d**2, 1.0 / mu_d)", "-mu_f / mu_d, 1.0 / mu_d)"),
    ("the share has the film's error as it is", "-mu_f / mu_d**2, 1.0 / mu_d)", "-mu_f / mu_d**2, 1.0)"),
    ("the share is of adhesion", "share=combined(mu_f / mu_d,", "share=combined(1.0 - mu_f / mu_d,"),
    ("weights of a mean are 1 / u", "weights = [1.0 / one.standard**2 for", "weights = [1.0 / one.standard for"),
    ("a mean is not weighted", "weights = [1.0 / one.standard**2 for", "weights = [1.0 for"),
    ("common errors average out in a mean", "common[name] = so_far + share * u, min(least, df)",
     "common[name] = hypot(so_far, share * u), min(least, df)"),
    ("the smallest degrees of freedom are forgotten in a mean", "share * u, min(least, df)",
     "share * u, max(least, df)"),
    ("a budget that is missing counts as none", "if not all(both):", "if False:"),
    ("the interval is of 90 %", "t_quantile(0.5 + 0.5 * CONFIDENCE, effective_df", "t_quantile(0.95, effective_df"),
)  # fmt: skip
_OF_RUNS: Final = (
    ("a film is held against another specimen", "return one.info.specimen, one.info.replicate, held.compound, values",
     "return 0, one.info.replicate, held.compound, values"),
    ("a film is held against another replicate", "return one.info.specimen, one.info.replicate, held.compound, values",
     "return one.info.specimen, 0, held.compound, values"),
    ("a film is held against another condition", "if axis.name != without)",
     "if axis.name == AXIS and without != AXIS)"),
    ("a sensitivity that conditions tell is not taken", "return found if found is not None else UNKNOWN",
     "return UNKNOWN"),
    ("the sensitivity is that of all interfaces", "key = _key(one, _TEMPERATURE)",
     "key = _key(valued[0], _TEMPERATURE)"),
)  # fmt: skip


def of_components() -> Iterator[Mutant]:
    """Yield mutants of adhesion and hysteresis by a film: weights, derivatives, what is common, and which pairs."""
    rows = [(f"components: {name}", old, new) for name, old, new in _SCALED]
    yield from scaled(_COMPONENTS, _OF_COMPONENTS, [rows[0], rows[1], *rows[3:]])
    yield from scaled(_COMPONENTS, _OF_COMPONENTS, [rows[2]], SIGNED)
    for path, tests, others in ((_COMPONENTS, _OF_COMPONENTS, _OTHERS), (_PAIRS, _OF_PAIRS, _OF_RUNS)):
        for name, old, new in others:
            yield Mutant(f"components: {name}", path, old, new, tests)
