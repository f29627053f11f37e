"""A rig's kind supplies its parts; a kind without runs is refused, and the missing parts are named."""

from __future__ import annotations

from dataclasses import replace

import pytest

from recipes import find
from tester import kinds
from tester.base.source import InvalidSource
from tester.kinds.wheel_on_belt import KIND
from tester.run.kind_lookup import checked_recipe, load_rig, load_rig_text, run_parts, served_kind


@pytest.mark.parametrize("name", kinds.packaged_rigs())
def test_every_packaged_rig_is_of_a_kind_that_can_be_run(name: str) -> None:
    rig = load_rig(name)
    assert rig.kind == kinds.packaged_rigs()[name].name
    assert run_parts(rig).plant and served_kind(rig).machine


def test_a_rig_of_a_kind_without_runs_is_refused_with_the_missing_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    text = load_rig("sim").text
    monkeypatch.setattr("tester.run.kind_lookup.find", lambda _name: replace(KIND, runs=None))
    with pytest.raises(InvalidSource, match=r"a rig of the kind wheel_on_belt cannot run recipes.*has no runs"):
        load_rig("sim")
    with pytest.raises(InvalidSource, match="has no runs"):
        load_rig_text(text)


def test_a_recipe_without_a_kind_that_is_written_for_another_one_is_refused_for_that_alone() -> None:
    text = find("quickstart").read_text(encoding="utf-8")
    with pytest.raises(InvalidSource) as caught:
        checked_recipe(text, load_rig("grosch"), "q.yaml")
    (problem,) = caught.value.problems
    assert "the keys are of a recipe for a rig of kind wheel_on_belt (such as --rig sim), rig" in problem.message


def test_a_recipe_with_one_mistake_is_not_taken_for_one_of_another_kind() -> None:
    text = find("quickstart").read_text(encoding="utf-8").replace("pre_grind:", "pregrind:")
    with pytest.raises(InvalidSource, match=r'unknown key "pregrind", did you mean pre_grind\?'):
        checked_recipe(text, load_rig("sim"), "q.yaml")
