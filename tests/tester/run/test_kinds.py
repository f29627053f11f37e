"""What a rig's kind brings is found by the rig's kind; a kind that brings no runs is refused, with what it lacks."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tester import kinds
from tester.base.source import InvalidSource
from tester.kinds.wheel_on_belt import KIND
from tester.run.kinds import run_parts, served_kind
from tester.run.rigs import load_rig, load_rig_text


@pytest.mark.parametrize("name", kinds.packaged_rigs())
def test_every_packaged_rig_is_of_a_kind_that_can_be_run(name: str) -> None:
    rig = load_rig(name)
    assert rig.kind == kinds.packaged_rigs()[name].name
    assert run_parts(rig).plant and served_kind(rig).machine


def test_a_rig_of_a_kind_without_runs_is_refused_with_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    text = load_rig("sim").text
    monkeypatch.setattr("tester.run.kinds.find", lambda _name: replace(KIND, runs=None))
    with pytest.raises(InvalidSource, match=r"no recipe can be run on a rig of the kind wheel_on_belt.*brings no runs"):
        load_rig("sim")
    with pytest.raises(InvalidSource, match="brings no runs"):
        load_rig_text(text)
