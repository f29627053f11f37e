"""Results of runs, made up."""

from __future__ import annotations

from tester.sweep.case import NAN, CaseResult, RowResult


def row(number: int = 1, mu: float = 0.73, u: float = 0.01, status: str = "ok") -> RowResult:
    """Return one row of a run's table."""
    value = (mu, 0.005, 3, u, "", "") if status == "ok" else (NAN, NAN, 0, NAN, "", "because")
    return RowResult(number, "1#", 300.0, 100.0 * number, 0.0, 0.0, 40.0, status, *value)


def result(case: int, *rows: RowResult, point: tuple[str, ...] = (), outcome: str = "done") -> CaseResult:
    """Return a run's result; its seed is the case's number."""
    code = 0 if outcome == "done" else 5
    return CaseResult(case, point, case, outcome, "", code, 1000.0 + case, 1, rows)
