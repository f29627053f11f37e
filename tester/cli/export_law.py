"""`tester export LAW.yaml`: a kept law for finite element programs."""

from __future__ import annotations

from pathlib import Path

import click

from tester.base.trouble import in_words
from tester.cli.text_table import shown

SOLVER_NAMES = ("abaqus", "ansys", "lsdyna", "csv")
"""Formats of a law (``tester.report.solver_tables.SOLVERS``), without loading them."""
MOST = 200
"""Points on an axis, at most."""


def export_law(path: str, solver: str, out: Path | None, area_mm2: float | None, points: str) -> None:
    """Write a law's table to a file, or to stdout. Raises UsageError, InvalidSource."""
    from tester.inputs.kept_laws.law_materials import read_law
    from tester.report.solver_tables import SOLVERS, Points, solver_table

    if solver not in SOLVERS:
        raise click.UsageError(f"--format {solver}: {path} is a kept law (expected {', '.join(SOLVERS)})")
    numbers = [int(text) if text.isdigit() else 0 for text in points.lower().split("x")]
    if len(numbers) != 3 or not all(2 <= number <= MOST for number in numbers):
        expected = f"SPEEDSxPRESSURESxTEMPERATURES, each 2 to {MOST}, such as 20x20x10"
        raise click.UsageError(f"--points {points} (expected {expected})")
    law = read_law(Path(path))
    try:
        table = solver_table(law, Points(*numbers), area_mm2)
    except ValueError as error:
        raise click.UsageError(str(error)) from error
    text = "".join(f"{line}\n" for line in SOLVERS[solver](table))
    for doubt in law.doubts:
        click.echo(f"warning: {shown(doubt)}", err=True)
    if out is None:
        click.echo(text, nl=False)
        return
    try:
        out.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise click.ClickException(f"{out} cannot be written: {in_words(error)}") from error
