"""A person at the rig: conditions before a question about the wheel, and before the run continues."""

from __future__ import annotations

from math import isnan, nan

import pytest

from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.procedures.operator_access import NO_HEAT_C, PROOF_S, AskAtRest
from tester.kinds.wheel_on_belt.procedures.thermal_steps import roll
from tester.machine.activity import MoveFailedError
from tester.machine.prompts import Prompt
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Bench, Simulation, make_bench


@pytest.fixture
def bench() -> Bench:
    """A rig that rolls under load, without automatic answers."""
    made = make_bench(automatic=False)
    made.run(roll(0.8, 200.0))
    return made


def asked(bench: Bench, ask: AskAtRest) -> Prompt:
    """Step until the question is put."""
    bench.until(ask, lambda: bench.ctx.prompts.waiting is not None)
    waiting = bench.ctx.prompts.waiting
    assert waiting is not None
    return waiting


def test_a_person_is_asked_with_everything_standing_lifted_and_off(bench: Bench) -> None:
    bench.ctx.demand.surface_c = 85.0
    asked(bench, AskAtRest("check wear"))
    r, demand = bench.ctx.readings, bench.ctx.demand
    assert r.drives_disabled and r.wheel_speed_m_s == r.belt_speed_m_s == 0.0
    assert demand.press is Press.LIFT and not demand.enabled and isnan(demand.surface_c)


def test_a_hot_wheel_turns_unloaded_until_it_may_be_touched(bench: Bench) -> None:
    bench.surface_c = 80.0
    ask = AskAtRest("check wear")
    bench.hold(ask, 5.0)
    demand = bench.ctx.demand
    assert bench.ctx.prompts.waiting is None
    assert demand.press is Press.LIFT and demand.wheel_speed_m_s == bench.ctx.rig.interlocks.cooldown_speed_m_s


def test_a_wheel_that_has_cooled_is_asked_about(bench: Bench) -> None:
    bench.surface_c = 80.0
    ask = AskAtRest("check wear")
    bench.hold(ask, 5.0)
    bench.surface_c = 44.0
    assert asked(bench, ask).text == "check wear"


def test_after_heat_the_heater_is_proved_off_with_the_wheel_turning(bench: Bench) -> None:
    bench.ctx.heat.put_j = 1.0
    ask = AskAtRest("check wear")
    bench.until(ask, lambda: bench.ctx.demand.surface_c == NO_HEAT_C)
    bench.hold(ask, 1.0)
    bench.ctx.readings.contactor_closed = True
    bench.hold(ask, PROOF_S - 0.1)
    demand = bench.ctx.demand
    assert demand.wheel_speed_m_s == bench.ctx.rig.interlocks.cooldown_speed_m_s and demand.press is Press.LIFT
    bench.hold(ask, 0.5)
    bench.ctx.readings.contactor_closed = False
    assert asked(bench, ask).text == "check wear" and isnan(bench.ctx.demand.surface_c)


def test_a_contactor_that_drops_out_begins_the_proof_anew(bench: Bench) -> None:
    bench.ctx.heat.put_j = 1.0
    ask = AskAtRest("check wear")
    bench.ctx.readings.contactor_closed = True
    bench.until(ask, lambda: bench.ctx.demand.surface_c == NO_HEAT_C)
    bench.hold(ask, PROOF_S - 1.0)
    bench.ctx.readings.contactor_closed = False
    bench.hold(ask, 2.0)
    assert bench.ctx.prompts.waiting is None


def test_a_contactor_that_never_closes_lets_no_heat_pass(bench: Bench) -> None:
    bench.ctx.heat.put_j = 1.0
    assert asked(bench, AskAtRest("check wear")).text == "check wear"
    assert bench.now > PROOF_S


def test_a_relay_that_welds_when_the_heat_ends_trips_before_a_person_is_asked() -> None:
    two = SHORT.replace("25 degC", "28 degC").replace('  - compound: "1#"', '  - compound: "1#"\n  - compound: "2#"')
    simulation = Simulation(two)
    simulation.until(lambda s: s.ctx.readings.contactor_closed)
    simulation.until(lambda s: s.ctx.progress.title.startswith("install") and not s.ctx.readings.contactor_closed)
    simulation.world.jacket.stuck_element = 100.0
    simulation.until(lambda s: s.run.engine.control.state.trip is not None or len(s.ctx.prompts.asked) > 1)
    trip = simulation.run.engine.control.state.trip
    assert trip is not None and trip.name == "heater stuck" and len(simulation.ctx.prompts.asked) == 1


def test_a_hub_that_does_not_cool_is_reported_with_the_question(bench: Bench) -> None:
    bench.surface_c = 80.0
    ask = AskAtRest("check wear")
    bench.until(ask, lambda: bench.ctx.prompts.waiting is not None, at_most_s=4 * 3600.0, dt=1.0)
    assert "do not touch: the hub is still at 80 degC" in asked(bench, ask).text


@pytest.mark.parametrize(
    ("hub_c", "message"),
    [
        (44.9, "brush"),
        (45.0, "brush (HOT: the hub is at 45 degC; with the tool only, keep your hands off)"),
        (57.9, "brush (HOT: the hub is at 58 degC; with the tool only, keep your hands off)"),
    ],
)
def test_with_a_tool_a_warm_wheel_is_asked_about_and_called_hot(bench: Bench, hub_c: float, message: str) -> None:
    bench.surface_c = hub_c
    assert asked(bench, AskAtRest("brush", 58.0)).text == message
    r, demand = bench.ctx.readings, bench.ctx.demand
    assert r.drives_disabled and r.wheel_speed_m_s == r.belt_speed_m_s == 0.0 and not r.contactor_closed
    assert demand.press is Press.LIFT and not demand.enabled and isnan(demand.surface_c)


@pytest.mark.parametrize("hub_c", [58.0, 60.0, 120.0, nan])
def test_a_wheel_too_hot_for_the_tool_turns_unloaded_and_nothing_is_asked(bench: Bench, hub_c: float) -> None:
    bench.surface_c = hub_c
    ask = AskAtRest("brush", 58.0)
    bench.hold(ask, 600.0)
    demand = bench.ctx.demand
    assert bench.ctx.prompts.waiting is None
    assert demand.press is Press.LIFT and demand.wheel_speed_m_s == bench.ctx.rig.interlocks.cooldown_speed_m_s


@pytest.mark.parametrize("hub_c", [80.0, nan])
def test_a_wheel_that_stays_too_hot_for_the_tool_may_not_be_touched(bench: Bench, hub_c: float) -> None:
    bench.surface_c = hub_c
    ask = AskAtRest("brush", 58.0)
    bench.until(ask, lambda: bench.ctx.prompts.waiting is not None, at_most_s=4 * 3600.0, dt=1.0)
    assert "do not touch" in asked(bench, ask).text


BRUSHED = SHORT.replace("25 degC", "48 degC").replace(
    "grids:", "steps: [{prompt: brush the wheel, every: condition, by_tool: true}]\ngrids:"
).replace("load: 200 N", "load: [200 N, 210 N]")  # fmt: skip


def test_before_a_hot_wheel_is_brushed_the_contactor_is_proved_and_nothing_can_move() -> None:
    simulation = Simulation(BRUSHED, ["limits.tool_hub=58 degC"], accept_risk="a brush on a stick")
    simulation.ctx.prompts.automatic = False
    brushed: list[float] = []
    while len(brushed) < 2:
        simulation.until(lambda s: s.ctx.prompts.waiting is not None, at_most_s=4 * 3600.0)
        waiting = simulation.ctx.prompts.waiting
        assert waiting is not None
        if "brush" in waiting.text:
            r = simulation.ctx.readings
            assert 45.0 <= r.hub_c < 58.0 and f"HOT: the hub is at {r.hub_c:.0f} degC" in waiting.text
            still_m_s = simulation.ctx.rig.interlocks.standing_m_s
            assert r.drives_disabled and max(abs(r.wheel_speed_m_s), abs(r.belt_speed_m_s)) <= still_m_s
            assert not r.contactor_closed and simulation.world.plant.force_z_n == 0.0
            phases = {scan.title for scan in simulation.scans if scan.at_s > simulation.now - PROOF_S}
            assert phases == {waiting.text.partition(" (")[0]}
            brushed.append(simulation.now)
        waiting.reply("yes")
        simulation.tick()


def test_a_relay_that_welds_trips_before_a_hot_wheel_is_brushed() -> None:
    simulation = Simulation(BRUSHED, ["limits.tool_hub=58 degC"], accept_risk="a brush on a stick")
    simulation.until(lambda s: s.ctx.progress.title == "brush the wheel" and s.ctx.heat.put_j > 0.0, 4 * 3600.0)
    asked_before = len(simulation.ctx.prompts.asked)
    simulation.world.jacket.stuck_element = 100.0
    simulation.until(lambda s: s.run.engine.control.state.trip is not None, 4 * 3600.0)
    trip = simulation.run.engine.control.state.trip
    assert trip is not None and trip.name == "heater stuck" and len(simulation.ctx.prompts.asked) == asked_before


def test_nothing_is_asked_while_the_contactor_is_closed(bench: Bench) -> None:
    bench.ctx.readings.contactor_closed = True
    bench.hold(AskAtRest("check wear"), 5.0)
    assert bench.ctx.prompts.waiting is None


def test_a_wheel_that_does_not_come_to_a_stand_fails_the_step(bench: Bench) -> None:
    bench.ctx.readings.contactor_closed = True
    ask = AskAtRest("check wear")
    with pytest.raises(MoveFailedError, match="coming to a stand"):
        bench.run(ask)


def test_closing_the_guard_starts_nothing_the_question_is_put_again(bench: Bench) -> None:
    ask = AskAtRest("check wear")
    asked(bench, ask).answer = "yes"
    bench.ctx.readings.guard_closed = False
    bench.hold(ask, 5.0)
    assert not bench.ctx.demand.enabled and "guard" in bench.ctx.progress.phase
    bench.ctx.readings.guard_closed = True
    bench.hold(ask, 5.0)
    again = bench.ctx.prompts.waiting
    assert again is not None and again.text == "check wear: the guard is closed now, go on?"
    again.answer = "yes"
    assert bench.scan(ask)


def test_control_knows_that_a_person_is_at_the_wheel_until_the_answer(bench: Bench) -> None:
    ask = AskAtRest("check wear")
    question = asked(bench, ask)
    bench.scan(ask)
    assert bench.ctx.demand.attended
    question.answer = "yes"
    assert bench.scan(ask)
    assert not bench.ctx.demand.attended


def test_a_wheel_that_was_left_on_the_belt_is_waited_for_and_then_fails_the_step(bench: Bench) -> None:
    ask = AskAtRest("check wear")
    asked(bench, ask).answer = "yes"
    bench.zero_n = 60.0
    with pytest.raises(MoveFailedError, match="free wheel"):
        bench.hold(ask, 40.0)


def test_a_tare_hides_no_load_from_the_look_after_a_person(bench: Bench) -> None:
    ask = AskAtRest("check wear")
    asked(bench, ask).answer = "yes"
    bench.zero_n = 60.0
    bench.cell.set_tare((0.0, 0.0, 60.0, 0.0))
    bench.hold(ask, 5.0)
    bench.zero_n = 0.0
    bench.cell.set_tare((0.0, 0.0, 0.0, 0.0))
    assert bench.scan(ask)


def test_an_open_question_is_not_put_again_after_a_hold(bench: Bench) -> None:
    ask = AskAtRest("check wear")
    asked(bench, ask)
    ask.resume(bench.ctx)
    bench.hold(ask, 1.0)
    assert len(bench.ctx.prompts.asked) == 1


def test_a_guard_opened_while_the_question_is_open_trips_nothing() -> None:
    simulation = Simulation()
    simulation.ctx.prompts.automatic = False
    simulation.until(lambda s: s.run.waiting)
    guard = simulation.world.axes["press"]
    guard.set_guard(False)
    asked_s = simulation.now
    simulation.until(lambda s: s.now > asked_s + 3.0)
    waiting = simulation.ctx.prompts.waiting
    assert waiting is not None and not simulation.ctx.readings.guard_closed
    waiting.answer = "yes"
    simulation.until(lambda s: s.now > asked_s + 6.0)
    guard.set_guard(True)
    simulation.until(lambda s: s.run.waiting)
    simulation.until(lambda s: s.now > asked_s + 9.0)
    again = simulation.ctx.prompts.waiting
    assert again is not None and simulation.ctx.readings.drives_disabled
    again.answer = "yes"
    simulation.until(lambda s: s.ctx.readings.drives_enabled)
    assert simulation.run.engine.control.state.trip is None
