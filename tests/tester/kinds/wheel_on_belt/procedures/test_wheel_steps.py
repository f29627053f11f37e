"""Installing and grinding in a wheel."""

from __future__ import annotations

from collections.abc import Mapping
from math import isnan

import pytest

from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.procedures.motions import Turn
from tester.kinds.wheel_on_belt.procedures.thermal_steps import roll
from tester.kinds.wheel_on_belt.procedures.wheel_steps import Grind, InstallWheel, PreGrindStep
from tester.kinds.wheel_on_belt.recipe.plan_steps import Install, PreGrind
from tester.machine.activity import MoveFailedError
from tester.machine.motions import Power, Sequence
from tests.tester.kinds.wheel_on_belt.bench import Bench, Simulation, make_bench

INSTALL = Install(1, specimen=2, wheel=3, compound="2#", note="NR, N234", replicate=1)
PRE_GRIND = PreGrind(1, 0.8, 0.6, 200.0, 240.0)


class Hands:
    """Keeps what was installed."""

    def __init__(self) -> None:
        self.installed: list[tuple[int, int, str, bool]] = []

    def install(self, specimen: int, wheel: int, compound: str, *, new_specimen: bool) -> None:
        self.installed.append((specimen, wheel, compound, new_specimen))

    def begin_repeat(self, condition: int, repeat: int, attempt: int, held: Mapping[str, float]) -> None:
        raise AssertionError


@pytest.fixture
def bench() -> Bench:
    return make_bench()


def test_a_wheel_is_mounted_only_at_standstill_without_power() -> None:
    bench = make_bench(automatic=False)
    bench.run(roll(0.8, 200.0))
    step = InstallWheel(INSTALL, [])
    bench.hold(step, 5.0)
    waiting = bench.ctx.prompts.waiting
    assert waiting is not None and waiting.text == "install wheel 3: 2# (NR, N234)"
    r, demand = bench.ctx.readings, bench.ctx.demand
    assert r.drives_disabled and r.wheel_speed_m_s == r.belt_speed_m_s == 0.0
    assert demand.press is Press.LIFT and isnan(demand.surface_c)


def test_nothing_is_mounted_before_the_answer() -> None:
    bench = make_bench(automatic=False)
    bench.ctx.attendant = hands = Hands()
    step = InstallWheel(INSTALL, [])
    bench.hold(step, 5.0)
    assert hands.installed == []
    assert bench.ctx.prompts.waiting is not None
    bench.ctx.prompts.waiting.answer = "yes"
    bench.run(step)
    assert hands.installed == [(2, 3, "2#", True)]


def test_another_wheel_of_the_same_specimen_is_no_new_specimen(bench: Bench) -> None:
    bench.ctx.attendant = hands = Hands()
    bench.run(InstallWheel(INSTALL, []))
    bench.run(InstallWheel(Install(2, 2, 4, "2#"), []))
    assert [new for *_, new in hands.installed] == [True, False]


def test_a_new_wheel_is_whole_and_its_contact_unknown(bench: Bench) -> None:
    ctx = bench.ctx
    ctx.wheel.loss_mm, ctx.wheel.sliding_m, ctx.contact.contact_mm = 1.5, 900.0, 12.0
    ctx.readings.wheel_angle_rev = 77.0
    bench.run(InstallWheel(INSTALL, []))
    assert (ctx.wheel.wheel, ctx.wheel.cold_mm, ctx.wheel.sliding_m) == (3, 90.0, 0.0)
    assert isnan(ctx.contact.contact_mm) and 0.0 < ctx.readings.wheel_angle_rev < 5.0  # of the first contact


def test_an_installed_wheel_is_recorded(bench: Bench) -> None:
    bench.run(InstallWheel(INSTALL, []))
    (values,) = bench.notes.written("INSERT OR REPLACE INTO piece")
    assert (values[0], values[1], values[3]) == (3, 2, "2#")


def test_a_new_wheel_gets_a_reference_tare(bench: Bench) -> None:
    reference = [9.0, 9.0, 9.0, 9.0]
    bench.zero_n = 2.0
    bench.run(InstallWheel(INSTALL, reference))
    assert reference == pytest.approx([0.0, 0.0, 2.0, 0.0])


def test_a_wheel_whose_cell_is_silent_is_not_moved(bench: Bench) -> None:
    bench.ctx.readings.cell_valid = False
    with pytest.raises(MoveFailedError, match="load cell"):
        bench.run(InstallWheel(INSTALL, []))
    assert not bench.ctx.demand.enabled


def test_a_wheel_whose_cell_falls_silent_in_its_tare_fails(bench: Bench) -> None:
    step = InstallWheel(INSTALL, [])
    bench.until(step, lambda: step.contact is not None and step.contact.tare is not None and bench.ctx.demand.enabled)
    bench.ctx.readings.cell_valid = False
    bench.run(step)
    assert "load cell" in step.failed


def test_grinding_counts_only_with_the_load_in_band(bench: Bench) -> None:
    bench.run(Sequence(roll(0.8, 200.0), Turn(0.8, 0.6)))
    grind = Grind(200.0, 20.0)
    bench.hold(grind, 5.0)
    counted = grind.done_s
    bench.off_n = 6.0
    bench.hold(grind, 5.0)
    # The one-second average needs its time to leave the band.
    assert counted == pytest.approx(5.0, abs=0.05) and grind.done_s < counted + 1.5


@pytest.mark.parametrize("wheel, belt", [(0.8, 0.58), (0.78, 0.6), (0.0, 0.6), (float("nan"), 0.6)])
def test_grinding_counts_only_with_both_speeds_reached(bench: Bench, wheel: float, belt: float) -> None:
    bench.run(Sequence(roll(0.8, 200.0), Turn(0.8, 0.6)))
    grind = Grind(200.0, 20.0)
    bench.follow = False
    bench.ctx.readings.wheel_speed_m_s, bench.ctx.readings.belt_speed_m_s = wheel, belt
    bench.hold(grind, 1.0)
    assert grind.done_s == 0.0


def test_an_interval_counts_only_when_both_its_ends_are_in_order(bench: Bench) -> None:
    bench.run(Sequence(roll(0.8, 200.0), Turn(0.8, 0.6)))
    grind = Grind(200.0, 20.0)
    bench.scan(grind, dt=0.01)
    assert grind.done_s == 0.0


def test_grinding_takes_its_time_and_leaves_the_wheel_lifted(bench: Bench) -> None:
    bench.run(Sequence(Power(True), PreGrindStep(PRE_GRIND)), at_most_s=300.0)
    ground = [d for d in bench.demands if d.belt_speed_m_s == 0.6 and d.press is Press.LOAD]
    assert 0.01 * len(ground) == pytest.approx(240.0, abs=0.1)
    assert bench.ctx.demand.press is Press.LIFT


def test_slip_comes_after_the_load_and_goes_before_it(bench: Bench) -> None:
    bench.run(PreGrindStep(PRE_GRIND), at_most_s=300.0)
    slipping = [i for i, d in enumerate(bench.demands) if d.belt_speed_m_s == 0.6]
    assert bench.demands[slipping[0] - 1].press is bench.demands[slipping[-1] + 1].press is Press.LOAD


def test_no_heat_is_wanted_while_grinding(bench: Bench) -> None:
    bench.run(PreGrindStep(PRE_GRIND), at_most_s=300.0)
    assert all(isnan(demand.surface_c) for demand in bench.demands)


def ground_seconds(run: Simulation) -> tuple[float, list[dict[str, float]]]:
    """Return the seconds of a run's pre-grinding with both speeds reached, and its samples."""
    rows = [row for row in run.rows(repeat_key=0.0) if abs(row["belt_speed_m_s"] - 0.6) <= 0.006]
    rows = [row for row in rows if abs(row["wheel_speed_m_s"] - 0.8) <= 0.008 and row["force_z_n"] > 150.0]
    return rows[-1]["time_s"] - rows[0]["time_s"], rows


def test_a_rig_grinds_for_240_s_with_both_speeds_reached(noisy_run: Simulation) -> None:
    assert ground_seconds(noisy_run)[0] == pytest.approx(240.0, abs=0.1)


def test_a_rig_grinds_with_the_load_in_band(noisy_run: Simulation) -> None:
    rows = ground_seconds(noisy_run)[1]
    per_second = [rows[i : i + 100] for i in range(0, len(rows) - 100, 100)]
    loads = [sum(row["force_z_n"] for row in second) / len(second) for second in per_second]
    assert min(loads) > 196.0 and max(loads) < 204.0
