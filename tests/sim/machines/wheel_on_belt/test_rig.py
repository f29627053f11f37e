"""The simulated rig as one machine: wires, drives and plant together."""

from __future__ import annotations

from copy import deepcopy
from itertools import pairwise

import pytest

from drivers.canopen.objects import MAX_TORQUE, OperationMode
from drivers.cia402 import INTERNAL_LIMIT, State
from sim.machines.wheel_on_belt.plant import Plant
from sim.machines.wheel_on_belt.rig import WheelRig
from sim.nodes.controller_slave import ControllerSlave
from sim.nodes.motion import VelocityAxis
from sim.rig import LONGEST_STEP_S, SHORTEST_STEP_S
from tester.kinds import load_rig
from tester.run.simulated import spec_of
from tests.campaigns.faults.wheel_harm import FORCE_N
from tests.tester.kinds.wheel_on_belt.bench import Simulation, in_contact


@pytest.fixture
def world() -> WheelRig:
    config = load_rig("sim", [])
    return WheelRig(spec_of(config), config.sim, 0)


@pytest.fixture(scope="module")
def rolling() -> Simulation:
    """A run that has just come into rolling contact; to be copied."""
    return Simulation().until(in_contact)


def test_every_axis_and_device_of_the_wiring_is_there(world: WheelRig) -> None:
    assert list(world.axes) == ["wheel", "belt", "press", "sideslip", "camber"]
    assert list(world.lines) == ["load_cell", "heat"]


def test_a_manual_axis_has_no_node() -> None:
    config = load_rig("sim", ["axes.sideslip={manual: true}", "axes.camber={manual: true}"])
    world = WheelRig(spec_of(config), config.sim, 0)
    world.advance(1.0)
    assert list(world.axes) == ["wheel", "belt", "press"] and world.plant.force_z_n == 0.0


def test_every_drive_boots_by_itself(world: WheelRig) -> None:
    seen: list[int] = []
    for i in range(300):
        world.advance(i * 0.01)
        seen += [can_id for _, can_id, data in world.can.receive(i * 0.01) if data == b"\x00"]
    assert set(seen) >= {0x701, 0x702, 0x703, 0x704, 0x705}


def test_nothing_moves_by_itself(world: WheelRig) -> None:
    world.advance(10.0)
    assert all(axis.axis.value == 0.0 for axis in (world.axes["wheel"], world.axes["belt"], world.axes["press"]))
    assert world.plant.force_z_n == 0.0 and world.plant.sliding_m == 0.0


def test_a_step_too_short_waits_for_the_next(world: WheelRig) -> None:
    world.advance(0.5 * SHORTEST_STEP_S)
    assert world.now_s == 0.0
    world.advance(1.2 * SHORTEST_STEP_S)
    assert world.now_s == 1.2 * SHORTEST_STEP_S


def test_a_long_step_is_cut_into_even_ones(world: WheelRig, monkeypatch: pytest.MonkeyPatch) -> None:
    ends = [0.0]
    monkeypatch.setattr(WheelRig, "follow", lambda self, t1, still: ends.append(t1))
    world.advance(0.95)
    steps = [after - before for before, after in pairwise(ends)]
    assert world.now_s == ends[-1] == 0.95 and max(steps) <= LONGEST_STEP_S
    assert max(steps) - min(steps) < 1e-9


def test_time_never_goes_back(world: WheelRig) -> None:
    world.advance(1.0)
    world.advance(0.5)
    assert world.now_s == 1.0


def test_a_new_wheel_is_whole(rolling: Simulation) -> None:
    world = deepcopy(rolling).world
    world.advance(world.now_s + 1.0)
    world.install(1, 2, "2#", new_specimen=False)
    assert world.plant.diameter_mm == 90.0 and world.plant.sliding_m == 0.0


def test_the_jacket_heats_only_through_a_closed_contactor(rolling: Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    world = deepcopy(rolling).world
    heat: list[float] = []
    monkeypatch.setattr(Plant, "advance", lambda _, *arguments: heat.append(arguments[-1]))
    monkeypatch.setattr(ControllerSlave, "advance", lambda jacket, *_: setattr(jacket, "heater_w", 200.0))
    io = world.axes["press"].io
    assert io is not None and io.contactor_closed
    world.jacket.due_s = world.now_s  # a cycle of the controller is due
    world.advance(world.now_s + 0.01)
    io.contactor_closed = False
    world.advance(world.now_s + 0.01)
    assert heat == [200.0, 0.0]


def test_an_unpowered_press_retracts_by_its_spring(rolling: Simulation) -> None:
    world = deepcopy(rolling).world
    assert world.plant.force_z_n > 100.0
    world.axes["press"].power(False)
    world.advance(world.now_s + 0.5)
    assert world.plant.force_z_n == 0.0 and world.axes["press"].axis.position < 10.0


def test_a_rig_that_is_left_alone_stops_by_its_own_watchdogs(rolling: Simulation) -> None:
    world = deepcopy(rolling).world
    world.advance(world.now_s + 3.0)
    assert world.plant.force_z_n < 5.0 and world.jacket.heater_w == 0.0
    assert world.axes["wheel"].axis.value == world.axes["belt"].axis.value == 0.0


def test_the_torques_of_wheel_and_belt_are_those_of_friction_and_their_own(rolling: Simulation) -> None:
    world = rolling.world
    plant, axes = world.plant, world.axes
    shown = [axes[name].torque_nm for name in ("wheel", "belt")]
    due = [plant.drive_torque_nm + 0.2, -0.05 * plant.belt_force_n + 0.4]
    assert due[0] > 2.0 and due[1] < -2.0
    gains = [a / b for a, b in zip(shown, due, strict=True)]
    assert all(0.97 <= gain <= 1.03 for gain in gains) and gains[0] != gains[1]


def test_the_power_of_both_drives_equals_that_of_friction_and_bearings() -> None:
    world = Simulation(overrides=["sim.noise=0"]).until(sliding).world
    plant, axes = world.plant, world.axes
    given_w = axes["wheel"].torque_nm * world.wheel_rad_s + axes["belt"].torque_nm * world.belt_m_s / 0.05
    bearings_w = 0.2 * world.wheel_rad_s + 0.4 * world.belt_m_s / 0.05
    rubbed_w = plant.mu * plant.force_z_n * plant.slip_m_s
    assert rubbed_w > 20.0 and given_w - bearings_w == pytest.approx(rubbed_w, rel=1e-3)


@pytest.mark.parametrize(("slip", "held"), [(0.015, False), (0.03, True), (1.0, True)])
def test_a_belt_that_is_held_back_beyond_creep_takes_the_pull_of_its_roller(slip: float, held: bool) -> None:
    """878 N at 50 mm, whatever the wheel does; within elastic creep what friction asks for."""
    world = Simulation(overrides=["sim.noise=0"]).until(sliding).world
    world.belt_slip = slip
    world.advance(world.now_s + 0.001)
    friction_nm = -0.05 * world.plant.belt_force_n
    assert friction_nm < -2.0
    assert world.axes["belt"].torque_nm == pytest.approx((43.92 if held else friction_nm) + 0.4, abs=0.01)


@pytest.mark.parametrize("name", ["wheel", "belt"])
def test_a_drive_gives_way_to_friction_beyond_its_torque_and_follows_again(name: str) -> None:
    world = Simulation(overrides=["sim.noise=0"]).until(lambda one: one.world.plant.slip_m_s > 0.295).world
    drive = world.axes[name]

    def after(per_mille: int) -> float:
        drive.store.write(MAX_TORQUE, 0, per_mille)
        for _ in range(12):
            world.advance(world.now_s + 0.002)
        return world.plant.slip_m_s

    needed = round(1000.0 * abs(drive.torque_nm) / drive.config.rated_torque_nm)
    asked = after(3000)
    given_way = after(round(0.8 * needed))
    assert given_way < 0.95 * asked
    assert after(3000) > 1.02 * given_way


def sliding(simulation: Simulation) -> bool:
    plant = simulation.world.plant
    return plant.force_z_n > 150.0 and plant.slip_m_s > 0.19


def test_a_drive_without_power_gives_no_torque(rolling: Simulation) -> None:
    world = deepcopy(rolling).world
    for name in ("wheel", "belt", "press"):
        assert world.axes[name].torque_nm != 0.0
        world.axes[name].set_torque_off(True)
    world.advance(world.now_s + 0.02)
    assert [world.axes[name].torque_nm for name in ("wheel", "belt", "press")] == [0.0, 0.0, 0.0]


def driven(world: WheelRig, speed_mm_s: float, seconds: float) -> list[float]:
    """Return the force at every 10 ms while the press's drive, powered, moves at an uncontrolled speed."""
    press = world.axes["press"]
    assert isinstance(press.axis, VelocityAxis)
    forces: list[float] = []
    for _ in range(round(seconds / 0.01)):
        press.axis.aim(speed_mm_s)
        press.watching = True
        world.advance(world.now_s + 0.01)
        forces.append(world.plant.force_z_n)
    return forces


def powered(seed: int = 0, per_mille: int = 230) -> WheelRig:
    """Return a rig with a turning wheel 0.5 mm before its touch, and a press whose drive is on."""
    config = load_rig("sim", [])
    assert config.axes.press.max_torque_per_mille == 230
    world = WheelRig(spec_of(config), config.sim, seed)
    world.install(1, 1, "1#", new_specimen=True)
    world.advance(1.0)
    wheel, press = world.axes["wheel"], world.axes["press"]
    assert isinstance(wheel.axis, VelocityAxis)
    wheel.axis.aim(17.8)
    press.store.write(MAX_TORQUE, 0, per_mille)
    press.axis.position = 9.5
    press.state, press.mode = State.OPERATION_ENABLED, press.modes[OperationMode.PROFILE_VELOCITY]
    return world


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("speed_mm_s", [2.0, 20.0])
def test_press_reaches_the_limit_of_the_load_and_its_torque_stops_it_short_of_harm(
    seed: int, speed_mm_s: float
) -> None:
    world = powered(seed)
    forces = driven(world, speed_mm_s, 4.0)
    press = world.axes["press"]
    assert min(forces[-50:]) > 440.0 and max(forces) < FORCE_N
    assert press.axis.value < 0.5 * speed_mm_s and press.statusword & INTERNAL_LIMIT
    assert press.torque_nm == pytest.approx(0.46, rel=0.02)


def test_a_press_that_loses_its_power_on_its_way_in_is_driven_back_by_the_load_as_by_its_spring() -> None:
    world = powered()
    while world.plant.force_z_n < 300.0:
        driven(world, 5.0, 0.01)
    world.axes["press"].set_torque_off(True)
    before_n, forces = world.plant.force_z_n, []
    for _ in range(100):
        world.advance(world.now_s + 0.01)
        forces.append(world.plant.force_z_n)
    assert max(forces) < before_n + 30.0, "340 N stop it sooner than 40 N, which take 0.25 mm: 40 N more"
    assert forces[-1] == 0.0


def test_a_press_at_its_limit_returns_on_command() -> None:
    world = powered()
    driven(world, 5.0, 2.0)
    assert driven(world, -5.0, 1.0)[-1] == 0.0
    assert not world.axes["press"].statusword & INTERNAL_LIMIT


def test_press_with_more_torque_goes_further() -> None:
    assert max(driven(powered(per_mille=3000), 5.0, 1.5)) > 560.0


def test_a_press_is_driven_back_by_a_load_far_beyond_its_torque() -> None:
    world = powered(per_mille=3000)
    driven(world, 5.0, 1.0)
    before_mm = world.axes["press"].axis.position
    world.axes["press"].store.write(MAX_TORQUE, 0, 80)
    driven(world, 5.0, 0.05)
    assert world.axes["press"].axis.position < before_mm - 0.5


def test_a_press_that_is_held_fast_pushes_with_all_it_has() -> None:
    world = powered()
    world.axes["press"].block(True)
    driven(world, -5.0, 0.05)
    assert world.axes["press"].torque_nm == pytest.approx(-0.46)


def test_equal_seeds_make_equal_rigs(world: WheelRig) -> None:
    config = load_rig("sim", [])
    other, third = WheelRig(spec_of(config), config.sim, 0), WheelRig(spec_of(config), config.sim, 1)
    forces = [rig.plant.forces_measured(0.0) for rig in (world, other, third)]
    assert forces[0] == forces[1] != forces[2]


def test_a_copied_rig_continues_as_its_original(world: WheelRig) -> None:
    world.advance(1.0)
    copied = deepcopy(world)
    world.advance(2.0)
    copied.advance(2.0)
    assert copied.plant.forces_measured(2.0) == world.plant.forces_measured(2.0)
    assert copied.can.receive(2.0) == world.can.receive(2.0)


def test_a_rig_that_has_lived_on_keeps_the_wheel_and_the_belt_of_an_interrupted_run() -> None:
    world = Simulation().world
    world.keep(1, 2, "3#", 85.0, 10.0)
    assert (world.mounted, world.plant.cold_mm) == ((1, 2, "3#"), 85.0)
    world.keep(1, 2, "3#", 84.0, 20.0)
    assert world.plant.cold_mm == 85.0
    world.plant.belt_grip = 0.9
    world.belt_travelled(1000.0)
    assert world.plant.belt_grip == 0.9
