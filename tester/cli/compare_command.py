"""`tester compare`: the conditions of two runs side by side."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

import click

from tester.axes import ListWords
from tester.cli.formatting import Json, dump, number, shown
from tester.cli.run_lookup import run_folder

if TYPE_CHECKING:
    from tester.results.compared import Pair
    from tester.results.run_results import RunResults, TableRow


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
    from tester.results.compared import pairs, same_rig

    results = [_results(name) for name in (run1, run2)]
    kinds = [one.run.info.kind for one in results]
    if kinds[0] != kinds[1]:
        told = f"{run1} is of kind {kinds[0]}, {run2} of {kinds[1]}"
        raise click.ClickException(f"{told}: their conditions have no axes in common")
    for i, name in enumerate((run1, run2) if compounds else ()):
        if compounds and all(row.info.compound != compounds[i] for row in results[i].rows):
            raise click.ClickException(f"{name} has no compound {compounds[i]}")
    found = [*pairs(results[0], results[1], compounds)]
    rows = [*map(_row, found)]
    if as_json:
        dump([*rows])
        return
    words = ListWords(one.either.info.setpoint for one in found)
    if words.common:
        click.echo(f"all at {shown(words.common)}")
    told = [shown(words.of(one.either.info.setpoint)) for one in found]
    if compounds:
        click.echo(f"1: {shown(compounds[0])}, 2: {shown(compounds[1])}")
    width = max(map(len, [*told, "condition"]))
    click.echo(f"{'condition':<{width}}  mu 1    mu 2    diff    u       z      k")
    for text, row in zip(told, rows, strict=True):
        figures = (f"{_cell(row[name], digits)}{row.get(f'mark_{name[-1]}') or ''}" for name, digits in _FIGURES)
        verdict = "  differs" if row["differs"] else ""
        click.echo(f"{text:<{width}}  {'  '.join(figures)}{verdict}")
    one_rig = same_rig(results[0].run, results[1].run)
    shared = "one rig and calibration: common errors drop out" if one_rig else "different rigs or calibrations"
    click.echo(f"u: of the compounds' difference; {shared}")


_FIGURES = (("mu_1", 4), ("mu_2", 4), ("difference", 4), ("u_difference", 4), ("z", 2), ("k", 2))


def _results(name: str) -> RunResults:
    from tester.results.run_results import results_of
    from tester.store.reader import RunReader
    from tester.store.schema import StoreError

    try:
        with RunReader(run_folder(name)) as reader:
            return results_of(reader)
    except StoreError as error:
        raise click.ClickException(str(error)) from error


def _cell(value: Json, digits: int) -> str:
    return f"{value:+.{digits}f}" if isinstance(value, float) else "-"


def _mark(row: TableRow | None) -> str:
    from tester.analysis.trust import mark_of

    if row is None or not isfinite(row.result.mu_resultant):
        return ""
    return mark_of(row.result.status, row.result.flags)


def _mu(row: TableRow | None) -> float | None:
    from tester.analysis.difference import at_nominal

    return number(at_nominal(row.result)) if row is not None else None


def _row(pair: Pair) -> dict[str, Json]:
    first, second, found = pair
    held = pair.either.info.setpoint
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
