"""What commands do with a kept law: its value with its interval, and a run's conditions beside it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from sim.physics.friction import in_range
from tester.base.words import Json
from tester.cli.options import print_json
from tester.cli.stored_runs import kind_in, print_left_out, run_folder
from tester.cli.text_table import dump, shown
from tester.inputs.kept_laws.law_materials import read_law
from tester.inputs.kept_laws.law_value import KeptLaw, Predicted

if TYPE_CHECKING:
    from tester.analysis.fit.fit_law import FitPoint
    from tester.analysis.fit.fit_part import Subject


def predict_kept(
    path: str, compound: str | None, temperature_c: float, load_n: float, slip_m_s: float, *, as_json: bool
) -> None:
    """Print a kept law's coefficient with its interval, and on stderr what to take care of.

    Raises ValueError for another compound or an impossible condition, InvalidSource.
    """
    kept = read_law(Path(path))
    if compound is not None:
        kept.of(compound)
    at = temperature_c, load_n, slip_m_s
    in_range(*at)
    found = kept.predict(*at)
    for caveat in kept.caveats(*at):
        click.echo(f"warning: {shown(caveat)}", err=True)
    if as_json:
        print_json({**found._asdict(), "extrapolated": [*kept.beyond(*at)], "doubts": [*kept.doubts]})
        return
    click.echo(f"{found.mu:.5f}")
    click.echo(f"{found.low:.5f} to {found.high:.5f} (95 %, of a condition of the same specimens)")


class Beside(NamedTuple):
    """A measured condition, and a kept law's prediction at its measured values."""

    point: FitPoint
    predicted: Predicted
    beyond: tuple[str, ...]

    @property
    def inside(self) -> bool:
        """Return whether the measured coefficient is inside the interval."""
        return self.predicted.low <= self.point.value <= self.predicted.high


def compare_kept(run: str, path: str, *, as_json: bool) -> None:
    """Print a run's conditions beside the predictions of a kept law. Raises UsageError, InvalidSource, StoreError."""
    kept, rows, left_out = beside(run, path)
    inside = sum(row.inside for row in rows)
    if as_json:
        dump([_record(row) for row in rows])
    else:
        for line in _lines(rows):
            click.echo(line)
        click.echo(f"{inside} of {len(rows)} inside the 95 % interval of {shown(kept.name)}")
    for doubt in kept.doubts:
        click.echo(f"warning: {shown(doubt)}", err=True)
    print_left_out(left_out)


def beside(run: str, path: str) -> tuple[KeptLaw, list[Beside], list[tuple[str, str]]]:
    """Return a kept law, the conditions of a run beside it, and those that it does not cover with the reason."""
    kept, folder = read_law(Path(path)), run_folder(run)
    kind, model = kind_in(folder), kept.model
    if kind.name != model.kind or kind.fits is None:
        raise click.UsageError(f"{path} is a law of the kind {model.kind}, {run} is of {kind.name}")
    part = kind.fits()
    sourced = part.run_points(folder)
    law = part.laws[model.form]
    names = ["slip" if variable.name == "speed" else variable.name for variable in law.variables]
    rows: list[Beside] = []
    left_out = [*sourced.left_out]
    for point in sourced.points:
        why = _not_of(kept, part.subject(point.group)) or (law.leaves_out(point.nominal) if law.leaves_out else "")
        if why:
            left_out.append((point.label, why))
            continue
        held = dict(zip(names, point.measured, strict=True))
        at = held["temperature"], held["load"], held["slip"]
        rows.append(Beside(point, kept.predict(*at), tuple(kept.beyond(*at))))
    if not rows:
        raise click.ClickException(f"{run} has no condition of {model.compound} that {path} could predict")
    return kept, rows, left_out


def _not_of(kept: KeptLaw, subject: Subject) -> str:
    """Return why a law is not that of a condition's rubber, interface and surface, "" if it is."""
    model = kept.model
    for what, own, other in (
        ("compound", model.compound, subject.compound),
        ("interface", model.interface, subject.interface),
        ("surface", model.surface, subject.surface),
    ):
        if own != other:
            return f"{what}: {kept.name} is of {own or 'none'}"
    return ""


def _lines(rows: list[Beside]) -> Iterator[str]:
    yield f"{'condition':<44}{'measured':>10}{'predicted':>11}{'low':>8}{'high':>8}"
    for row in rows:
        mark = "inside" if row.inside else "OUTSIDE"
        more = ", extrapolated" if row.beyond else ""
        p = row.predicted
        label = shown(row.point.label)[:43]
        yield f"{label:<44}{row.point.value:>10.3f}{p.mu:>11.3f}{p.low:>8.3f}{p.high:>8.3f}  {mark}{more}"


def _record(row: Beside) -> dict[str, Json]:
    return {
        "condition": row.point.label,
        "measured": row.point.value,
        **row.predicted._asdict(),
        "inside": row.inside,
        "extrapolated": [*row.beyond],
    }
