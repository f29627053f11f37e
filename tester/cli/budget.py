"""The budget of each condition on a terminal: what its uncertainty is made of, the largest term first."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

from tester.axes import condition_words
from tester.cli.formatting import shown
from tester.results.budget import share_of, terms_of
from tester.results.run_results import RunResults, TableRow


def budget_lines(results: RunResults) -> Iterator[str]:
    """Yield a table for each condition that has a value; terms in per cent of the coefficient."""
    for row in results.rows:
        if row.result.ok:
            yield from _lines(row, results.worn)


def _lines(row: TableRow, worn: str) -> Iterator[str]:
    r = row.result
    mu = abs(r.mu_resultant)
    this, compound = r.budget, r.compound_budget
    where = condition_words(row.info.setpoint)
    yield shown(f"{where}: mu {r.mu_resultant:.4f}, at its temperature {r.mu_corrected:.4f}")
    for name, one in ((f"this {worn} in this condition", this), ("the compound", compound)):
        if isfinite(one.expanded):
            percent = f", {100.0 * one.expanded / mu:.2f} %" if mu > 0.0 else ""
            yield shown(f"  U (95 %) of {name}: {one.expanded:.4f}{percent} (k = {one.coverage:.2f})")
    terms = sorted(terms_of(r), key=lambda one: -one.standard)
    width = max((len(one.name) for one in terms), default=0)
    shared = f"this {worn}"
    yield f"  {'term':<{width}}  % of mu  {shared:>10}  compound  df   from"
    for one in terms:
        percent = 100.0 * one.standard / mu if mu > 0.0 else float("nan")
        shares = (f"{100.0 * share_of(one, budget):.0f} %" for budget in (this, compound))
        df = f"{one.df:.0f}" if isfinite(one.df) else "-"
        own, whole = shares
        yield shown(f"  {one.name:<{width}}  {percent:7.3f}  {own:>10}  {whole:>8}  {df:<3}  {one.source}")
