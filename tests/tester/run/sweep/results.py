"""Results of runs, made up."""

from __future__ import annotations

from tester.kinds.wheel_on_belt.image.axes import AXES
from tester.run.sweep.case import NAN, CaseResult, RowResult


def row(number: int = 1, mu: float = 0.73, u: float = 0.01, status: str = "ok", care: str = "") -> RowResult:
    """Return one row of a run's table."""
    held = AXES.setpoint("1#", slip_velocity=0.3, load=100.0 * number, temperature=40.0)
    values = {"mu": mu, "u_standard": u, "s": 0.005, "valid": 3, "mark": care, "flags": "carry-over" if care else ""}
    if status != "ok":
        values |= {"mu": NAN, "u_standard": NAN, "s": NAN, "valid": 0, "mark": "", "reason": "because"}
    return RowResult(number, held, {"status": status, "reason": "", **values})


def result(case: int, *rows: RowResult, point: tuple[str, ...] = (), outcome: str = "done") -> CaseResult:
    """Return a run's result; its seed is the case's number."""
    code = 0 if outcome == "done" else 5
    return CaseResult(case, point, case, outcome, "", code, 1000.0 + case, 1, rows)
