"""The power of the tests for a lack of fit: the share of records in which they refuse a departure from the law."""

from __future__ import annotations

import numpy as np

from tester.analysis.fit.fit_law import NAN
from tester.analysis.fit.lack import DRAWS, LEVEL, Chance, denominator_of
from tester.analysis.fit.solve import FitProblem
from tester.base.arrays import Array


def power_of(problem: FitProblem, fitted: Array, departure: Array, draws: int = DRAWS) -> float:
    """Return the share of records in which the tests refuse a departure of ln mu from the law, shape (n,); NaN without
    a denominator.

    It is that of the linearised law: the part that the parameters absorb near the fit is invisible.
    """
    denominator = denominator_of(problem.points)
    if denominator is None:
        return NAN
    chance = Power(problem, fitted, denominator, draws)
    moved = np.concatenate([departure / problem.sigma, np.zeros(problem.priors)])
    return chance.refused(moved)


class Power(Chance):
    """Simulated residuals of the right law, and of a departure from it."""

    def refused(self, departure: Array) -> float:
        """Return the share of draws that are refused after adding a departure, shape (n + priors,)."""
        f, runs = self._figures(self._without(self._errors + departure), self._scale)
        sorted_f = np.sort(self._f)
        p: list[Array] = [(sorted_f.size - np.searchsorted(sorted_f, f, side="left") + 1) / (sorted_f.size + 1)]
        for name, runs_of in runs.items():
            sorted_runs = np.sort(self._runs[name])
            p.append((np.searchsorted(sorted_runs, runs_of, side="right") + 1) / (sorted_runs.size + 1))
        smallest: Array = np.min(np.stack(p), axis=0)  # Holm refuses exactly when the smallest passes its level
        return float(np.mean(smallest <= LEVEL / len(p)))
