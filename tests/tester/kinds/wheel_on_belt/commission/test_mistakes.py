"""Commissioning names every mistake of its list, and none on a clean rig."""

from __future__ import annotations

import re

import pytest

from tests.campaigns.mistakes.by_commissioning import MISTAKES, clean
from tests.campaigns.mistakes.mistake import Mistake

QUICK = [one for one in MISTAKES if "scale" not in one.name and "axis" not in one.name]
"""The others are in test_jog."""


@pytest.mark.parametrize("mistake", QUICK, ids=lambda one: one.name)
def test_a_mistake_is_named(mistake: Mistake) -> None:
    found = mistake.find(1)
    assert any(re.search(mistake.named_by, text) for text in found), found


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(3))
def test_every_mistake_is_named_with_other_seeds(seed: int) -> None:
    missed: list[tuple[str, list[str]]] = []
    for mistake in MISTAKES:
        found = mistake.find(seed)
        if not any(re.search(mistake.named_by, text) for text in found):
            missed.append((mistake.name, found))
    assert not missed


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(10))
def test_a_clean_rig_has_no_findings(seed: int) -> None:
    assert clean(seed) == []
