"""Proofs required before a run moves anything, and the end of a run without them."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from drivers.canopen import objects as o
from drivers.cia402 import State
from sim.nodes.cia402_slave import Cia402Slave
from tester.machine.connect import Stage
from tester.machine.run import Outcome
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Simulation

Happens = Callable[[Cia402Slave], None]


def connected(simulation: Simulation) -> Simulation:
    """Tick until the connection has ended."""
    connector = simulation.run.connector
    while not connector.finished and not simulation.run.finished:
        assert simulation.now < 95.0
        simulation.tick()
    return simulation


@pytest.fixture(scope="module")
def ready() -> Simulation:
    return connected(Simulation())


def test_every_drive_has_shown_that_it_stops_without_our_heartbeat(ready: Simulation) -> None:
    shown = ready.run.connector.shown
    for name in ("wheel", "belt", "press", "sideslip", "camber"):
        assert f"{name} stops without our heartbeat" in shown
    assert "NOT shown" not in shown


def test_arming_takes_a_few_seconds(ready: Simulation) -> None:
    assert ready.now < 6.0


def test_the_proofs_are_in_the_journal(ready: Simulation) -> None:
    assert ready.notes.texts("arming")[0] == ready.run.connector.shown


def test_no_drive_is_left_in_a_fault_or_with_power(ready: Simulation) -> None:
    assert {axis.state for axis in ready.world.axes.values()} <= {State.SWITCH_ON_DISABLED, State.READY_TO_SWITCH_ON}


def test_nothing_is_sent_on_the_bus_while_listening() -> None:
    simulation = Simulation()
    while simulation.now < 0.95:
        simulation.tick()
    assert simulation.world.can.occupied_s < 0.01  # boot-up messages of the drives


def test_a_drive_that_ignores_our_heartbeat_is_not_armed() -> None:
    simulation = Simulation()
    belt = simulation.world.axes["belt"]
    simulation.until(lambda s: s.run.connector.stage is Stage.PROVE)
    belt.store.hooks[o.CONSUMER_HEARTBEAT](1, 0)
    simulation.to_the_end(100.0)
    assert simulation.run.outcome is Outcome.UNREACHABLE
    assert "belt drive did not stop" in simulation.run.reason


@pytest.mark.parametrize(("name", "text"), [("wheel", "the wheel turns at"), ("belt", "the belt runs at")])
def test_an_axis_that_does_not_follow_is_not_armed(name: str, text: str) -> None:
    simulation = Simulation()
    simulation.until(lambda s: s.run.connector.stage is Stage.PROVE)
    simulation.world.axes[name].block(True)
    simulation.to_the_end(100.0)
    assert simulation.run.outcome is Outcome.UNREACHABLE and text in simulation.run.reason


def test_a_drive_that_brakes_unlike_the_other_is_not_armed() -> None:
    simulation = Simulation()
    simulation.until(lambda s: s.run.connector.stage is Stage.HEAR)
    parameters = simulation.run.engine.devices.axes.belt.parameters
    parameters[(o.PROFILE_DECELERATION, 0)] = parameters[(o.PROFILE_DECELERATION, 0)] // 2
    simulation.to_the_end(100.0)
    assert simulation.run.outcome is Outcome.UNREACHABLE and "must be equal within 5 %" in simulation.run.reason


def test_an_open_safety_chain_refuses_to_arm_and_releases_the_drives() -> None:
    simulation = Simulation()
    simulation.until(lambda s: s.run.connector.stage is Stage.HEAR)
    simulation.world.axes["press"].set_safety_chain(False)
    simulation.to_the_end(100.0)
    assert simulation.run.outcome is Outcome.UNREACHABLE
    assert simulation.run.reason == "not armed: safety chain"
    simulation.world.advance(simulation.now + 5.0)
    assert all(axis.state is not State.FAULT for axis in simulation.world.axes.values())


@pytest.mark.parametrize(
    ("happens", "reason"),
    [
        (lambda press: press.withhold_heartbeat(True), "press drive: heartbeat lost"),
        (lambda press: press.fault(0x2310), "press drive in fault"),
        (lambda press: press.set_guard(False), "guard open"),
        (lambda press: press.set_safety_chain(False), "safety chain"),
    ],
)
def test_an_event_at_a_moving_axis_ends_the_arming_at_once(happens: Happens, reason: str) -> None:
    simulation = Simulation()
    wheel, press = simulation.world.axes["wheel"], simulation.world.axes["press"]
    simulation.until(lambda s: s.run.connector.stage is Stage.PROVE and wheel.axis.value > 0.1)
    happens(press)
    began = simulation.now
    simulation.until(lambda s: s.run.connector.failed)
    assert simulation.now - began <= 0.21
    assert reason in simulation.run.connector.failure
    simulation.until(lambda s: wheel.axis.value == 0.0)
    assert simulation.now - began <= 0.4


@pytest.mark.parametrize("stage", [Stage.HEAR, Stage.HOME, Stage.PROVE])
def test_safety_inputs_that_do_not_come_any_more_end_the_connection(stage: Stage) -> None:
    simulation = Simulation()
    simulation.until(lambda s: s.run.connector.stage is stage)
    press = simulation.world.axes["press"]
    press.store.values[(0x1801, 1)] |= o.COB_INVALID
    press.pdos.reload()
    began = simulation.now
    simulation.until(lambda s: s.run.connector.failed)
    assert simulation.now - began <= 0.27
    assert simulation.run.connector.failure == "not armed: inputs stale: the press drive sends none"


def test_a_failed_connection_releases_the_drives_that_were_configured() -> None:
    simulation = Simulation()
    simulation.world.axes["camber"].power(False)
    simulation.to_the_end(100.0)
    assert simulation.run.outcome is Outcome.UNREACHABLE
    simulation.world.advance(simulation.now + 5.0)
    assert all(axis.state is not State.FAULT for axis in simulation.world.axes.values())
    assert not any(drive.connected for drive in simulation.run.engine.devices.drives)


def test_proofs_can_be_left_out_where_a_drive_cannot_and_the_journal_states_it() -> None:
    overrides = ("arming.watchdog_proof=false", "arming.bump_test=false", "arming.listen=0 s")
    simulation = connected(Simulation(SHORT, overrides, accept_risk="drives that cannot prove it"))
    assert "NOT shown: drives follow, wheel stops without our heartbeat" in simulation.run.connector.shown
    assert simulation.run.connector.stage is Stage.READY


def test_a_cold_hub_and_a_thermometer_that_disagrees_do_not_arm() -> None:
    simulation = Simulation(SHORT, ("sim.sensors.ir_bias=30 K",), seed=1)
    bias = simulation.world.plant.surface_measured_c(0.0) - 23.0
    assert abs(bias) > 6.0, "the seed is meant to draw a large bias"
    simulation.to_the_end(100.0)
    assert simulation.run.outcome is Outcome.UNREACHABLE and "hub cold at" in simulation.run.reason
