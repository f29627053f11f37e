"""The mutants of the budget, against the code as it is."""

from __future__ import annotations

import pytest

from tests.campaigns.budget.mutants import ROOT, Mutant, mutants


@pytest.mark.parametrize("mutant", mutants(), ids=lambda one: one.name)
def test_every_mutant_still_fits_the_code(mutant: Mutant) -> None:
    assert (ROOT / mutant.path).read_text(encoding="utf-8").count(mutant.old) == 1
