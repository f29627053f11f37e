"""A rig put together from its file."""

from __future__ import annotations

import pytest

from tester.kinds.wheel_on_belt.control.interlock_inputs import InterlockInputs
from tester.kinds.wheel_on_belt.control.loops import WheelState, loss_ratios
from tester.kinds.wheel_on_belt.image.process_image import Demand, Readings
from tester.kinds.wheel_on_belt.interlocks.heat_balance import KnownRatio
from tester.kinds.wheel_on_belt.run.build import build_run, plan_bounds
from tester.machine.prompts import Prompts
from tester.machine.run_parts import RunSetup
from tester.machine.state import Mode
from tester.run.simulated import simulated_ports
from tester.store.recorder import NullRecorder
from tests.tester.inputs.recipe.texts import rig
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Simulation, plan_of


@pytest.fixture(scope="module")
def simulation() -> Simulation:
    return Simulation()


def test_every_device_of_the_file_has_its_driver(simulation: Simulation) -> None:
    devices = simulation.run.engine.devices
    assert [drive.config.name for drive in devices.drives] == ["wheel", "belt", "press", "sideslip", "camber"]
    assert [drive.config.node_id for drive in devices.drives] == [1, 2, 3, 4, 5]
    assert len(devices.lines) == 2


def test_the_slow_devices_share_a_line_and_the_load_cell_has_its_own(simulation: Simulation) -> None:
    devices = simulation.run.engine.devices
    assert devices.jacket.link is devices.thermometer.link is not devices.cell.link


def test_a_new_run_is_idle_disabled_and_lifted(simulation: Simulation) -> None:
    engine = simulation.run.engine
    assert engine.control.state.mode is Mode.IDLE
    out = engine.control.state.setpoints
    assert not (out.enable or out.heat or out.contactor) and out.press_mm_s == 0.0


def test_the_scan_rates_are_the_file_s() -> None:
    engine = Simulation(overrides=("scan.sliding=50 Hz",)).run.engine
    assert (engine.sliding_s, engine.enabled_s, engine.idle_s) == (0.02, 0.05, 0.1)


def test_control_and_context_share_the_press_loop(simulation: Simulation) -> None:
    engine = simulation.run.engine
    assert engine.ctx.contact is engine.control.state.load


def test_the_wheel_begins_with_the_file_s_diameter() -> None:
    wheel = Simulation(overrides=("geometry.wheel_diameter=88 mm",)).ctx.wheel
    assert wheel.cold_mm == 88.0


def test_rolling_contact_costs_more_heat_than_air_alone() -> None:
    lifted, rolling = loss_ratios(rig())
    assert 0.2 < lifted < rolling < 1.5


def test_a_belt_that_draws_more_heat_needs_a_hotter_hub() -> None:
    assert loss_ratios(rig("observer.belt_conductance=0.3"))[1] > 2.0 * loss_ratios(rig())[1]


@pytest.mark.parametrize(
    ("surface_c", "least_c", "most_c"), [(85.0, 134.0, 138.0), (70.0, 105.0, 115.0), (40.0, 115.0, 115.0)]
)
def test_the_hub_gets_no_hotter_than_the_hottest_condition_needs(
    surface_c: float, least_c: float, most_c: float
) -> None:
    plan = plan_of(SHORT.replace("25 degC", f"{surface_c:g} degC"))
    assert least_c <= plan_bounds(plan, rig()).hub_c <= most_c


@pytest.mark.parametrize(("air_c", "believed_c"), [(10.0, 10.0), (24.0, 23.0), (38.0, 38.0), (50.0, 23.0)])
def test_a_cold_rig_shows_the_air_around_it(air_c: float, believed_c: float) -> None:
    view = InterlockInputs(state=WheelState(20.0), rig=rig())
    r = Readings(hub_c=air_c, surface_c=air_c + 1.0, surface_valid=True, jacket_valid=True)
    view.look(Demand(), r, 0.05, 0.05)
    assert view.heat.ambient_c == believed_c and view.warmer_k == max(0.0, believed_c - 23.0)


def test_a_hub_warmer_than_its_rubber_does_not_show_the_air() -> None:
    view = InterlockInputs(state=WheelState(20.0), rig=rig())
    view.look(Demand(), Readings(hub_c=35.0, surface_c=30.0, surface_valid=True, jacket_valid=True), 0.05, 0.05)
    assert view.heat.ambient_c == 23.0


def test_without_a_history_the_heat_balance_takes_the_file_s_share(simulation: Simulation) -> None:
    heat = simulation.ctx.heat
    assert heat is not None and heat.share == simulation.ctx.rig.interlocks.heat_share
    assert simulation.ctx.known() == ["heat balance: no history yet; a row tells from 30 %"]


def test_results_of_earlier_runs_tighten_the_heat_balance() -> None:
    config = rig()
    ports, _, attendant = simulated_ports(config, 0, None)
    prompts = Prompts(automatic=True)
    run = build_run(RunSetup(config, plan_of(), ports, attendant, NullRecorder(), prompts), KnownRatio(3, 1.0))
    heat = run.engine.ctx.heat
    assert heat is not None and heat.share == pytest.approx(0.09)
    (known,) = run.engine.ctx.known()
    assert known == "heat balance: known from 3 heatings, ratio 1.00, 0.00 apart; a row tells from 9 %"
