"""The first contact of a wheel: friction turns round with the slip, or the run ends at a load that a hand can hold."""

from __future__ import annotations

import pytest

from sim.machines.wheel_on_belt.faults import LANGUAGE
from tester.kinds.wheel_on_belt.procedures.first_contact import OFF, FirstContact
from tester.kinds.wheel_on_belt.recipe.constants import EstimateConstants
from tester.machine.activity import MoveFailedError
from tests.campaigns.faults.stage import Stage
from tests.tester.kinds.wheel_on_belt.bench import SHORT, make_bench

OFF_BY_MUCH = (
    "wheel drive reversed", "belt drive reversed", "wheel and belt drives swapped", "wheel diameter 90 %",
    "wheel diameter 110 %", "wheel speed scale 90 %", "wheel speed scale 110 %", "belt speed scale 110 %",
    "wheel speed scale 200 %", "belt speed scale 200 %",
)  # fmt: skip


def contact(fault: str, compound: str = "1#", seed: int = 3) -> tuple[Stage, float, float]:
    """Install a wheel with a fault that was there before; return the stage after it, greatest force and beginning."""
    stage = Stage(SHORT.replace("1#", compound), seed=seed)
    if fault:
        stage.inject(LANGUAGE.parse(f"t=0 s: {fault}"))
    most_n = installing_s = 0.0
    while stage.next_s < 60.0 and not stage.ended and stage.place[0] < 2:
        stage.tick()
        most_n = max(most_n, stage.rig.plant.force_z_n)
        installing_s = stage.step_since_s if stage.place[0] == 1 else installing_s
    return stage, most_n, installing_s


@pytest.mark.parametrize("fault", OFF_BY_MUCH)
def test_an_axis_that_turns_wrongly_is_named_at_20_n_or_less(fault: str) -> None:
    stage, most_n, _ = contact(fault)
    assert OFF in stage.run.engine.executor.failed and not stage.trip
    assert most_n <= 20.0 and not stage.observer.found


@pytest.mark.parametrize("fault", ["", "wheel diameter 97 %", "wheel diameter 103 %", "belt speed scale 103 %"])
def test_an_error_within_the_sweep_is_not_reported_and_costs_time_but_no_wear(fault: str) -> None:
    stage, most_n, installing_s = contact(fault, "3#")
    assert stage.place[0] == 2 and not stage.run.engine.executor.failed and not stage.trip
    assert most_n <= 20.0
    assert stage.run.engine.ctx.wheel.sliding_m < 0.1 and stage.run.engine.ctx.wheel.loss_mm < 1e-4
    # The estimate counts its time; a wheel of another diameter is touched some seconds off.
    took_s = stage.step_since_s - installing_s
    assert took_s == pytest.approx(EstimateConstants().install_s, abs=5.0 if "diameter" in fault else 0.5)


def test_friction_that_turns_round_is_written_down() -> None:
    bench = make_bench()
    bench.run(FirstContact())
    assert len(bench.notes.texts("first contact")) == 2


@pytest.mark.parametrize("mu", [-0.7, 0.05])
def test_friction_that_has_the_wrong_sign_or_none_ends_the_run(mu: float) -> None:
    bench = make_bench()
    bench.mu = mu
    with pytest.raises(MoveFailedError, match="speed ratio of wheel and belt is off"):
        bench.run(FirstContact())


@pytest.mark.parametrize("place_mm", [8.0, 12.0])
def test_a_wheel_that_is_touched_elsewhere_ends_the_run(place_mm: float) -> None:
    bench = make_bench()
    bench.pressed_mm = place_mm
    with pytest.raises(MoveFailedError, match=r"expected at 10\.00 mm"):
        bench.run(FirstContact())
