"""What a run's budget is made of, as rows of the record: terms of the machine, what is known of compounds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from math import inf, isfinite
from typing import Any, cast

from tester.analysis.kelvin import KnownSlope
from tester.analysis.terms import Acts, Term
from tester.store.statements import Statement, Value, insert


def budget_rows(terms: Iterable[Term], known: Iterable[KnownSlope]) -> Iterator[Statement]:
    """Yield the statements that put them on record."""
    for position, one in enumerate(terms):
        row: dict[str, Value] = asdict(one) | {"acts": one.acts.value, "df": one.df if isfinite(one.df) else None}
        yield insert("budget_term", {"position": position} | row)
    for position, one in enumerate(known):
        yield insert("known_slope", {"position": position} | asdict(one))


def term_of(row: Mapping[str, object]) -> Term:
    """Return a term from its row; raises ValueError for what is none."""
    given = {name: value for name, value in row.items() if name not in ("position", "acts", "df")}
    df = row["df"]
    values = cast("dict[str, Any]", given)  # numbers and texts, as the table's columns have them
    return Term(**values, acts=Acts(str(row["acts"])), df=df if isinstance(df, float) else inf)
