"""All deliberate mistakes in budgets, and in what is worked out from them."""

from __future__ import annotations

from tests.campaigns.budget import formulas, parts, terms
from tests.campaigns.budget.mutant import Mutant


def mutants() -> list[Mutant]:
    """Return all of them."""
    of_budgets = (terms.of_terms(), terms.of_formulas(), formulas.of_formulas(), formulas.of_structure())
    return [one for some in (*of_budgets, parts.of_components()) for one in some]
