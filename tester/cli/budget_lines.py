"""The budget of each condition on a terminal: what its uncertainty is made of, the largest term first."""

from __future__ import annotations

from collections.abc import Iterator

from tester.base.axes import condition_words
from tester.cli.text_table import plain_lines, shown
from tester.results.budget_table import budgeted_rows, sums, terms_table
from tester.results.columns import Output
from tester.results.conditions_table import conditions_table
from tester.results.run_results import RunResults


def budget_lines(results: RunResults) -> Iterator[str]:
    """Yield a table for each condition that has a budget; terms in per cent of the coefficient."""
    conditions = conditions_table(results)
    for one in budgeted_rows(conditions):
        first, *others = sums(conditions, one)
        yield shown(f"{condition_words(one.info.setpoint)}: {first}")
        yield from (shown(f"  {line}") for line in others)
        yield from (f"  {line}" for line in plain_lines(terms_table(one, results.worn).view(Output.SHOW)))
