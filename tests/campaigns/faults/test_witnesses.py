"""Second witnesses of the force at 400 N: with any load cell reading, nothing presses beyond 500 N."""

from __future__ import annotations

from functools import cache

import pytest

from sim.machines.wheel_on_belt.faults import LANGUAGE
from tests.campaigns.faults.stage import Stage
from tests.tester.kinds.wheel_on_belt.bench import SHORT


@cache
def held() -> Stage:
    """Return a rig that has been sliding at 400 N for a second; to be copied."""
    stage = Stage(SHORT.replace("200 N", "400 N"), seed=3)
    while stage.place[1] != "measure":
        stage.tick()
    began_s = stage.next_s
    while stage.next_s < began_s + 1.0:
        stage.tick()
    return stage


def presses(stage: Stage, fault: str, within_s: float) -> tuple[float, float]:
    """Let a fault happen; return how long it took until a trip, and the greatest force until well after it."""
    began_s, most_n = stage.next_s, 0.0
    stage.inject(LANGUAGE.parse(f"t={began_s:.6f} s: {fault}"))
    tripped_s = float("inf")
    while stage.next_s < min(tripped_s + 1.0, began_s + within_s):
        stage.tick()
        most_n = max(most_n, stage.rig.plant.force_z_n)
        if stage.trip and tripped_s == float("inf"):
            tripped_s = stage.next_s
    return tripped_s - began_s, most_n


@pytest.mark.parametrize(
    ("fault", "within_s"),
    [
        ("load cell offset -160 N", 0.2),
        ("load cell offset 30 N", 0.2),
        ("load cell offset -30 N", 0.2),
        ("load cell gain 68 %", 0.2),
        ("load cell gain 80 %", 0.2),
        ("load cell Fx and Fz exchanged", 0.2),
        ("load cell frozen", 0.6),
        ("load cell drift -1 N/s", 60.0),
    ],
)
def test_a_load_cell_fault_under_load_is_detected(fault: str, within_s: float) -> None:
    stage = held().copy()
    took_s, most_n = presses(stage, fault, within_s + 1.5)
    assert took_s <= within_s and most_n < 460.0 and not stage.observer.found


@pytest.mark.parametrize("fault", ["load cell gain 68 %", "load cell gain 80 %", "load cell Fx and Fz exchanged"])
def test_a_load_cell_that_was_wrong_before_the_contact_cannot_press_past_500_n(fault: str) -> None:
    stage = Stage(SHORT.replace("200 N", "400 N"), seed=3)
    stage.inject(LANGUAGE.parse(f"t=0 s: {fault}"))
    most_n = 0.0
    while stage.next_s < 90.0 and not stage.ended:
        stage.tick()
        most_n = max(most_n, stage.rig.plant.force_z_n)
    assert stage.ended and most_n < 500.0 and not stage.observer.found
