"""CPU time of the commands, from the start of the interpreter."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from bench.child import cpu_accounting, cpu_seconds_of_child
from bench.effort import Effort
from bench.figures import Figure, at_most, ratio, unavailable

HELP_LIMIT = 7.0
"""Limit of ``tester --help`` relative to ``python -c pass``."""

TESTER = "import sys; from tester.cli.main import main; main()"
FIRST_SCAN = """\
import os, sys
from tester.machine.engine import Engine

def stop(engine, now):
    os._exit(0 if engine.scans == 0 else 1)

Engine.tick = stop
from tester.cli.main import main
main()
"""
"""``tester``, ended by its first scan: when every device is configured and has reported."""


def measure(effort: Effort) -> list[Figure]:
    """Return the CPU time of help, check and run to the first scan, and their ratios to an empty interpreter."""
    names = ("python -c pass", "tester --help", "tester check quickstart", "tester run to first scan")
    if not cpu_accounting():
        return [unavailable(name, "ms CPU", "this system does not account for children") for name in names]
    rounds = effort.pick(5, 2)
    with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as folder:
        calls = [
            ["-c", "pass"],
            ["-c", TESTER, "--help"],
            ["-c", TESTER, "check", "quickstart"],
            ["-c", FIRST_SCAN, "run", "quickstart", "--yes", "--out", str(Path(folder) / "runs")],
        ]
        for call in calls:
            cpu_seconds_of_child(call)  # writes the bytecode of every module
        found: list[list[float]] = [[] for _ in calls]
        for _ in range(effort.runs):
            sums = [0.0] * len(calls)
            for _ in range(rounds):
                for i, call in enumerate(calls):
                    sums[i] += cpu_seconds_of_child(call)
            for column, total in zip(found, sums, strict=True):
                column.append(1e3 * total / rounds)
    figures = [Figure(name, "ms CPU", tuple(column)) for name, column in zip(names, found, strict=True)]
    for name, column, limit in zip(names[1:], found[1:], (at_most(HELP_LIMIT), None, None), strict=True):
        figures.append(ratio(f"{name} / python -c pass", column, found[0], limit))
    return figures
