"""A plain machine on its wires: from the first frame to standstill, held, stopped, and with every failure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import pytest

from sim import machines
from sim.faults import FaultScript
from sim.faults.can import FaultyCanWire
from tester.base.source import InvalidSource
from tester.machine.manual import ManualExecutor
from tester.machine.plain.context import PlainContext
from tester.machine.plain.served import PlainServed, SpeedHand
from tester.machine.rig_ports import Ports
from tester.machine.run import Outcome
from tester.machine.run_parts import NoHistory
from tester.machine.state import Mode
from tester.run.fault_injection import FaultyRun
from tester.run.simulated import spec_of
from tester.store.recorder import NullRecorder
from tests.tester.machine.plain.bench import QUANTITIES, RIG, Bench, BenchPart, BenchRuns, bench_plan, bench_rig


def speeds(bench: Bench) -> list[float]:
    return [drive.axis.value for drive in bench.twin.axes.values()]


def test_a_recipe_goes_through_every_specimen_and_repeat_and_ends_standing() -> None:
    bench = Bench().until(lambda b: b.run.finished, 600.0)
    assert bench.run.outcome is Outcome.DONE
    assert bench.plant.installed == [(1, "A"), (2, "B")]
    assert bench.plant.repeats == [(row, repeat, 1) for row in (1, 2, 3, 4) for repeat in (1, 2)]
    assert speeds(bench) == [0.0, 0.0] and bench.devices.all_off()


def test_drives_get_the_speeds_of_the_kind_and_samples_count_only_at_speed() -> None:
    bench = Bench().sliding()
    assert speeds(bench) == pytest.approx([10.0, -5.0], rel=0.02)
    assert bench.ctx.gate == 0
    bench.ctx.readings.drives["right"] = -4.0
    assert bench.ctx.closed_gates() == 1


def test_a_zero_is_taken_when_a_specimen_is_put_on() -> None:
    bench = Bench().sliding()
    assert bench.devices.own["cell"].tare == pytest.approx((5.0,), abs=2e-3)
    assert bench.ctx.readings.sensors["cell"][0] == pytest.approx(0.0, abs=2e-3)


@pytest.mark.parametrize(("fast", "ramp_s"), [(False, 0.2), (True, 0.04)])
def test_stop_stops_within_the_ramp_and_takes_the_power_off(fast: bool, ramp_s: float) -> None:
    bench = Bench(bench_plan("recipe: r\nspecimens: [{compound: A}]\nmeasure: {repeats: 1, min_valid: 1}\n"
                             "grids: [{name: g, speed: 40 mm/s}]\n")).sliding()  # fmt: skip
    bench.run.request_stop("stop", fast=fast)
    asked_s = bench.now
    bench.until(lambda b: all(abs(v) < 1.0 for v in speeds(b)), 5.0)
    assert bench.now - asked_s < ramp_s + 0.15
    bench.until(lambda b: b.run.finished, 10.0)
    assert bench.run.outcome is Outcome.STOPPED and bench.devices.all_off()


def test_a_hold_is_at_rest_with_power_and_the_repeat_is_done_again() -> None:
    bench = Bench().sliding()
    assert bench.run.request_hold() == ""
    bench.until(lambda b: b.ctx.readings.standing, 5.0)
    assert bench.control.state.mode is Mode.HOLD and bench.ctx.readings.drives_enabled
    begun = len(bench.plant.repeats)
    assert bench.run.request_release() == ""
    bench.sliding()
    assert bench.plant.repeats[begun:] == [(1, 1, 2)]


def test_after_a_hold_that_lasts_too_long_it_is_stopped() -> None:
    bench = Bench(rig=bench_rig(RIG.replace("hold_at_most: 60 min", "hold_at_most: 3 s"))).sliding()
    bench.run.request_hold()
    bench.until(lambda b: b.run.finished, 20.0)
    assert bench.run.outcome is Outcome.STOPPED


FAULTS = [
    ("left drive fault", "drive fault"), ("right drive heartbeat lost", "drive fault"),
    ("right drive off the bus", ("drive fault", "drive data stale")), ("right drive data lost", "drive data stale"),
    ("right drive in local mode", "drive fault"), ("cell silent", "sensor silent"),
    ("cell CRC errors", "sensor silent"),
    ("cell without supply", "sensor silent"), ("CAN bus off", "CAN silent"), ("CAN adapter gone", "bus lost"),
    ("safety chain opened", "safety chain"), ("guard opened", "guard open"), ("left drive jammed", "drive fault"),
]  # fmt: skip


@pytest.mark.parametrize(("fault", "row"), FAULTS, ids=[fault for fault, _ in FAULTS])
def test_a_fault_trips_its_row_and_the_other_drive_stops(fault: str, row: str | tuple[str, ...]) -> None:
    bench = Bench(can_wire=FaultyCanWire)
    language = machines.find(BenchRuns.plant).language(spec_of(bench.rig))
    script = FaultScript(language.parse_script([f"step slide + 1 s: {fault}"]))
    faulty = FaultyRun(bench.run, bench.twin, script)
    now = 0.0
    while not faulty.finished and now < 60.0:
        faulty.advance(now)
        due = faulty.tick(now)
        now = max(round(min(due, faulty.urgent_s), 6), now + 1e-3)
    assert bench.run.outcome is Outcome.TRIPPED, bench.run.reason
    told = bench.run.reason.partition(":")[0]
    assert told in (row if isinstance(row, tuple) else (row,))
    assert all(abs(v) < 0.5 for v in speeds(bench))


def test_it_is_shown_that_every_drive_stops_without_our_heartbeat_before_anything_moves() -> None:
    bench = Bench().until(lambda b: b.run.connected, 30.0)
    shown = "shown: left stops without our heartbeat, right stops without our heartbeat; NOT shown: drives follow"
    assert bench.run.connector.shown == shown and bench.plant.installed == []


def test_a_drive_without_that_proof_is_reported() -> None:
    text = RIG.replace("node_id: 2,", "node_id: 2, proves_watchdog: false,").replace("withhold: 400", "withhold: 150")
    bench = Bench(rig=bench_rig(text)).until(lambda b: b.run.finished, 30.0)
    assert bench.run.outcome is Outcome.UNREACHABLE
    assert "the left drive did not stop with EMCY 0x8130" in bench.run.reason


class GatedContext(PlainContext):
    """Samples count in the first half of each second."""

    gate_bits: ClassVar[Mapping[str, int]] = {"speed": 1, "half": 2}

    def closed_gates(self) -> int:
        return super().closed_gates() | (2 if self.now % 1.0 >= 0.5 else 0)


class GatedRuns(BenchRuns):
    context: ClassVar[type[PlainContext]] = GatedContext


def test_a_kind_adds_a_gate_of_its_own() -> None:
    bench = Bench(runs=GatedRuns()).sliding()
    panel = PlainServed("bench", GatedRuns(), BenchPart.axes, QUANTITIES, {"left": "Left"}).panel(bench.run.engine)
    bench.until(lambda b: b.ctx.burst > 0 and 0.1 < b.ctx.now % 1.0 < 0.4)
    assert [(gate.key, gate.open) for gate in panel.gates()] == [("speed", True), ("half", True)]
    bench.until(lambda b: b.ctx.now % 1.0 > 0.6)
    assert [(gate.key, gate.open) for gate in panel.gates()] == [("speed", True), ("half", False)]


def test_a_twin_of_its_own_has_the_kinds_rubber_unless_another_is_named() -> None:
    bench, runs = Bench(), BenchRuns()
    runs.mount(bench.twin, "")
    runs.mount(bench.twin, "B")
    assert bench.plant.installed == [(0, "1#"), (0, "B")]


def test_a_person_gives_drives_speeds_in_bounded_steps() -> None:
    rig = bench_rig()
    bench = Bench()
    served = PlainServed("bench", BenchRuns(), BenchPart.axes, QUANTITIES, {"left": "Left", "right": "Right"})
    by_hand = served.by_hand(
        rig, Ports(bench.twin.can, dict(bench.twin.lines)), bench.twin, NullRecorder(), None, NoHistory()
    )
    bench.run = by_hand.run
    executor = by_hand.executor
    assert isinstance(executor, ManualExecutor) and isinstance(executor.hand, SpeedHand)
    bench.until(lambda b: b.ctx.readings.drives_enabled and b.run.connected, 30.0)
    for _ in range(2):
        assert executor.jog(bench.ctx, "left", 1) == ""
        start = bench.now
        bench.until(lambda b, start=start: b.now > start + 0.3)
    bench.until(lambda b: abs(speeds(b)[0] - 10.0) < 0.1, 5.0)
    assert executor.hand.step(bench.ctx, "middle", 1.0) == "there is no drive middle (expected left, right)"
    for _ in range(100):
        executor.hand.step(bench.ctx, "right", -1.0)
    bench.until(lambda b: abs(speeds(b)[1] + 100.0) < 0.5, 5.0)
    panel = served.panel(bench.run.engine)
    assert panel.news()["can"].valid and panel.news()["cell"].valid and panel.gates()[0].open
    assert [check.ok for check in panel.checks()] == [True, True] and panel.mounted() == (0, "")
    assert "sensors are zeroed" in executor.hand.tare(bench.ctx)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("node_id: 2, digital_io: false", "node_id: 2, digital_io: true", "one drive carries the safety chain"),
        ("cell: {profile", "other: {profile", "cell is missing"),
    ],
)
def test_a_rig_file_that_is_no_plain_machine_is_refused(old: str, new: str, message: str) -> None:
    with pytest.raises(InvalidSource, match=message):
        bench_rig(RIG.replace(old, new))


def test_a_drive_in_position_mode_is_refused() -> None:
    text = RIG.replace("mode: velocity, feedback: velocity", "mode: position, feedback: position", 1)
    text = text.replace("position_increments: 0", "position_increments: 1000", 1)
    with pytest.raises(InvalidSource, match="gives its drives speeds"):
        bench_rig(text)
