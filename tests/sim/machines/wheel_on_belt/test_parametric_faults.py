"""Faults with a magnitude: their ranges, their texts, and their effect on readings and motion."""

from __future__ import annotations

from copy import deepcopy
from functools import cache
from math import exp

import pytest

from sim.faults import FaultScript, Scene
from sim.faults.sensors import Slow
from sim.machines.wheel_on_belt.faults.heat import DETACHED_S
from sim.machines.wheel_on_belt.rig import WheelRig
from sim.nodes.motion import VelocityAxis
from tester.kinds import load_rig
from tester.run.simulated import spec_of
from tests.campaigns.faults.parametric import CATALOGUE, PARAMETRIC, Parametric
from tests.campaigns.faults.recipes import GRID, language_of

LANGUAGE = language_of(GRID[0])
QUIET = ["sim.noise=0", "sim.scatter=0", "sim.running_in=0"]
LOADED_MM = 11.9
UNDONE = [
    name for name in CATALOGUE
    if name.endswith((" gain", " lag", " delay", "reversed", "exchanged", "swapped", " scale", "doubled", "detached"))
    or name in ("wheel diameter", "rubber relaxation")
    or name == "belt slips on its roller"
]  # fmt: skip
"""Faults that leave the rig as it was when they end."""


class FaultlessComputer:
    """A computer without faults."""

    def stall(self, seconds: float) -> None: ...

    def kill(self) -> None: ...

    def jump(self, seconds: float) -> None: ...

    def operate(self, action: str) -> None: ...


class Hub:
    """A hub's temperature, set by hand."""

    def __init__(self, hub_c: float) -> None:
        self.hub_c = hub_c

    def controller_measured_c(self, t: float) -> float:
        return self.hub_c


@cache
def sliding() -> WheelRig:
    """A rig that slides at 0.3 m/s under some 200 N; to be copied."""
    config = load_rig("sim", QUIET)
    rig = WheelRig(spec_of(config), config.sim, 0)
    rig.install(1, 1, "1#", new_specimen=True)
    rig.advance(1.0)
    turn(rig, 0.8 / 0.045, 0.5)
    rig.axes["press"].axis.position = LOADED_MM
    rig.advance(3.0)
    return rig


def turn(rig: WheelRig, wheel_rad_s: float, belt_m_s: float) -> None:
    for name, speed in (("wheel", wheel_rad_s), ("belt", belt_m_s)):
        axis = rig.axes[name].axis
        assert isinstance(axis, VelocityAxis)
        axis.aim(speed)


def under(fault: str, seconds: float = 0.5, *, lifted: bool = False) -> WheelRig:
    """Return the rig this long after a fault has begun."""
    rig = deepcopy(sliding())
    if lifted:
        rig.axes["press"].axis.position = 0.0
        rig.advance(rig.now_s + 0.1)
    play(rig, fault, seconds)
    return rig


def play(rig: WheelRig, fault: str, seconds: float) -> None:
    script, scene, end_s = FaultScript(), Scene(rig, FaultlessComputer()), rig.now_s + seconds
    script.add([LANGUAGE.parse(f"t={rig.now_s:.6f} s: {fault}")])
    while rig.now_s < end_s - 1e-9:
        script.act(scene, rig.now_s + 1e-6)
        script.renew(scene, rig.now_s)
        rig.advance(rig.now_s + 0.01)


def forces(rig: WheelRig) -> tuple[float, float, float, float]:
    return rig.cell.source.forces_measured(rig.now_s)


@pytest.mark.parametrize("row", PARAMETRIC.values(), ids=lambda row: row.kind.phrase)
def test_every_row_can_be_written_at_both_ends_and_between(row: Parametric) -> None:
    assert row.ends and row.normal not in row.ends
    for end in row.ends:
        assert row.between(end, 0.0) == row.normal and row.between(end, 1.0) == end
        for share in (0.25, 1.0):
            value = row.between(end, share)
            found = LANGUAGE.parse(f"t=1 s: {row.text(value)}")
            assert found.kind is row.kind and found.value == pytest.approx(value, rel=1e-5)
            assert found.kind.effect(found.value) is not found.kind.effect(found.value)


def test_a_hub_sensor_that_has_come_loose_shows_too_little_and_late() -> None:
    rig = deepcopy(sliding())
    ambient_c = rig.plant.parameters.ambient
    rig.jacket.source = hub = Hub(ambient_c)
    play(rig, "hub sensor partly detached 80 %", 0.5)
    hub.hub_c = ambient_c + 100.0
    now, shown = rig.now_s, rig.jacket.source
    assert shown.controller_measured_c(now) < ambient_c + 5.0
    assert shown.controller_measured_c(now + DETACHED_S) == pytest.approx(ambient_c + 80.0 * (1.0 - exp(-1.0)), abs=2.0)
    assert shown.controller_measured_c(now + 20.0 * DETACHED_S) == pytest.approx(ambient_c + 80.0)


@pytest.mark.parametrize(("least", "most", "normal"), [(1.0, 2.0, 0.0), (0.0, 0.0, 0.0)])
def test_a_range_without_its_normal_value_is_refused(least: float, most: float, normal: float) -> None:
    with pytest.raises(ValueError, match="load cell offset"):
        Parametric(CATALOGUE["load cell offset"], least, most, normal)


def test_a_belt_that_slips_is_slower_than_its_roller_and_the_rig_knows_by_how_much() -> None:
    rig = under("belt slips on its roller 40 %")
    assert rig.axes["belt"].axis.value == 0.5 and rig.belt_m_s == pytest.approx(0.3)
    assert rig.belt_slip == pytest.approx(0.4)


@pytest.mark.parametrize(("percent", "share"), [(70, 0.7), (130, 1.3)])
def test_load_cell_gain_is_of_the_normal_force_alone(percent: int, share: float) -> None:
    rig = under(f"load cell gain {percent} %")
    plant = rig.plant
    assert forces(rig)[:3] == pytest.approx((plant.force_x_n, plant.force_y_n, share * plant.force_z_n))


@pytest.mark.parametrize(
    ("fault", "signs"),
    [
        ("load cell Fx reversed", (-1, 1, 1)),
        ("load cell Fy reversed", (1, -1, 1)),
        ("load cell Fz reversed", (1, 1, -1)),
    ],
)
def test_a_reversed_channel_changes_its_sign(fault: str, signs: tuple[int, int, int]) -> None:
    rig = deepcopy(sliding())
    rig.axes["sideslip"].axis.position = 10.0
    play(rig, fault, 0.2)
    true = (rig.plant.force_x_n, rig.plant.force_y_n, rig.plant.force_z_n)
    assert min(map(abs, true)) > 10.0
    assert forces(rig)[:3] == pytest.approx([sign * force for sign, force in zip(signs, true, strict=True)])


def test_exchanged_channels_show_each_other() -> None:
    rig = under("load cell Fx and Fz exchanged")
    assert forces(rig)[0] == rig.plant.force_z_n and forces(rig)[2] == rig.plant.force_x_n
    assert rig.plant.force_z_n - rig.plant.force_x_n > 20.0


@pytest.mark.parametrize("percent", [80, 120])
def test_a_common_supply_is_that_of_both_thermometers(percent: int) -> None:
    rig = deepcopy(sliding())
    rig.plant.heat.set_all(83.0)
    play(rig, f"common temperature supply gain {percent} %", 1.5)
    t = rig.now_s
    shown = [rig.jacket.source.controller_measured_c(t) - 23.0, rig.ir.source.surface_measured_c(t) - 23.0]
    true = [rig.plant.controller_measured_c(t) - 23.0, rig.plant.surface_measured_c(t) - 23.0]
    assert shown == pytest.approx([0.01 * percent * one for one in true])


def test_a_filter_of_first_order_reaches_two_thirds_in_its_time() -> None:
    slow = Slow("lag", 2.0)
    assert slow.shown((10.0, 0.0), 0.0) == (10.0, 0.0)
    assert slow.shown((20.0, 1.0), 2.0) == pytest.approx((16.32, 0.632), abs=2e-3)


def test_a_delay_shows_past_readings() -> None:
    slow = Slow("delay", 0.5)
    shown = [slow.shown((float(i),), 0.1 * i)[0] for i in range(20)]
    assert shown[:6] == [0.0] * 6 and shown[19] == 14.0


@pytest.mark.parametrize("fault", ["load cell lag 1 s", "load cell delay 1 s"])
def test_a_slow_load_cell_still_shows_a_load_that_has_gone(fault: str) -> None:
    rig = deepcopy(sliding())
    script, scene = (
        FaultScript().add([LANGUAGE.parse(f"t={rig.now_s:.6f} s: {fault}")]),
        Scene(rig, FaultlessComputer()),
    )
    script.act(scene, rig.now_s + 1e-6)
    before_n = forces(rig)[2]
    rig.axes["press"].axis.position = 0.0
    rig.advance(rig.now_s + 0.1)
    assert rig.plant.force_z_n == 0.0 and forces(rig)[2] > 0.85 * before_n > 100.0


@pytest.mark.parametrize(("axis", "slip_m_s"), [("wheel", 1.3), ("belt", 1.3)])
def test_a_reversed_drive_turns_the_other_way_round_and_shows_nothing_of_it(axis: str, slip_m_s: float) -> None:
    rig = under(f"{axis} drive reversed")
    shown = [rig.axes["wheel"].axis.value * 0.045, rig.axes["belt"].axis.value]
    assert shown == pytest.approx([0.8, 0.5]) and rig.plant.slip_m_s == pytest.approx(slip_m_s, rel=0.01)
    given_w = rig.axes["wheel"].torque_nm * shown[0] / 0.045 + rig.axes["belt"].torque_nm * shown[1] / 0.05
    assert given_w in (0.0, pytest.approx(rig.plant.mu * rig.plant.force_z_n * rig.plant.slip_m_s, rel=0.1))


@pytest.mark.parametrize(("axis", "percent"), [("wheel", 110), ("wheel", 200), ("belt", 90), ("belt", 110)])
def test_a_wrong_scale_makes_another_speed_of_the_one_shown(axis: str, percent: int) -> None:
    rig = under(f"{axis} speed scale {percent} %")
    share = 0.01 * percent
    wheel, belt = (0.8 * share, 0.5) if axis == "wheel" else (0.8, 0.5 * share)
    assert (rig.rim_m_s, rig.belt_m_s) == pytest.approx((wheel, belt), rel=2e-3)


def test_swapped_drives_move_each_others_axis() -> None:
    rig = under("wheel and belt drives swapped")
    assert rig.wheel_rad_s == pytest.approx(0.5 / 0.05) and rig.belt_m_s == pytest.approx(0.8 / 0.045 * 0.05)


@pytest.mark.parametrize("percent", [90, 110])
def test_a_wheel_of_another_diameter_is_touched_elsewhere_and_runs_at_another_speed(percent: int) -> None:
    rig = under(f"wheel diameter {percent} %", lifted=True)
    assert rig.rim_m_s == pytest.approx(0.8 * 0.01 * percent, rel=2e-3)
    rig.axes["press"].axis.position = 10.0 + 45.0 * (1.0 - 0.01 * percent) - 0.1
    rig.advance(rig.now_s + 0.01)
    assert rig.plant.force_z_n == 0.0
    rig.axes["press"].axis.position += 0.3
    rig.advance(rig.now_s + 0.01)
    assert rig.plant.force_z_n > 0.0
    rig.install(1, 2, "1#", new_specimen=False)
    assert rig.plant.cold_mm == pytest.approx(0.9 * percent)


def test_a_wheel_in_contact_keeps_its_diameter_until_it_is_lifted() -> None:
    assert under("wheel diameter 110 %").plant.cold_mm < 90.0


def test_rubber_that_has_come_off_makes_the_force_swing() -> None:
    loads: list[list[float]] = []
    for fault in ("rubber detached 0.3 mm", "rubber detached 0 mm"):
        rig = under(fault, 0.01)
        loads.append([])
        for _ in range(60):
            rig.advance(rig.now_s + 0.01)
            loads[-1].append(rig.plant.force_z_n)
    swings = [max(one) - min(one) for one in loads]
    assert swings[0] > 35.0 and swings[1] < 10.0


def test_rubber_that_relaxes_more_begins_where_it_was_and_loses_more() -> None:
    sound, bad = under("rubber relaxation 3 %", 0.02), under("rubber relaxation 15 %", 0.02)
    assert bad.plant.force_z_n == pytest.approx(sound.plant.force_z_n, rel=5e-3)
    for rig in (sound, bad):
        rig.advance(rig.now_s + 20.0)
    assert bad.plant.force_z_n < sound.plant.force_z_n - 15.0


@pytest.mark.parametrize("phrase", UNDONE)
def test_a_fault_that_ends_leaves_no_trace(phrase: str) -> None:
    rig, whole = deepcopy(sliding()), deepcopy(sliding())
    for one in (rig, whole):
        one.axes["press"].axis.position = 0.0
        one.advance(one.now_s + 0.1)
    play(rig, f"{phrase} for 0.2 s", 0.6)
    whole.advance(whole.now_s + 0.6)
    assert (rig.rim_m_s, rig.belt_m_s) == pytest.approx((whole.rim_m_s, whole.belt_m_s))
    assert forces(rig) == pytest.approx(forces(whole))
    hub_c = rig.jacket.source.controller_measured_c(rig.now_s)
    assert hub_c == pytest.approx(whole.plant.controller_measured_c(rig.now_s))
