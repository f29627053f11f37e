"""Leaps: time in which only heat flows passes without scans, and nothing else changes."""

from __future__ import annotations

from dataclasses import fields
from math import inf

import pytest

from tester.kinds.specimen_on_track.process import TrackReadings
from tester.machine.leaps import RENEW_S
from tester.machine.run import Outcome
from tests.tester.kinds.specimen_on_track.bench import TrackBench

TEMPERED = """\
recipe: a block
kind: specimen_on_track
specimens: [{compound: SBR}]
measure: {repeats: 1, min_valid: 1, distance: 0.4 mm, soak: {within: 1 K, for: 120 s}}
grids:
  - {name: one, load: 20 N, temperature: [20 degC, 30 degC], track_speed: 3 mm/s}
"""


@pytest.fixture(scope="module")
def every() -> TrackBench:
    """A run in which every scan is made."""
    return TrackBench("grosch", TEMPERED).to_the_end()


@pytest.fixture(scope="module")
def leapt() -> TrackBench:
    """The same run with leaps."""
    return TrackBench("grosch", TEMPERED).leaping().to_the_end()


def test_results_are_those_of_a_run_with_every_scan(every: TrackBench, leapt: TrackBench) -> None:
    assert leapt.run.outcome is every.run.outcome is Outcome.DONE
    for (_, ours), (_, theirs) in zip(every.kept.results, leapt.kept.results, strict=True):
        assert theirs.mu_resultant == pytest.approx(ours.mu_resultant, rel=1e-5)
        assert theirs.means["contact_c"] == pytest.approx(ours.means["contact_c"], abs=0.005)


def test_most_scans_of_the_wait_are_not_made(every: TrackBench, leapt: TrackBench) -> None:
    assert leapt.run.engine.leapt_s > 100.0
    assert leapt.run.engine.scans < every.run.engine.scans - 15.0 * leapt.run.engine.leapt_s


def test_rig_time_includes_leaps(every: TrackBench, leapt: TrackBench) -> None:
    assert leapt.now == pytest.approx(every.now, abs=1e-3)
    assert leapt.world.now_s == pytest.approx(every.world.now_s - leapt.run.engine.leapt_s, abs=1e-3)


def test_the_record_states_how_much_was_leapt(every: TrackBench, leapt: TrackBench) -> None:
    stated = [float(text.split()[0]) for _, kind, text in leapt.kept.events if kind == "leap"]
    assert sum(stated) == pytest.approx(leapt.run.engine.leapt_s, abs=len(stated))
    assert not [text for _, kind, text in every.kept.events if kind == "leap"]


def test_the_record_of_a_run_stopped_in_a_wait_also_states_it() -> None:
    bench = tempering()
    bench.run.request_stop("asked")
    bench.to_the_end()
    stated = [float(text.split()[0]) for _, kind, text in bench.kept.events if kind == "leap"]
    assert stated == [pytest.approx(bench.run.engine.leapt_s, abs=0.5)]


def tempering() -> TrackBench:
    """Return a run that has leapt and renews its readings."""
    bench = TrackBench("grosch", TEMPERED).leaping()
    return bench.until(lambda one: one.run.engine.renewing, 600.0)


def test_devices_have_reported_anew_before_the_next_scan() -> None:
    bench = tempering()
    engine = bench.run.engine
    before_s, leapt_s = engine.last_scan_s, engine.leapt_s
    bench.until(lambda one: not one.run.engine.renewing, 600.0)
    r = engine.ctx.readings
    assert engine.last_scan_s == pytest.approx(before_s + leapt_s + RENEW_S, abs=0.06)
    assert min(r.air_at_s, r.cell_at_s, r.track_at_s, r.lift_at_s, r.inputs_at_s) > before_s + leapt_s
    assert engine.control.state.last_late_s < 0.001


def test_a_stop_ends_the_renewal_at_once() -> None:
    bench = tempering()
    asked_s = bench.now
    bench.run.request_stop("asked")
    bench.until(lambda one: one.run.engine.last_scan_s >= asked_s, 600.0)
    assert bench.run.engine.last_scan_s - asked_s < 0.06
    assert bench.to_the_end().run.outcome is Outcome.STOPPED


def test_a_stop_during_the_renewal_is_dated_when_it_is_asked() -> None:
    bench = tempering()
    renewing_s = bench.now
    bench.until(lambda one: one.now > renewing_s + 0.8 * RENEW_S, 600.0)
    assert bench.run.engine.renewing
    bench.run.request_stop("asked")
    assert bench.run.engine.control.state.mode_since_s == pytest.approx(bench.now, abs=bench.run.engine.period_s + 0.01)


def test_a_new_step_of_the_plan_is_sent_before_the_next_leap() -> None:
    bench = TrackBench("grosch", TEMPERED).leaping()
    engine = bench.run.engine
    bench.until(lambda one: one.run.engine.leapt_s > 0.0, 600.0)
    begun_s, leapt_s = bench.now, engine.leapt_s
    engine.ctx.progress.step += 1
    bench.until(lambda one: one.now > begun_s + 8.0, 600.0)
    assert engine.leapt_s == leapt_s


def test_nothing_is_leapt_where_no_whole_number_of_scans_fits() -> None:
    bench = TrackBench("grosch", TEMPERED, ["scan.enabled=45 Hz", "scan.idle=45 Hz"]).leaping()
    bench.phase("temper")
    begun_s = bench.now
    bench.until(lambda one: one.now > begun_s + 15.0, 600.0)
    assert bench.run.engine.leapt_s == 0.0


def test_nothing_is_leapt_while_something_is_measured_or_asked() -> None:
    bench = TrackBench("grosch", TEMPERED).leaping()
    assert bench.leaps is not None and "idle" in bench.leaps.hindered(0.0)
    bench.phase("slide")
    assert bench.leaps.hindered(bench.now) == "something moves or is measured"


def test_nothing_is_leapt_while_a_row_holds() -> None:
    bench = TrackBench("grosch", TEMPERED).leaping()
    leaps = bench.leaps
    assert leaps is not None
    bench.until(lambda one: one.run.engine.leapt_s > 0.0, 600.0)
    bench.run.engine.control.state.held = 1
    assert "interlock" in leaps.hindered(bench.now)


def test_every_time_stamp_of_the_readings_moves_with_a_leap() -> None:
    r = TrackReadings()
    stamps = [one.name for one in fields(r) if one.name.endswith("_s") and getattr(r, one.name) in (0.0, -inf)]
    for name in stamps:
        setattr(r, name, 5.0)
    r.later(9.0)
    speeds = {"track_m_s", "track_now_m_s", "sliding_m_s"}
    assert {name for name in stamps if getattr(r, name) != 14.0} <= speeds
