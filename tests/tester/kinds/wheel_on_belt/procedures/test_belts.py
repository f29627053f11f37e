"""A change of the belt: as safe as a wheel change, valid only once confirmed, with each belt's own history."""

from __future__ import annotations

from math import isnan

import pytest

from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.procedures.belts import Belts
from tester.kinds.wheel_on_belt.procedures.operator_access import PROOF_S
from tester.kinds.wheel_on_belt.procedures.thermal_steps import roll
from tester.kinds.wheel_on_belt.procedures.wheel_life import wheel_of
from tester.kinds.wheel_on_belt.procedures.wheel_steps import PutBeltOn
from tester.kinds.wheel_on_belt.recipe.plan_steps import ChangeBelt
from tests.tester.kinds.wheel_on_belt.bench import Bench, make_bench


@pytest.fixture
def bench() -> Bench:
    """A rig that rolls on belt A under load; the test decides when the person answers."""
    made = make_bench(automatic=False)
    made.ctx.belts = Belts("A", {"A": 120.0, "B": 40.0})
    made.ctx.put_on(wheel_of(made.ctx.rig.geometry, 1, 1, 1, "1#"))
    made.run(roll(0.8, 200.0))
    return made


def asking(bench: Bench, step: ChangeBelt) -> PutBeltOn:
    """Return the activity once its question waits."""
    activity = PutBeltOn(step)
    bench.until(activity, lambda: bench.ctx.prompts.waiting is not None)
    return activity


def answer(bench: Bench) -> None:
    waiting = bench.ctx.prompts.waiting
    assert waiting is not None and not waiting.reply("yes")


def test_it_is_asked_for_lifted_at_rest_and_without_torque_or_heat(bench: Bench) -> None:
    bench.ctx.demand.surface_c = 60.0
    asking(bench, ChangeBelt(3, "B"))
    r, demand = bench.ctx.readings, bench.ctx.demand
    assert r.drives_disabled and r.wheel_speed_m_s == r.belt_speed_m_s == 0.0 and not r.contactor_closed
    assert demand.press is Press.LIFT and not demand.enabled and isnan(demand.surface_c)


def test_after_heat_the_heater_is_proved_off_first(bench: Bench) -> None:
    bench.ctx.heat.put_j = 1.0
    activity = PutBeltOn(ChangeBelt(3, "B"))
    bench.hold(activity, PROOF_S - 2.0)
    assert bench.ctx.prompts.waiting is None


def test_the_belt_counts_only_once_the_question_is_answered(bench: Bench) -> None:
    activity = asking(bench, ChangeBelt(3, "B"))
    bench.hold(activity, 30.0)
    assert bench.ctx.belts.on == "A" and not bench.notes.texts("surface")
    answer(bench)
    bench.run(activity)
    assert bench.ctx.belts.on == "B" and bench.notes.texts("surface") == ["B is on, after 40 m under load"]


def test_travel_counts_for_the_belt_that_is_on() -> None:
    belts = Belts()
    belts.put_on("A")
    belts.travelled(30.0)
    belts.put_on("B")
    belts.travelled(5.0)
    belts.put_on("A")
    belts.travelled(1.0)
    assert belts.travel_m == 31.0 and belts.travels_m["B"] == 5.0


def test_the_place_of_contact_is_forgotten_and_the_wheels_wear_is_not(bench: Bench) -> None:
    ctx = bench.ctx
    ctx.wheel.loss_mm, ctx.contact.contact_mm = 0.3, 11.0
    ctx.wheel.estimate.place_mm = 11.0
    activity = asking(bench, ChangeBelt(3, "B"))
    answer(bench)
    bench.run(activity)
    assert isnan(ctx.contact.contact_mm) and isnan(ctx.wheel.estimate.place_mm)
    assert ctx.wheel.loss_mm == ctx.wheel.estimate.loss_mm == 0.3 and ctx.wheel.wheel == 1


def test_a_resumed_run_leaves_a_belt_that_is_on_already() -> None:
    assert PutBeltOn(ChangeBelt(3, "B", again=True)).text.endswith("if it is not on already")
