"""The moves: each demands its target, and is done when the readings show it."""

from __future__ import annotations

from math import nan

import pytest

from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.procedures.motions import Lift, Load, TakeTare, Turn, Yaw
from tester.machine.activity import MoveFailedError
from tester.machine.motions import Ask, Power, Sequence
from tests.tester.kinds.wheel_on_belt.bench import Bench, make_bench


@pytest.fixture
def bench() -> Bench:
    return make_bench()


@pytest.fixture
def turning() -> Bench:
    """The wheel turns on the belt, lifted, at matched speeds."""
    bench = make_bench()
    bench.run(Sequence(Power(True), Turn(0.8, 0.8)))
    return bench


class After:
    """Done with the n-th scan; keeps when it was stepped."""

    def __init__(self, scans: int) -> None:
        self.scans = scans
        self.stepped: list[float] = []

    def step(self, ctx: Context) -> bool:
        self.stepped.append(ctx.now)
        return len(self.stepped) >= self.scans


class Wait:
    """Done when its seconds are over."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.began_s = nan

    def step(self, ctx: Context) -> bool:
        if self.began_s != self.began_s:
            self.began_s = ctx.now
        return ctx.now - self.began_s >= self.seconds - 1e-9


def test_a_sequence_steps_its_parts_one_after_the_other(bench: Bench) -> None:
    first, second = After(3), After(2)
    bench.run(Sequence(first, second))
    assert len(first.stepped) == 3 and len(second.stepped) == 2
    assert first.stepped[-1] < second.stepped[0]


def test_a_move_that_overruns_its_time_fails_and_is_named(bench: Bench) -> None:
    bench.follow = False
    with pytest.raises(MoveFailedError, match="switching the drives not done after 20 s"):
        bench.hold(Sequence(Power(True)), 21.0)


def test_the_time_of_a_move_begins_with_it(bench: Bench) -> None:
    bench.hold(Sequence(Wait(25.0), Power(True)), 24.0)
    assert not bench.ctx.demand.enabled


def test_an_empty_sequence_is_done_at_once(bench: Bench) -> None:
    assert bench.scan(Sequence())


def test_power_waits_for_every_drive(bench: Bench) -> None:
    bench.follow = False
    power = Power(True)
    bench.hold(power, 0.1)
    assert bench.ctx.demand.enabled
    bench.ctx.readings.drives_enabled = True
    assert bench.scan(power)


def test_power_off_waits_until_no_drive_has_power(bench: Bench) -> None:
    bench.follow = False
    bench.ctx.readings.drives_disabled = False
    off = Power(False)
    bench.hold(off, 0.1)
    bench.ctx.readings.drives_disabled = True
    assert bench.scan(off)


def test_lift_takes_the_load_off(turning: Bench) -> None:
    turning.run(Load(200.0))
    turning.run(Lift())
    assert turning.ctx.demand.press is Press.LIFT and turning.ctx.readings.force_z_n == 0.0


def test_lift_is_not_done_while_there_is_force(turning: Bench) -> None:
    turning.run(Load(200.0))
    turning.follow = False
    lift = Lift()
    turning.ctx.contact.in_contact = False
    turning.hold(lift, 0.5)
    turning.ctx.readings.force_z_n = nan
    turning.hold(lift, 0.1)
    turning.ctx.readings.force_z_n = 4.9
    assert turning.scan(lift)


def test_lift_ends_at_the_lifted_position_where_the_cell_s_zero_has_drifted(turning: Bench) -> None:
    turning.run(Load(200.0))
    turning.zero_n = 7.0
    turning.run(Lift(), at_most_s=1.0)
    assert turning.ctx.readings.force_z_n == pytest.approx(7.0, abs=1.0)


def test_turn_waits_for_both_speeds(bench: Bench) -> None:
    bench.follow = False
    turn = Turn(0.8, 0.5)
    r = bench.ctx.readings
    for wheel, belt in ((0.8, 0.0), (0.0, 0.5), (0.8, nan), (0.8, 0.49)):
        r.wheel_speed_m_s, r.belt_speed_m_s = wheel, belt
        assert not bench.scan(turn)
    r.belt_speed_m_s = 0.496
    assert bench.scan(turn)


def test_load_waits_until_the_load_has_stood_in_band(turning: Bench) -> None:
    load = Load(200.0, for_s=1.0)
    assert turning.run(load) >= 1.0
    assert turning.ctx.demand.load_n == 200.0


def test_load_that_leaves_its_band_starts_to_wait_again(turning: Bench) -> None:
    load = Load(200.0, for_s=1.0)
    turning.hold(load, 0.8)
    turning.off_n = 40.0
    turning.hold(load, 0.1)
    turning.off_n = 0.0
    assert turning.run(load) >= 0.99


def test_yaw_waits_for_the_angles_and_for_the_drives_confirmation(bench: Bench) -> None:
    bench.follow = False
    yaw = Yaw({"sideslip": 20.0, "camber": 0.0})
    r = bench.ctx.readings
    for sideslip, camber, reached in ((19.9, 0.0, True), (20.0, 0.1, True), (20.0, 0.0, False), (nan, 0.0, True)):
        r.positions, r.yaw_reached = {"sideslip": sideslip, "camber": camber}, reached
        assert not bench.scan(yaw)
    r.positions["sideslip"], r.yaw_reached = 20.0, True
    assert bench.scan(yaw)


def test_wait_takes_its_time(bench: Bench) -> None:
    assert bench.run(Wait(1.0)) == pytest.approx(1.01)


@pytest.mark.parametrize("move", [Power(True), Lift(), Turn(0.1, 0.1), Load(100.0), Yaw({"sideslip": 1.0})])
def test_whatever_moves_asks_for_fast_scans(bench: Bench, move: Power | Lift | Turn | Load | Yaw) -> None:
    bench.follow = False
    bench.scan(move)
    assert bench.ctx.moving


def test_a_question_waits_for_its_answer() -> None:
    bench = make_bench(automatic=False)
    ask = Ask("install wheel 1")
    bench.hold(ask, 1.0)
    waiting = bench.ctx.prompts.waiting
    assert waiting is not None and waiting.text == "install wheel 1"
    waiting.answer = "done"
    assert bench.scan(ask)
    assert bench.ctx.prompts.waiting is None


def test_a_question_and_its_answer_are_journalled(bench: Bench) -> None:
    bench.run(Ask("check wear"))
    (asked,) = bench.notes.written("INSERT INTO prompt")
    (answered,) = bench.notes.written("UPDATE prompt")
    assert "check wear" in asked and "yes (automatic)" in answered


def test_an_open_guard_is_no_reason_to_wait_without_a_question(bench: Bench) -> None:
    bench.ctx.readings.guard_closed = False
    assert bench.scan(Ask("check wear"))


def test_a_question_is_put_once() -> None:
    bench = make_bench(automatic=False)
    bench.hold(Ask("check wear"), 0.5)
    assert len(bench.ctx.prompts.asked) == 1


def tare(reference: list[float]) -> TakeTare:
    return TakeTare(1.0, reference)


def test_a_tare_takes_the_mean_of_the_unloaded_cell(turning: Bench) -> None:
    turning.zero_n = 3.0
    turning.run(tare([]))
    assert turning.cell.tare == pytest.approx((0.0, 0.0, 3.0, 0.0))
    turning.scan(Wait(1.0))
    assert turning.ctx.readings.force_z_n == pytest.approx(0.0)


def test_a_second_tare_adds_to_the_first(turning: Bench) -> None:
    for turning.zero_n in (3.0, 4.0):
        turning.run(tare([]))
    assert turning.cell.tare[2] == pytest.approx(4.0)


def test_the_first_tare_of_a_wheel_is_its_reference(turning: Bench) -> None:
    reference: list[float] = []
    turning.zero_n = 3.0
    turning.run(tare(reference))
    assert reference[2] == pytest.approx(3.0)
    turning.zero_n = 4.0
    turning.run(tare(reference))
    assert reference[2] == pytest.approx(3.0)
    kinds = [values[1] for values in turning.notes.written("INSERT INTO tare")]
    assert kinds == ["reference", "repeat"]


@pytest.mark.parametrize("drift, warned, failed", [(4.0, False, False), (6.0, True, False), (21.0, True, True)])
def test_a_wandered_zero_warns_and_then_fails(turning: Bench, drift: float, warned: bool, failed: bool) -> None:
    reference = [0.0, 0.0, 0.0, 0.0]
    turning.zero_n = drift
    taken = tare(reference)
    turning.run(taken)
    assert bool(turning.notes.texts("tare")) is warned and bool(taken.failed) is failed


@pytest.mark.parametrize(("ends_run", "zero_n", "taken"), [(True, 40.0, 2), (False, 3.0, 1)])
def test_a_zero_that_has_wandered_too_far_is_taken_only_where_it_ends_the_run(
    turning: Bench, ends_run: bool, zero_n: float, taken: int
) -> None:
    reference: list[float] = []
    turning.zero_n = 3.0
    turning.run(tare(reference))
    turning.zero_n = 40.0
    second = TakeTare(1.0, reference, ends_run=ends_run)
    turning.run(second)
    assert "drifted by 37.0 N" in second.failed
    assert turning.cell.tare[2] == pytest.approx(zero_n) and reference[2] == pytest.approx(3.0)
    assert len(turning.notes.written("INSERT INTO tare")) == taken


@pytest.mark.parametrize("zero_n", [21.0, -21.0])
def test_a_reference_tare_beyond_the_bound_of_an_unloaded_cell_is_not_taken(turning: Bench, zero_n: float) -> None:
    reference: list[float] = []
    turning.zero_n = zero_n
    taken = tare(reference)
    turning.run(taken)
    assert "arming.unloaded" in taken.failed
    assert turning.cell.tare == (0.0, 0.0, 0.0, 0.0) and not reference


def test_drift_is_measured_from_the_reference_not_from_the_tare_before(turning: Bench) -> None:
    reference: list[float] = []
    for turning.zero_n in (0.0, 4.0, 8.0):
        turning.run(tare(reference))
    assert turning.notes.texts("tare") == ["load cell zero drifted by 8.0 N since the wheel's reference tare"]


def test_a_reading_is_averaged_once(turning: Bench) -> None:
    turning.follow = False
    r = turning.ctx.readings
    taken = tare([])
    for i in range(120):
        if i % 10 == 0:
            r.cell_at_s, r.force_z_n = turning.now + 0.01, 1.0 if i < 60 else 2.0
        turning.scan(taken)
    assert taken.count <= 12


def test_a_tare_of_a_silent_cell_fails(turning: Bench) -> None:
    turning.follow = False
    turning.ctx.readings.cell_valid = False
    taken = tare([])
    turning.run(taken, at_most_s=30.0)
    assert taken.failed and turning.cell.tare == (0.0, 0.0, 0.0, 0.0)
