"""A specimen on a track behind a service: its values, its gates, and its axes by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.service.commands import Jog, RunRecipe, Stop
from tester.service.state_view import StateView
from tests.tester.kinds.specimen_on_track.bench import DISC
from tests.tester.service.stage import Script, Stage, play
from tests.tester.service.test_manual_mode import armed, jog, off, value


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Show every poll, and let simulated time run as fast as it goes."""
    monkeypatch.setattr("tester.service.state_publisher.SNAPSHOT_S", 0.0)
    monkeypatch.setattr("tester.service.service.MANUAL_LAPSE", 50.0)


def over(view: StateView) -> bool:
    return view.run is not None and view.run.exit is not None


def all_open(view: StateView) -> bool:
    return bool(view.gates) and all(gate.open for gate in view.gates)


def test_a_run_is_shown_with_its_own_values_and_gates(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RunRecipe("disc", text=DISC, seed=1, speed=None, yes=True))
        yield from stage.until(over)

    stage = play(tmp_path, script, rig="pin-on-disc")
    assert stage.views[-1].run is not None and stage.views[-1].run.exit == 0
    # With the arm down and the track at rest every gate is open as well.
    sliding = [view for view in stage.views if view.progress.phase == "slide" and all_open(view)]
    assert {gate.key for gate in sliding[-1].gates} == {"speed", "temperature", "contact", "settling"}
    assert value(sliding[-1], "track") == pytest.approx(200.0, rel=0.02) and value(sliding[-1], "friction") > 0.5


def test_by_hand_the_track_takes_a_step_with_the_arm_raised_and_none_with_it_down(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield from jog(stage, Jog(axis="track", direction=1))
        yield from stage.until(lambda view: value(view, "track") == pytest.approx(1.0, rel=0.01))
        yield from jog(stage, Jog(axis="arm", direction=-1))
        yield None
        assert "the track moves: stop it first" in stage.refused["jog"]
        yield from jog(stage, Jog(axis="track", direction=-1))
        yield from stage.until(lambda view: abs(value(view, "track")) < 0.001)
        yield from jog(stage, Jog(axis="arm", direction=-1))
        yield from stage.until(lambda view: value(view, "lift") < 0.2)
        yield from jog(stage, Jog(axis="track", direction=1))
        yield None
        assert "only with the arm raised" in stage.refused["jog"]
        yield stage.order(Stop())
        yield from stage.until(off)

    play(tmp_path, script, rig="grosch")
