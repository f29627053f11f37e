"""``tester results exclude`` and ``tester results include``: a person's word on a repeat, with a reason, on record."""

from __future__ import annotations

import click

from tester.cli.options import Decorated, command, results_named, run_folder
from tester.cli.text_table import shown


def _of_a_repeat(command: Decorated) -> Decorated:
    """Add the arguments and options that both commands have."""
    command = click.option("--operator", default=None, metavar="NAME", help="Who says so.  [default: user]")(command)
    command = click.option("--reason", required=True, metavar="TEXT", help="Why; goes on record.")(command)
    command = click.argument("repeat", metavar="CONDITION/REPEAT")(command)
    return click.argument("run")(command)


@command()
@_of_a_repeat
def exclude(run: str, repeat: str, reason: str, operator: str | None) -> None:
    """Leave a repeat of RUN out of its condition's mean, and make the run's tables anew.

    CONDITION/REPEAT as repeats.csv counts them, e.g. 3/2. Nothing is deleted: `tester results include` takes it back.
    """
    _say(run, repeat, reason, operator, excluded=True)


@command()
@_of_a_repeat
def include(run: str, repeat: str, reason: str, operator: str | None) -> None:
    """Take a repeat of RUN that was excluded into its condition's mean again, and make the run's tables anew."""
    _say(run, repeat, reason, operator, excluded=False)


def _say(run: str, repeat: str, reason: str, operator: str | None, *, excluded: bool) -> None:
    from tester.base.lock import user
    from tester.results.exclude import CannotExcludeError, Word, parse_target, record_word

    folder = run_folder(run)
    try:
        condition, number = parse_target(repeat)
    except CannotExcludeError as error:
        raise click.UsageError(str(error)) from error
    record_word(folder, Word(condition, number, excluded, reason, user() if operator is None else operator))
    results = results_named(run)
    row = next(row for row in results.all_rows() if any(one.info.condition == condition for one in row.replicates))
    n = f"valid {row.result.counts.words}"
    click.echo(f"{condition}/{number} {'excluded' if excluded else 'included'}: {shown(row.describe())}, {n}", err=True)
    click.echo(f"record head: {results.record_head}", err=True)
