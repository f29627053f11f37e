"""What a look at a run shows, tick by tick: the service itself looks when wall time says so."""

from __future__ import annotations

import pytest

from tester.kinds.wheel_on_belt.served.served import SERVED
from tester.run.folder import part_time
from tester.service.state_view import SoakView
from tester.service.values import PlanTrack
from tester.service.watch import RunWatch
from tests.campaigns.faults.stage import Stage, rig_of
from tests.tester.kinds.wheel_on_belt.bench import QUIET, SHORT


def test_a_soak_is_shown_with_how_long_it_has_been_in_band() -> None:
    stage = Stage(SHORT, QUIET)
    watch = RunWatch(stage.run, PlanTrack(stage.plan.name, [part_time(rig_of(QUIET), stage.plan)]), SERVED)
    shown: list[SoakView] = []
    while not stage.ended and (not shown or shown[-1].in_band_s < 1.9):
        now = stage.next_s
        stage.tick()
        if (soak := watch.panel.soak(now)) is not None:
            shown.append(soak)
    # First the surface is brought near, which needs no time in band; then it soaks, near ambient in band at once.
    soaking = [soak for soak in shown if soak.for_s]
    assert shown[0].for_s == shown[0].in_band_s == 0.0
    assert {(soak.target_c, soak.within_k, soak.for_s) for soak in soaking} == {(24.0, 2.0, 2.0)}
    in_band = [soak.in_band_s for soak in soaking]
    assert in_band == sorted(in_band) and in_band[0] == 0.0 and len(in_band) > 5
    assert [soak.waited_s for soak in soaking] == pytest.approx(in_band)
    assert all(soak.surface_c is not None and abs(soak.surface_c - 24.0) <= 2.0 for soak in soaking)
