"""All deliberate mistakes in budgets, and in results derived from them."""

from __future__ import annotations

from tests.campaigns.budget import formulas, parts, terms
from tests.campaigns.budget.mutant import Mutant


def mutants() -> list[Mutant]:
    """Return all of them."""
    of_budgets = (terms.of_terms(), terms.of_formulas(), formulas.of_formulas(), formulas.of_structure())
    of_parts = (parts.of_components(), parts.of_fits(), parts.of_masters())
    return [one for some in (*of_budgets, *of_parts) for one in some]
