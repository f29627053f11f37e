"""`tester paper`: checks the paper against its own data; with --all every item of all papers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from tester.base.processes import EXIT_DONE, EXIT_FAILED
from tester.cli.options import command, json_option
from tester.cli.text_table import Json, dump

if TYPE_CHECKING:
    from tester.analysis.fit.fit_part import PublishedTable
    from tester.analysis.papers import Judged


@command()
@click.option("--all", "every", is_flag=True, help="Every figure, table, equation and statement of all papers.")
@json_option
def paper(every: bool, as_json: bool) -> int:
    """Check the paper's equations and claims against its own appendices; exit code 1 where a figure misses.

    Polymers 2024, 16(5), 596, doi 10.3390/polym16050596 (CC BY 4.0): Eqs 7 to 9 with Table 3, fits to appendix A seen
    on appendix B, and the errors that the paper quotes. With --all: a page with each item of this paper
    and of the two that the laws persson and greta come from, with an error that is worked out now and a verdict.
    """
    return _all(as_json) if every else _one(as_json)


def _one(as_json: bool) -> int:
    from tester.analysis.fit import as_json as plain
    from tester.analysis.fit.fit_text import table_lines

    table = _table()
    if as_json:
        dump(plain.table(table))
    else:
        for line in table_lines(table):
            click.echo(line)
    return EXIT_FAILED if table.missed else EXIT_DONE


def _table() -> PublishedTable:
    from tester.kinds import DEFAULT, find

    fits = find(DEFAULT).fits
    assert fits is not None  # the packaged wheel brings its laws
    return fits().published_table()


def _all(as_json: bool) -> int:
    from tester.analysis.papers import items_text, judged_papers, table_text
    from tester.kinds import packaged_papers

    result = judged_papers(packaged_papers())
    if as_json:
        dump(_as_json(result))
    else:
        click.echo(f"{table_text(result)}\n{items_text(result)}", nl=False)
    return EXIT_DONE


def _as_json(result: Judged) -> Json:
    from tester.analysis.papers import rows_of

    return {
        paper.name: {
            "results": [
                {"result": row.row.result, "verdict": row.verdict.value, "error": row.words}
                for row in rows_of(paper, items)
            ],
            "items": [
                {
                    "where": item.where,
                    "states": item.states,
                    "verdict": finding.verdict.value,
                    "error": finding.error,
                    "u": finding.u or None,
                    "command": item.command or None,
                }
                for item, finding in items
            ],
        }
        for paper, items in result
    }
