"""`tester compare`: the conditions of two runs side by side."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import click

from tester.base.axes import ListWords
from tester.base.words import Json
from tester.cli.options import command, json_option
from tester.cli.stored_runs import results_named
from tester.cli.text_table import dump, shown

if TYPE_CHECKING:
    from tester.results.columns import Table
    from tester.results.compared import Pair
    from tester.results.run_results import RunResults


@command()
@click.argument("run1")
@click.argument("run2", required=False)
@click.option(
    "--compounds", nargs=2, metavar="FIRST SECOND",
    help="Compare these: FIRST of RUN1, SECOND of RUN2; without RUN2 both are of RUN1 (default: its only two).",
)  # fmt: skip
@json_option
def compare(run1: str, run2: str | None, compounds: tuple[str, str] | None, as_json: bool) -> None:
    """Compare the conditions of RUN1 and RUN2, or of two compounds of RUN1: coefficients, difference,
    uncertainty, z.

    Compared are compounds, at the temperatures asked for: the difference from one piece that was mounted to the next is
    in u, the standard uncertainty of the difference; errors that both have in common (one rig, one calibration) are
    not. z is the difference over u; where it is beyond k, "differs" marks more than chance (95 %). Replicates are
    compared by their mean. Behind a coefficient, ! marks a number that is not to be trusted, ? one with a doubt
    (`tester show` lists it).

    RUN2 may be the file of a kept law (`tester fit -o`): its predictions at the measured values, with their interval.
    """
    from tester.inputs.rig.profiles import is_law_file

    if run2 is not None and is_law_file(run2):
        from tester.cli.predict_kept import compare_kept

        if compounds:
            raise click.UsageError("--compounds: a kept law is of one compound")
        compare_kept(run1, run2, as_json=as_json)
        return
    from tester.results.compared import comparison, same_rig

    names = (run1, run1 if run2 is None else run2)
    results = [results_named(name) for name in names]
    if run2 is None and compounds is None:
        compounds = _both(run1, results[0])
    kinds = [one.run.info.kind for one in results]
    if kinds[0] != kinds[1]:
        different = f"{run1} is of kind {kinds[0]}, {run2} of {kinds[1]}"
        raise click.ClickException(f"{different}: their conditions have no axes in common")
    for i, name in enumerate(names if compounds else ()):
        if compounds and all(row.info.compound != compounds[i] for row in results[i].rows):
            raise click.ClickException(f"{name} has no compound {compounds[i]}")
    table = comparison(results[0], results[1], compounds)
    if as_json:
        dump([dict[str, Json](one) for one in table.records()])
        return
    for line in _lines(table, compounds):
        click.echo(line)
    one_rig = same_rig(results[0].run, results[1].run)
    shared = "one rig and calibration: common errors drop out" if one_rig else "different rigs or calibrations"
    click.echo(f"u: of the compounds' difference; {shared}")


def _both(name: str, results: RunResults) -> tuple[str, str]:
    """Return the two compounds of a run; a usage error where it has more or fewer."""
    found = list(dict.fromkeys(row.info.compound for row in results.rows))
    if len(found) != 2:
        expected = "--compounds FIRST SECOND" if len(found) > 2 else "RUN2"
        listed = shown(", ".join(found)) or "none"
        raise click.UsageError(f"{name} alone has the compounds {listed}: which two? (expected {expected})")
    return found[0], found[1]


def _lines(table: Table[Pair], compounds: tuple[str, str] | None) -> Iterator[str]:
    """Yield the setpoints that all pairs share, then a row for each pair with its own setpoints and its figures."""
    words = ListWords(one.either.info.setpoint for one in table.rows)
    common = words.common
    if compounds:
        common = common.removeprefix(f"{compounds[0]}, ")
    if common:
        yield f"all at {shown(common)}"
    if compounds:
        yield f"1: {shown(compounds[0])}, 2: {shown(compounds[1])}"
    from tester.cli.text_table import plain_lines
    from tester.results.columns import Column, Output, Table
    from tester.results.compared import Pair

    found = table.view(Output.COMPARE)
    what = Column[Pair]("condition_words", "condition", lambda pair: words.of(pair.either.info.setpoint))
    yield from plain_lines(Table((what, *found.columns), found.rows))
