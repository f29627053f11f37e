"""Views of a run, tick by tick: the service itself takes one at intervals of wall time."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tester.kinds.specimen_on_track.served import SERVED as TRACK
from tester.kinds.wheel_on_belt.served.served import SERVED
from tester.run.folder import part_time
from tester.service.state_view import SoakView
from tester.service.values import PlanTrack
from tester.service.watch import RunWatch
from tests.campaigns.faults.stage import Stage, rig_of
from tests.tester.kinds.specimen_on_track.bench import TrackBench
from tests.tester.kinds.wheel_on_belt.bench import QUIET, SHORT
from tests.tester.service.views import state

TEMPERED = """\
recipe: a block
kind: specimen_on_track
specimens: [{compound: SBR}]
measure: {repeats: 1, min_valid: 1, distance: 0.4 mm, soak: {within: 1 K, for: 120 s}}
grids:
  - {name: one, load: 20 N, temperature: 20 degC, track_speed: 3 mm/s}
"""


def test_a_soak_is_shown_with_how_long_it_has_been_in_band() -> None:
    stage = Stage(SHORT, QUIET)
    watch = RunWatch(stage.run, PlanTrack(stage.plan.name, [part_time(rig_of(QUIET), stage.plan)]), SERVED)
    shown: list[SoakView] = []
    while not stage.ended and (not shown or shown[-1].in_band_s < 1.9):
        now = stage.next_s
        stage.tick()
        if (soak := watch.panel.soak(now)) is not None:
            shown.append(soak)
    # First the surface approaches its setpoint, without time in band; then it soaks, near ambient in band at once.
    soaking = [soak for soak in shown if soak.for_s]
    assert shown[0].for_s == shown[0].in_band_s == 0.0
    assert {(soak.target_c, soak.within_k, soak.for_s) for soak in soaking} == {(24.0, 2.0, 2.0)}
    in_band = [soak.in_band_s for soak in soaking]
    assert in_band == sorted(in_band) and in_band[0] == 0.0 and len(in_band) > 5
    assert [soak.waited_s for soak in soaking] == pytest.approx(in_band)
    assert all(soak.surface_c is not None and abs(soak.surface_c - 24.0) <= 2.0 for soak in soaking)


def test_data_are_fresh_although_time_was_leapt() -> None:
    bench = TrackBench("grosch", TEMPERED).leaping()
    track = PlanTrack(bench.plan.name, [part_time(bench.config, bench.plan)])
    watch = RunWatch(bench.run, track, TRACK)
    bench.until(lambda one: one.run.engine.leapt_s > 5.0 and not one.run.engine.renewing, 600.0)
    shown = watch.shown_in(replace(state(), t_s=bench.now), None)
    assert {value.quality for value in shown.values} == {"good"}
    assert max(device.age_s for device in shown.devices if device.age_s is not None) < 1.0


def test_frames_have_rig_time_although_time_was_leapt() -> None:
    bench = TrackBench("grosch", TEMPERED).leaping()
    track = PlanTrack(bench.plan.name, [part_time(bench.config, bench.plan)])
    frames = RunWatch(bench.run, track, TRACK).frames
    bench.until(lambda one: one.run.engine.renewing, 600.0)
    frames.watch(True)
    begun_s = bench.now
    bench.until(lambda one: one.now > begun_s + 0.5, 600.0)
    shown = frames.take()
    assert shown is not None and {frame.bus for frame in shown.frames} > {"can"}
    assert all(begun_s - 0.1 <= frame.t_s <= bench.now for frame in shown.frames)
