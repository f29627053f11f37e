"""`tester compare`: the conditions of two runs side by side."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

import click

from tester.axes import AxisValue, ListWords
from tester.cli.formatting import Json, dump, number, shown
from tester.cli.run_lookup import run_folder

if TYPE_CHECKING:
    from tester.export.results import RunResults, TableRow
    from tester.store.records import StoredRun

Held = tuple[str, tuple[AxisValue, ...]]
"""What is compared: compound, values of the axes as people read them."""


@click.command()
@click.argument("run1")
@click.argument("run2")
@click.option("--compounds", nargs=2, metavar="FIRST SECOND", help="Compare these: FIRST of RUN1, SECOND of RUN2.")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
def compare(run1: str, run2: str, compounds: tuple[str, str] | None, as_json: bool) -> None:
    """Hold the conditions of RUN1 and RUN2 against each other: coefficients, difference, uncertainty, z.

    Compared are compounds, at the temperatures asked for: the difference from one piece that was mounted to the next is
    in u, the standard uncertainty of the difference; errors that both have in common (one rig, one calibration) are
    not. z is the difference over u; where it is beyond k, "differs" says that this is not chance alone (95 %).
    Replicates are compared by their mean. Behind a coefficient ! says that it is not to be trusted, ? that it carries a
    doubt (`tester show` says which).
    """
    results = [_results(name) for name in (run1, run2)]
    kinds = [one.run.info.kind for one in results]
    if kinds[0] != kinds[1]:
        told = f"{run1} is of kind {kinds[0]}, {run2} of {kinds[1]}"
        raise click.ClickException(f"{told}: their conditions have no axes in common")
    first, second = (
        {_held(row, compounds): row for row in one.rows if compounds is None or row.info.compound == compounds[i]}
        for i, one in enumerate(results)
    )
    for name, rows, wanted in zip((run1, run2), (first, second), compounds or (), strict=False):
        if not rows:
            raise click.ClickException(f"{name} has no compound {wanted}")
    same_rig = _same_rig(results[0].run, results[1].run)
    keys = list(dict.fromkeys([*first, *second]))
    rows = [_row(first.get(key), second.get(key), same_rig=same_rig) for key in keys]
    if as_json:
        dump([*rows])
        return
    either = [first.get(key) or second[key] for key in keys]
    words = ListWords(one.info.setpoint for one in either)
    if words.common:
        click.echo(f"all at {shown(words.common)}")
    told = [shown(words.of(one.info.setpoint)) for one in either]
    if compounds:
        click.echo(f"1: {shown(compounds[0])}, 2: {shown(compounds[1])}")
    width = max(map(len, [*told, "condition"]))
    click.echo(f"{'condition':<{width}}  mu 1    mu 2    diff    u       z      k")
    for text, row in zip(told, rows, strict=True):
        figures = (f"{_cell(row[name], digits)}{row.get(f'mark_{name[-1]}') or ''}" for name, digits in _FIGURES)
        verdict = "  differs" if row["differs"] else ""
        click.echo(f"{text:<{width}}  {'  '.join(figures)}{verdict}")
    shared = "one rig and calibration: common errors drop out" if same_rig else "different rigs or calibrations"
    click.echo(f"u: of the compounds' difference; {shared}")


_FIGURES = (("mu_1", 4), ("mu_2", 4), ("difference", 4), ("u_difference", 4), ("z", 2), ("k", 2))


def _results(name: str) -> RunResults:
    from tester.export.results import results_of
    from tester.store.reader import RunReader
    from tester.store.schema import StoreError

    try:
        with RunReader(run_folder(name)) as reader:
            return results_of(reader)
    except StoreError as error:
        raise click.ClickException(str(error)) from error


def _same_rig(one: StoredRun, other: StoredRun) -> bool:
    """Tell whether two runs have the errors of the measuring chain in common.

    One calibration of one rig; a simulated one has other imperfections for every seed.
    """
    first, second = one.info, other.info
    return (one.calibration_sha256, first.simulated, first.seed) == (
        other.calibration_sha256,
        second.simulated,
        second.seed,
    )


def _cell(value: Json, digits: int) -> str:
    return f"{value:+.{digits}f}" if isinstance(value, float) else "-"


def _mark(row: TableRow | None) -> str:
    from tester.analysis.trust import mark_of

    if row is None or not isfinite(row.result.mu_resultant):
        return ""
    return mark_of(row.result.status, row.result.flags)


def _held(row: TableRow, compounds: tuple[str, str] | None) -> Held:
    held = row.info.setpoint
    return "" if compounds else held.compound, tuple(axis.of(held) for axis in held.axes)


def _mu(row: TableRow | None) -> float | None:
    from tester.analysis.difference import at_nominal

    return number(at_nominal(row.result)) if row is not None else None


def _row(first: TableRow | None, second: TableRow | None, *, same_rig: bool) -> dict[str, Json]:
    from tester.analysis.difference import Difference, difference

    one = first or second
    assert one is not None
    found = Difference()
    if first is not None and second is not None:
        found = difference(first.result, second.result, same_rig=same_rig)
    held = one.info.setpoint
    return {
        "compound": held.compound,
        "pieces_1": first.result.n_valid if first is not None and len(first.replicates) > 1 else 1,
        "pieces_2": second.result.n_valid if second is not None and len(second.replicates) > 1 else 1,
        **{axis.column: axis.of(held) for axis in held.axes},
        "mu_1": _mu(first),
        "mu_2": _mu(second),
        "mark_1": _mark(first),
        "mark_2": _mark(second),
        "difference": number(found.value),
        "u_difference": number(found.standard),
        "z": number(found.value / found.standard) if found.standard > 0.0 else None,
        "k": number(found.coverage),
        "differs": found.told_apart,
    }
