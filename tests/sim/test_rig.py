"""The simulated rig as one machine: wires, drives and plant together."""

from __future__ import annotations

from copy import deepcopy

import pytest

from sim.nodes.jacket_slave import JacketSlave
from sim.plant import Plant
from sim.rig import LONGEST_STEP_S, SHORTEST_STEP_S, SimRig
from tester.rig import load_rig
from tester.simulated import spec_of
from tests.tester.engine.bench import Simulation, in_contact


@pytest.fixture
def world() -> SimRig:
    config = load_rig("sim", [])
    return SimRig(spec_of(config), config.sim, 0)


@pytest.fixture(scope="module")
def rolling() -> Simulation:
    """A run that has just come into rolling contact; to be copied."""
    return Simulation().until(in_contact)


def test_every_axis_and_device_of_the_wiring_is_there(world: SimRig) -> None:
    assert list(world.axes) == ["wheel", "belt", "press", "sideslip", "camber"]
    assert list(world.lines) == ["load_cell", "heat"]


def test_a_manual_axis_has_no_node() -> None:
    config = load_rig("sim", ["axes.sideslip={manual: true}", "axes.camber={manual: true}"])
    world = SimRig(spec_of(config), config.sim, 0)
    world.advance(1.0)
    assert list(world.axes) == ["wheel", "belt", "press"] and world.plant.force_z_n == 0.0


def test_every_drive_boots_by_itself(world: SimRig) -> None:
    seen: list[int] = []
    for i in range(300):
        world.advance(i * 0.01)
        seen += [can_id for _, can_id, data in world.can.receive(i * 0.01) if data == b"\x00"]
    assert set(seen) >= {0x701, 0x702, 0x703, 0x704, 0x705}


def test_nothing_moves_by_itself(world: SimRig) -> None:
    world.advance(10.0)
    assert all(axis.axis.value == 0.0 for axis in (world.axes["wheel"], world.axes["belt"], world.axes["press"]))
    assert world.plant.force_z_n == 0.0 and world.plant.sliding_m == 0.0


def test_a_step_too_short_waits_for_the_next(world: SimRig) -> None:
    world.advance(0.5 * SHORTEST_STEP_S)
    assert world.now_s == 0.0
    world.advance(1.2 * SHORTEST_STEP_S)
    assert world.now_s == 1.2 * SHORTEST_STEP_S


def test_a_long_step_is_cut_into_even_ones(world: SimRig, monkeypatch: pytest.MonkeyPatch) -> None:
    steps: list[float] = []
    monkeypatch.setattr(SimRig, "_step", lambda self, t0, t1: (steps.append(t1 - t0), setattr(self, "now_s", t1)))
    world.advance(0.95)
    assert sum(steps) == pytest.approx(0.95) and max(steps) <= LONGEST_STEP_S
    assert max(steps) - min(steps) < 1e-9


def test_time_never_goes_back(world: SimRig) -> None:
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
    monkeypatch.setattr(JacketSlave, "advance", lambda jacket, *_: setattr(jacket, "heater_w", 200.0))
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


def test_the_load_shows_in_the_wheel_drive_s_torque(rolling: Simulation) -> None:
    world = rolling.world
    assert world.axes["wheel"].torque_nm == world.plant.drive_torque_nm


def test_equal_seeds_make_equal_rigs(world: SimRig) -> None:
    config = load_rig("sim", [])
    other, third = SimRig(spec_of(config), config.sim, 0), SimRig(spec_of(config), config.sim, 1)
    forces = [rig.plant.forces_measured(0.0) for rig in (world, other, third)]
    assert forces[0] == forces[1] != forces[2]


def test_a_copied_rig_goes_on_as_its_original(world: SimRig) -> None:
    world.advance(1.0)
    copied = deepcopy(world)
    world.advance(2.0)
    copied.advance(2.0)
    assert copied.plant.forces_measured(2.0) == world.plant.forces_measured(2.0)
    assert copied.can.receive(2.0) == world.can.receive(2.0)
