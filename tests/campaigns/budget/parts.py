"""Mutants of results derived from conditions and their budgets: components, fits, master curves."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tests.campaigns.budget.mutant import Mutant, scaled, tests_of

_COMPONENTS, _PAIRS = "tester/analysis/components.py", "tester/results/components_table.py"
_OF_COMPONENTS, _OF_PAIRS = tests_of("analysis/components"), tests_of("results/components_table")
_SCALED: Final = (
    ("what is not known of the film's sensitivity", "unknown = mu_f * hypot", "unknown = {} * mu_f * hypot"),
    ("own uncertainty of a component", "(abs(scale) * term.standard, term.df)",
     "({} * abs(scale) * term.standard, term.df)"),
    ("common uncertainty of a component", "so_far + scale * term.error", "so_far + {} * scale * term.error"),
    ("own uncertainty in a mean", "independent = [\n        (share * u, df)", "independent = [({} * share * u, df)"),
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
    ("common errors add up in squares", "so_far + scale * term.error, min(df, term.df)",
     "hypot(so_far, scale * term.error), min(df, term.df)"),
    ("common errors count as each one's own", "for term, scale in scaled if not term.common]",
     "for term, scale in scaled]"),
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
    ("the share is of adhesion", "share=combined(mu_f / mu_d,",
     "share=combined(1.0 - mu_f / mu_d,"),
    ("weights of a mean are 1 / u", "1.0 / (value_of_rig.standard**2 + apart**2) for",
     "1.0 / value_of_rig.standard for"),
    ("a mean is not weighted", "1.0 / (value_of_rig.standard**2 + apart**2) for", "1.0 for"),
    ("what conditions truly differ by does not weigh", "value_of_rig.standard**2 + apart**2)",
     "value_of_rig.standard**2)"),
    ("... and is no uncertainty of their mean", "if apart > 0.0:", "if False:"),
    ("equal weights leave what conditions differ by", "(share - 1.0 / len(shares)) ** 2", "share**2"),
    ("chance makes conditions differ", "scatter - (len(values) - 1)", "scatter"),
    ("common errors average out in a mean", "common[name] = so_far + share * u, min(least, df)",
     "common[name] = hypot(so_far, share * u), min(least, df)"),
    ("the smallest degrees of freedom are forgotten in a mean", "share * u, min(least, df)",
     "share * u, max(least, df)"),
    ("a budget that is missing counts as none", "if not all(both):", "if False:"),
    ("the interval is of 90 %", "t_quantile(0.5 + 0.5 * CONFIDENCE, effective_df", "t_quantile(0.95, effective_df"),
)  # fmt: skip
_OF_RUNS: Final = (
    ("a film is held against another specimen",
     "return measured.info.specimen, measured.info.replicate, *measured.info.setpoint.key(without)",
     "return 0, measured.info.replicate, *measured.info.setpoint.key(without)"),
    ("a film is held against another replicate",
     "return measured.info.specimen, measured.info.replicate, *measured.info.setpoint.key(without)",
     "return measured.info.specimen, 0, *measured.info.setpoint.key(without)"),
    ("a film is held against another condition", "*measured.info.setpoint.key(without)",
     "measured.info.compound, () if without == AXIS else measured.info.setpoint.key(without)[1]"),
    ("a sensitivity that conditions tell is not taken", "return slope if slope is not None else UNKNOWN",
     "return UNKNOWN"),
    ("the sensitivity is that of all interfaces", "key = _key(measured, _TEMPERATURE)",
     "key = _key(valued[0], _TEMPERATURE)"),
)  # fmt: skip


def of_components() -> Iterator[Mutant]:
    """Yield mutants of adhesion and hysteresis by a film: weights, derivatives, common errors, and the choice of
    pairs."""
    rows = [(f"components: {name}", old, new) for name, old, new in _SCALED]
    yield from scaled(_COMPONENTS, _OF_COMPONENTS, rows)
    for path, tests, others in ((_COMPONENTS, _OF_COMPONENTS, _OTHERS), (_PAIRS, _OF_PAIRS, _OF_RUNS)):
        for name, old, new in others:
            yield Mutant(f"components: {name}", path, old, new, tests)


_SOLVE, _LACK, _RESAMPLE = (f"tester/analysis/fit/{name}.py" for name in ("solve", "lack", "resample"))
_POINTS, _POWER = "tester/results/fit_points.py", "tests/campaigns/fit/power.py"
_OF_FIT = tests_of("analysis/fit/lack", "analysis/fit/joint")
_OF_POINTS = tests_of("kinds/wheel_on_belt/fit/run_data", "kinds/specimen_on_track/fit/run_data")
_FIT_SCALED: Final = (
    (_SOLVE, "weight of repeats", "squares = [\n        (point.type_a**2 if", "squares = [({} * point.type_a**2 if"),
    (_SOLVE, "weight of what is a condition's own", "+ point.own**2 + point.between**2\n        for",
     "+ {} * point.own**2 + point.between**2 for"),
    (_SOLVE, "weight of scatter between conditions", "+ point.own**2 + point.between**2\n        for",
     "+ point.own**2 + {} * point.between**2 for"),
    (_SOLVE, "prior of a common error", "of_prior = self.reference * (", "of_prior = {} * self.reference * ("),
    (_SOLVE, "size of a common error", "error = one.standard * z", "error = {} * one.standard * z"),
    (_LACK, "repeats in the denominator", "repeats = fmean(point.type_a**2", "repeats = {} * fmean(point.type_a**2"),
    (_LACK, "a condition's own part in the denominator", "fmean(point.own**2 for point in points),",
     "{} * fmean(point.own**2 for point in points),"),
    (_LACK, "scatter between conditions in the denominator", "fmean(point.between**2 for point in points),",
     "{} * fmean(point.between**2 for point in points),"),
    (_LACK, "F of the residuals", "f = np.sum(residuals**2, axis=-1) / self._df / scale",
     "f = {} * np.sum(residuals**2, axis=-1) / self._df / scale"),
    (_LACK, "what is visible", "visible = denominator.standard * chance",
     "visible = {} * denominator.standard * chance"),
    (_RESAMPLE, "own errors of resamples", "+ spread * problem.sigma", "+ {} * spread * problem.sigma"),
    (_RESAMPLE, "common errors of resamples", "prior = fitted[free:] + random", "prior = fitted[free:] + {} * random"),
)  # fmt: skip
_FIT_OTHERS: Final = (
    (_SOLVE, "conditions count alike", "self.weight: Array = self.reference / self.sigma",
     "self.weight: Array = np.ones(len(points))"),
    (_SOLVE, "conditions that scatter more count more", "self.weight: Array = self.reference / self.sigma",
     "self.weight: Array = self.sigma / self.reference"),
    (_LACK, "degrees of freedom of repeats are taken as many",
     "df = (repeats + own_variance + between_variance) ** 2 / squares if squares", "df = inf if squares"),
    (_LACK, "what is fitted takes nothing up", "self._df = size - self._taken.shape[1]", "self._df = size"),
    (_LACK, "chance has all of its errors left", "return errors - (errors @ self._taken) @ self._taken.T",
     "return errors"),
    (_LACK, "each test has the level of all", "if p[place] > LEVEL / (len(p) - rank):", "if p[place] > LEVEL:"),
    (_LACK, "signs of next to nothing count", "(np.abs(residuals[:, : self._n]) > self._negligible)",
     "(np.abs(residuals[:, : self._n]) >= 0.0)"),
    (_LACK, "signs that keep are looked for the other way", "signs[:, pairs[:, 1]] <= 0.0",
     "signs[:, pairs[:, 1]] >= 0.0"),
    (_LACK, "neighbours differ in anything", "if i != variable)", "if i < 0)"),
    (_LACK, "a law fails only where all tests do", "return any(test.failed", "return all(test.failed"),
    (_POWER, "a power is that of one test", "np.mean(smallest <= LEVEL / len(p))", "np.mean(smallest <= 20.0 * LEVEL)"),
    (_RESAMPLE, "intervals are of 68 %", "TAILS: Final = (0.025, 0.975)", "TAILS: Final = (0.16, 0.84)"),
    (_RESAMPLE, "intervals are of 99.9 %", "TAILS: Final = (0.025, 0.975)", "TAILS: Final = (0.0005, 0.9995)"),
    (_POINTS, "repeats count by the whole budget", "part.name == REPEATABILITY), None)", "True), None)"),
    (_POINTS, "a mean is as uncertain as a repeat", "Scatter(share / sqrt(max(result.n_valid, 1)), source)",
     "Scatter(share, source)"),
    (_POINTS, "what rows share is a condition's own", "own is not bool(part.common)", "own is bool(part.common)"),
    (_POINTS, "repeats count twice", "return {REPEATABILITY, TEMPERATURE_SENSITIVITY,",
     "return {TEMPERATURE_SENSITIVITY,"),
    (_POINTS, "a calibration is no common error", "median(factors) if factors else 0.0", "0.0"),
    (_POINTS, "pieces do not differ", 'to {info.worn}", between, piece=piece)', 'to {info.worn}", 0.0, piece=piece)'),
    (_POINTS, "a thermometer is right", "standard_of(terms, Acts.TEMPERATURE), by", "0.0, by"),
    (_POINTS, "a doubt is no reason", 'return ", ".join(result.doubts)', 'return ""'),
)  # fmt: skip
_COLLAPSE, _VERDICT = "tester/analysis/master_curve/collapse.py", "tester/analysis/master_curve/verdict.py"
_OF_COLLAPSE, _OF_VERDICT = tests_of("analysis/master_curve/collapse"), tests_of("analysis/master_curve/verdict")
_MASTER_SCALED: Final = (
    (_COLLAPSE, "residuals of resamples", "spread = point_estimate.residual * sqrt(",
     "spread = {} * point_estimate.residual * sqrt("),
    (_COLLAPSE, "the thermometer in the interval", "thermometer_k = of.thermometer_k *",
     "thermometer_k = {} * of.thermometer_k *"),
    (_COLLAPSE, "what a temperature has in common", "in_common = _between(", "in_common = {} * _between("),
    (_COLLAPSE, "what is known of a run's factor", "priors = np.diag(PILOT /", "priors = np.diag({} * PILOT /"),
    (_VERDICT, "F of a test", "max(before - after, 0.0) / more", "{} * max(before - after, 0.0) / more"),
)
_MASTER_OTHERS: Final = (
    (_COLLAPSE, "the interval is of 68 %", "[0.025, 0.975]", "[0.16, 0.84]"),
    (_COLLAPSE, "the interval is of 99.9 %", "[0.025, 0.975]", "[0.0005, 0.9995]"),
    (_COLLAPSE, "the scatter forgets what was fitted", "max(self.residual.size - self.parameters, 1))",
     "max(self.residual.size - 6 * self.parameters, 1))"),
    (_VERDICT, "no test of factors", "{_FACTORS: of.in_block,", "{"),
    (_VERDICT, "no test of shifts", "_SHIFTS: slope * of.in_block,", ""),
    (_VERDICT, "no test of the shape", ", _SHAPE: splines * warmer}", "}"),
    (_VERDICT, "Ts is not among what is fitted", "if collapse.searched:\n        base",
     "if not collapse.searched:\n        base"),
    (_VERDICT, "a hundredth off is a failure", "chance = max(after / df, FLOOR**2)", "chance = after / df"),
    (_VERDICT, "chance is what is left before", "chance = max(after / df,", "chance = max(before / df,"),
    (_VERDICT, "one set in five is refused", "LEVEL: Final = 1e-4", "LEVEL: Final = 0.2"),
    (_VERDICT, "a power law is one curve", "if collapse.u_factors_k > OPEN_K or not _bends(collapse):", "if False:"),
    (_VERDICT, "temperatures that share nothing are one curve", "if apart:", "if False:"),
    (_VERDICT, "an open Ts is one curve", "if high - low > WIDE_K:", "if False:"),
)


def of_fits() -> Iterator[Mutant]:
    """Yield mutants of fits: weights, denominators, tests and intervals, and the input from a run's conditions."""
    for path, name, old, new in _FIT_SCALED:
        yield from scaled(path, _OF_FIT, [(f"fit: {name}", old, new)])
    for path, name, old, new in _FIT_OTHERS:
        yield Mutant(f"fit: {name}", path, old, new, _OF_POINTS if path == _POINTS else _OF_FIT)


def of_masters() -> Iterator[Mutant]:
    """Yield mutants of master curves: the extent of an interval, and what a verdict compares."""
    tests = {_COLLAPSE: _OF_COLLAPSE, _VERDICT: _OF_VERDICT}
    for path, name, old, new in _MASTER_SCALED:
        yield from scaled(path, tests[path], [(f"master: {name}", old, new)])
    for path, name, old, new in _MASTER_OTHERS:
        yield Mutant(f"master: {name}", path, old, new, tests[path])
