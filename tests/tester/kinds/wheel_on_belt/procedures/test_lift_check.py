"""The press is lifted, and the load cell confirms it, before anything else moves."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from drivers.cia402 import State
from sim.wires.modbus_wire import Impairment
from tester.kinds.wheel_on_belt.procedures.lift_check import loaded
from tester.machine.connect import Stage
from tester.machine.run import Outcome
from tests.tester.inputs.recipe.texts import rig
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Simulation

HOLDS = "sim.press_on_power_loss=hold"
TOUCHING_MM = 11.8
"""About 200 N on a new wheel."""


def wrongly_zeroed() -> Simulation:
    """Return a rig whose press, at a reading of 0 mm, has about 200 N: the wheel is in the way by 1.8 mm."""
    simulation = Simulation(SHORT, (HOLDS, "sim.contact.gap=0 mm"))
    simulation.world.remount(1, 1, "1#", 93.6, 0.0)
    return simulation


def pressed(press_mm: float, *overrides: str, accept_risk: str = "") -> Simulation:
    """Return a rig whose wheel is mounted before the program starts, with the press at ``press_mm``."""
    simulation = Simulation(SHORT, (HOLDS, *overrides), accept_risk=accept_risk)
    simulation.world.axes["press"].axis.position = press_mm
    simulation.world.install(1, 1, "1#", new_specimen=True)
    return simulation


def in_stage(stage: Stage) -> Callable[[Simulation], bool]:
    return lambda simulation: simulation.run.connector.stage is stage


def others_moved(simulation: Simulation) -> bool:
    """Return whether a drive besides the press's has power, or turns."""
    return any(
        name != "press" and (axis.state is State.OPERATION_ENABLED or axis.axis.value != 0.0)
        for name, axis in simulation.world.axes.items()
    )


def test_a_press_left_in_contact_is_lifted_before_any_other_drive_has_power() -> None:
    simulation = pressed(TOUCHING_MM).until(in_stage(Stage.LIFT))
    assert simulation.world.plant.force_z_n > 150.0
    while simulation.run.connector.stage is Stage.LIFT:
        assert not others_moved(simulation)
        simulation.tick()
    assert simulation.run.connector.stage is Stage.HOME and simulation.world.plant.force_z_n == 0.0


def test_a_press_left_in_contact_does_not_keep_the_rig_from_coming_up() -> None:
    assert pressed(TOUCHING_MM).until(in_stage(Stage.READY), 15.0).run.connector.failure == ""


def test_a_wheel_under_load_is_refused_whatever_the_press_reads() -> None:
    simulation = wrongly_zeroed()
    while not simulation.run.finished:
        simulation.tick()
        assert not others_moved(simulation)
    assert simulation.run.outcome is Outcome.UNREACHABLE
    assert "press's zero is wrong, the cell's zero is wrong, or the wheel touches" in simulation.run.reason


def test_the_refusal_states_the_readings_of_the_cell_and_the_press() -> None:
    reason = wrongly_zeroed().to_the_end(20.0).run.reason
    assert reason.startswith("not armed: the load cell shows Fz ") and "the press shows 0.0 mm" in reason


def test_a_press_that_moves_the_other_way_is_refused_before_it_presses_much() -> None:
    simulation = pressed(TOUCHING_MM).until(in_stage(Stage.LIFT))
    press = simulation.world.axes["press"]
    before_n, highest_n = simulation.world.plant.force_z_n, 0.0
    while not simulation.run.finished:
        if press.state is State.OPERATION_ENABLED:
            press.axis.position += 0.15  # against the 0.1 mm that it lifts by
        highest_n = max(highest_n, simulation.world.plant.force_z_n)
        simulation.tick()
    assert "does the press move the other way?" in simulation.run.reason
    assert highest_n < before_n + 100.0


@pytest.mark.parametrize("stage", [Stage.HOME, Stage.PROVE])
def test_a_force_while_other_axes_move_ends_the_connection(stage: Stage) -> None:
    simulation = Simulation()
    simulation.until(in_stage(stage))
    simulation.world.install(1, 1, "1#", new_specimen=True)
    simulation.world.axes["press"].axis.position = TOUCHING_MM
    began = simulation.now
    simulation.until(lambda s: s.run.connector.failed)
    assert simulation.now - began <= 0.2 and "the load cell shows Fz" in simulation.run.connector.failure


@pytest.mark.parametrize("stage", [Stage.HOME, Stage.PROVE])
def test_a_load_cell_that_falls_silent_while_other_axes_move_ends_the_connection(stage: Stage) -> None:
    simulation = Simulation()
    simulation.until(in_stage(stage))
    simulation.world.lines["load_cell"].impair = Impairment("silence", count=-1, unit_id=1)
    began = simulation.now
    simulation.until(lambda s: s.run.connector.failed)
    assert simulation.now - began <= 0.2 and "load cell silent" in simulation.run.connector.failure


def test_one_reply_of_the_load_cell_may_be_lost() -> None:
    simulation = Simulation()
    simulation.until(in_stage(Stage.HOME))
    simulation.world.lines["load_cell"].impair = silent = Impairment("silence", count=1, unit_id=1)
    simulation.until(in_stage(Stage.READY))
    assert silent.count == 0 and not simulation.run.connector.failed


def test_a_rig_without_bump_test_and_proof_is_lifted_all_the_same() -> None:
    unproven = "arming.watchdog_proof=false", "arming.bump_test=false"
    simulation = pressed(TOUCHING_MM, *unproven, accept_risk="a rig that cannot prove")
    simulation.until(in_stage(Stage.READY), 15.0)
    assert simulation.world.plant.force_z_n == 0.0 and simulation.run.engine.devices.all_off()


@pytest.mark.parametrize("seed", range(5))
def test_the_sensors_of_a_noisy_session_stay_well_inside_the_bound(seed: int) -> None:
    simulation = Simulation(SHORT, ("sim.noise=3",), seed=seed).until(in_stage(Stage.READY))
    fx, fy, fz, _ = simulation.run.engine.devices.cell.raw
    assert max(abs(fx), abs(fy), abs(fz)) < 0.5 * rig().arming.unloaded_n


@pytest.mark.parametrize(
    ("raw", "is_loaded"),
    [
        ((0.0, 0.0, 19.9, 9.0), False),
        ((0.0, 0.0, -19.9, 0.0), False),
        ((0.0, 0.0, 20.1, 0.0), True),
        ((0.0, 0.0, -20.1, 0.0), True),
        ((15.0, -15.0, 0.0, 0.0), True),
        ((14.0, -14.0, 0.0, 0.0), False),
        ((0.0, 0.0, float("nan"), 0.0), True),
        ((float("nan"), 0.0, 0.0, 0.0), True),
    ],
)
def test_either_force_beyond_the_bound_or_unknown_counts_as_loaded(
    raw: tuple[float, float, float, float], is_loaded: bool
) -> None:
    assert bool(loaded(raw, rig())) is is_loaded
