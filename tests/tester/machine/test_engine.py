"""The scan: its rate follows the state, it decides before it sends, and its state can be copied."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from itertools import pairwise

import pytest

from drivers.cia402 import State
from drivers.temperature_controller import JACKET_LEASE_S
from tester.kinds.wheel_on_belt.image.devices import Devices
from tester.kinds.wheel_on_belt.image.process_image import Press, Setpoints
from tester.machine.engine import Engine
from tester.machine.motions import Power
from tester.machine.state import Mode
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Scan, Simulation

OVERCURRENT = 0x2310
"""Error code of a drive: continuous over current (CiA 402)."""


class Frames:
    """A watcher that keeps the computer's frames."""

    def __init__(self) -> None:
        self.sent: list[tuple[int, bytes]] = []

    def frame(self, t: float, can_id: int, data: bytes, from_pc: bool) -> None:
        if from_pc:
            self.sent.append((can_id, data))


@pytest.fixture
def running(mid_burst: Simulation) -> Simulation:
    """A run in the middle of a burst."""
    return deepcopy(mid_burst)


def periods(run: Simulation, chosen: Callable[[Scan], bool]) -> list[float]:
    """Return the seconds from scan to scan where both are chosen."""
    return [b.at_s - a.at_s for a, b in pairwise(run.scans) if chosen(a) and chosen(b)]


def test_there_are_100_scans_a_second_while_there_is_slip(noisy_run: Simulation) -> None:
    found = periods(noisy_run, lambda scan: scan.slip_m_s > 0.05)
    assert len(found) > 20_000 and max(found) == pytest.approx(0.01, abs=1e-5)


def test_there_are_20_scans_a_second_in_rolling_contact(rolling_run: Simulation) -> None:
    found = periods(rolling_run, lambda scan: scan.title.startswith("1#") and scan.press is Press.LOAD)
    assert sum(1 for period in found if period == pytest.approx(0.05, abs=1e-5)) > 0.8 * len(found)
    assert max(found) < 0.0501


def test_there_are_10_scans_a_second_while_all_drives_are_off(noisy_run: Simulation) -> None:
    found = periods(noisy_run, lambda scan: scan.title.startswith("rest") and scan.drives_disabled)
    assert len(found) > 250 and sorted(found)[len(found) // 2] == pytest.approx(0.1, abs=1e-5)


def test_no_scan_is_later_than_a_tenth_of_a_second(noisy_run: Simulation) -> None:
    assert max(b.at_s - a.at_s for a, b in pairwise(noisy_run.scans)) < 0.1001


def test_angles_turn_at_the_sliding_rate(yawed_run: Simulation) -> None:
    times = [row["time_s"] for row in yawed_run.rows() if 1.0 < row["sideslip_deg"] < 19.0]
    scans = [scan.at_s for scan in yawed_run.scans if times[0] <= scan.at_s <= times[0] + 0.3]
    assert scans and all(b - a < 0.011 for a, b in pairwise(scans))


def test_every_scan_in_contact_is_recorded(quiet_run: Simulation) -> None:
    recorded = set(quiet_run.column("time_s"))
    assert all(scan.at_s in recorded for scan in quiet_run.scans if scan.press is Press.LOAD)


def test_a_fault_trips_before_the_next_regular_scan(running: Simulation) -> None:
    engine = running.run.engine
    running.until(lambda s: engine.last_scan_s + 0.009 < engine.next_scan_s)
    regular = engine.next_scan_s
    running.world.advance(engine.last_scan_s + 0.002)
    running.world.axes["wheel"].fault(OVERCURRENT)
    running.now = running.world.urgent_s
    running.until(lambda s: engine.control.state.mode is Mode.FAST_STOP)
    assert engine.last_scan_s < regular


def test_a_trip_sends_safe_outputs_in_its_scan(running: Simulation) -> None:
    frames = Frames()
    running.world.can.watch(frames.frame)
    running.world.axes["belt"].fault(OVERCURRENT)
    control = running.run.engine.control
    while control.state.mode is Mode.RUN:
        frames.sent.clear()
        running.tick()
    out = control.state.setpoints
    assert (out.heat, out.contactor, out.wheel_rad_s, out.belt_m_s) == (False, False, 0.0, 0.0)
    assert out.press_mm_s == -running.ctx.rig.axes.press.max_speed and out.quick_stop, "as fast as the press goes"
    words = {can_id: int.from_bytes(data[:2], "little") for can_id, data in frames.sent if 0x201 <= can_id <= 0x203}
    # Controlword bit 2 clear: quick stop (CiA 402); the press continues to retract.
    assert not words[0x201] & 4 and words[0x203] & 4


def test_a_trip_is_journalled_before_its_outputs_leave(running: Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[tuple[bool, int]] = []
    apply = Devices.apply

    def spy(devices: Devices, out: Setpoints) -> None:
        seen.append((out.quick_stop, len(running.notes.written("INSERT INTO trip"))))
        apply(devices, out)

    monkeypatch.setattr(Devices, "apply", spy)
    running.world.axes["belt"].fault(OVERCURRENT)
    running.until(lambda s: s.run.engine.control.state.mode is Mode.FAST_STOP)
    assert seen[-1] == (True, 1) and all(trips == 0 for stopped, trips in seen if not stopped)


def test_an_emergency_of_a_drive_is_journalled(running: Simulation) -> None:
    running.world.axes["belt"].fault(OVERCURRENT)
    running.until(lambda s: bool(s.notes.texts("emergency")))
    (text,) = running.notes.texts("emergency")
    assert text.startswith("belt drive: ") and "(0x2310)" in text


def test_a_trip_during_a_burst_commits_no_repeat(running: Simulation) -> None:
    running.world.axes["belt"].fault(OVERCURRENT)
    running.to_the_end()
    assert running.notes.written("UPDATE repeat") == []
    assert len(running.notes.written("INSERT INTO repeat")) == 1


def test_nothing_moves_once_a_trip_has_latched(running: Simulation) -> None:
    running.world.axes["belt"].fault(OVERCURRENT)
    running.until(lambda s: s.run.engine.control.state.mode is Mode.LATCHED)
    angle = running.world.plant.wheel_angle_rev
    for _ in range(20):
        running.tick()
    assert running.world.plant.wheel_angle_rev == angle and abs(running.world.plant.force_z_n) < 5.0


def test_the_rig_is_safe_within_three_seconds_of_a_trip(running: Simulation) -> None:
    running.world.axes["wheel"].fault(OVERCURRENT)
    running.until(lambda s: s.run.engine.control.state.mode is not Mode.RUN)
    tripped = running.now
    while running.now < tripped + 3.0 and not running.run.finished:
        running.tick()
    world = running.world
    assert world.plant.force_z_n < 5.0 and world.jacket.heater_w == 0.0
    assert abs(world.axes["wheel"].axis.value) * 0.045 < 0.01 and abs(world.axes["belt"].axis.value) < 0.01


def test_sliding_and_wear_are_those_of_the_plant(noisy_run: Simulation) -> None:
    wheel, plant = noisy_run.ctx.wheel, noisy_run.world.plant
    assert wheel.sliding_m == pytest.approx(plant.sliding_m, rel=0.02)
    assert wheel.cold_mm == pytest.approx(plant.cold_mm, abs=0.01)


def test_a_copy_in_the_middle_of_a_burst_continues_identically(mid_burst: Simulation) -> None:
    first, second = deepcopy(mid_burst), deepcopy(mid_burst)
    for run in (first, second):
        run.until(lambda s: s.now > mid_burst.now + 8.0)
    assert first.notes.rows == second.notes.rows and first.ticks == second.ticks
    assert len(first.notes.rows) > len(mid_burst.notes.rows) + 100


def test_a_copy_shares_nothing_with_its_original(mid_burst: Simulation) -> None:
    copied = deepcopy(mid_burst)
    rows, force = len(mid_burst.notes.rows), mid_burst.world.plant.force_z_n
    copied.until(lambda s: s.now > mid_burst.now + 5.0)
    assert len(mid_burst.notes.rows) == rows and mid_burst.world.plant.force_z_n == force


def test_a_copied_run_ends_like_its_original(mid_burst: Simulation) -> None:
    copied, straight = deepcopy(mid_burst).to_the_end(), Simulation(seed=1).to_the_end()
    assert copied.notes.rows == straight.notes.rows and copied.run.outcome is straight.run.outcome


def test_a_late_scan_does_not_delay_the_ones_after_it(mid_burst: Simulation) -> None:
    engine: Engine = deepcopy(mid_burst).run.engine
    engine.next_scan_s, engine.ctx.moving = 100.0, True
    engine._choose_rate(100.004)  # pyright: ignore[reportPrivateUsage]
    assert engine.next_scan_s == pytest.approx(100.01)


def test_drives_are_off_when_a_run_has_ended(quiet_run: Simulation) -> None:
    states = {axis.state for axis in quiet_run.run.engine.devices.drives}
    assert states <= {State.SWITCH_ON_DISABLED, State.READY_TO_SWITCH_ON}
    assert Power(False).step(quiet_run.ctx)


def test_a_rig_that_is_abandoned_is_unloaded_by_one_transmission(running: Simulation) -> None:
    plant, abandoned_s = running.world.plant, running.now
    assert plant.force_z_n > 150.0
    running.run.abandon()
    running.world.advance(abandoned_s + 0.19)  # no drive has missed our heartbeat for its 200 ms yet
    assert plant.force_z_n < 100.0


def test_a_rig_that_is_abandoned_quick_stops_with_the_heat_off(running: Simulation) -> None:
    running.run.abandon()
    out = running.run.engine.control.state.setpoints
    assert out.quick_stop and not out.contactor and not out.heat


def test_a_rig_that_is_abandoned_loses_its_heat_by_the_contactor_and_its_jackets_output_by_the_lease() -> None:
    heating = Simulation(SHORT.replace("25 degC", "60 degC"), seed=1)
    heating.until(lambda s: s.ctx.readings.heat_percent > 20.0 and s.ctx.readings.contactor_closed)
    latest_s = 0.0
    for _ in range(10):  # in some of them the serial line is free, and standby gets through at once
        heating.until(lambda s, since_s=heating.now: s.now > since_s + 0.037)
        left = deepcopy(heating)
        assert left.world.jacket.heater_w > 0.0
        left.run.abandon()
        left.world.advance(left.now + 0.05)
        io = left.world.axes["press"].io
        assert io is not None and not io.contactor_closed
        after_s = 0.05
        while left.world.jacket.heater_w > 0.0:
            after_s += 0.05
            left.world.advance(left.now + after_s)
            assert after_s < JACKET_LEASE_S + 0.2
        latest_s = max(latest_s, after_s)
    assert latest_s > 0.5, "it was the lease"


def test_a_rig_that_is_abandoned_while_it_connects_is_left_without_a_word() -> None:
    simulation = Simulation()
    simulation.tick()
    simulation.run.abandon()
    assert not simulation.run.connected
