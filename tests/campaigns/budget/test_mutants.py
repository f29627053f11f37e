"""The mutants of budgets, against the code as it is."""

from __future__ import annotations

from collections import Counter

import pytest

from tests.campaigns.budget.mutant import ROOT, Mutant
from tests.campaigns.budget.mutants import mutants
from tests.campaigns.budget.terms import KINDS


@pytest.mark.parametrize("mutant", mutants(), ids=lambda one: one.name)
def test_every_mutant_still_fits_the_code_and_changes_it(mutant: Mutant) -> None:
    assert (ROOT / mutant.path).read_text(encoding="utf-8").count(mutant.old) == 1
    assert mutant.new != mutant.old
    assert all((ROOT / file).is_file() for file in mutant.tests)


def test_no_two_mutants_have_one_name() -> None:
    assert [name for name, count in Counter(one.name for one in mutants()).items() if count > 1] == []


def test_every_term_of_both_kinds_has_its_mutants() -> None:
    names = {one.name for one in mutants()}
    for kind, _, terms, _ in KINDS:
        for term in terms:
            wanted = ("removed", "halved", "doubled", "acting otherwise", "shared otherwise")
            assert {f"{kind}: {term.name} {how}" for how in wanted} <= names
