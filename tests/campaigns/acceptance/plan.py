"""`tester plan recipes/table2.yaml --json`: the whole planned programme."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby, pairwise
from math import fsum
from typing import Any

import recipes
from tester.analysis import reference
from tests.campaigns.acceptance.bench import Bench
from tests.campaigns.acceptance.figure import Figure, at_most, equal, holds
from tests.campaigns.acceptance.topic import Topic

SETPOINT = ("compound", "slip_velocity_m_s", "load_n", "sideslip_deg", "camber_deg", "temperature_c", "wheel_speed_m_s")
STANDSTILL_S = 45 * 60.0
"""Longest time from a part's last step to standstill (interlocks.cooldown_at_most); on the simulated rig every specimen
is a part of its own, and each cools down at its end."""
Step = dict[str, Any]


def figures(bench: Bench) -> Iterator[Figure]:
    """Measure."""
    plan: dict[str, Any] = bench.json("plan", str(recipes.FOLDER / "table2.yaml"))
    steps: list[Step] = plan["steps"]
    every = [step for step in steps if step["kind"] == "condition"]
    conditions = [step for step in every if step["grid"] != reference.NAME]
    yield equal("conditions stated, references among them", plan["conditions"], len(every))
    yield equal("condition steps", len(conditions), 165)
    yield equal("distinct conditions", len({tuple(step[key] for key in SETPOINT) for step in conditions}), 165)
    per_compound = [sum(step["compound"] == name for step in conditions) for name in ("1#", "2#", "3#")]
    yield equal("conditions of each compound", per_compound, [55, 55, 55])
    yield equal("repeats of a condition", sorted({step["repeats"] for step in conditions}), [5])
    falling = sum(
        later["temperature_c"] < earlier["temperature_c"]
        for _, group in groupby(conditions, key=lambda step: step["specimen"])
        for earlier, later in pairwise(group)
    )
    yield equal("steps down in temperature within a specimen", falling, 0)
    yield from _wheels(steps, plan)
    seconds = fsum(step["seconds"] for step in steps)
    total = plan["rig_seconds"]
    fits = seconds - 0.1 * len(steps) <= total <= seconds + len(per_compound) * STANDSTILL_S
    limit = f"the sum of the steps, {seconds:.0f} s, and at most 45 min a specimen of cooling down to standstill"
    yield holds("rig time", total > 0.0 and fits, f"{total:.0f} s = {total / 3600.0:.1f} h", limit)


def _wheels(steps: list[Step], plan: dict[str, Any]) -> Iterator[Figure]:
    """Check every wheel: run in, rested, changed because of wear, and not worn beyond the limit."""
    starts = [at for at, step in enumerate(steps) if step["kind"] == "install"]
    wheels = [steps[start:end] for start, end in pairwise([*starts, len(steps)])]
    yield equal("wheels installed", len(wheels), plan["wheels"])
    ground = sum(_ground(wheel) for wheel in wheels)
    yield equal("wheels pre-ground 240 s at 0.8 / 0.6 m/s and 200 N before their first condition", ground, len(wheels))
    rested = sum(_rested(wheel) for wheel in wheels)
    yield equal("wheels rested at least 20 min between pre-grind and first condition", rested, len(wheels))
    limit = plan["replace_after_mm"]
    losses = [fsum(step.get("loss_mm", 0.0) for step in wheel) for wheel in wheels]
    yield at_most("greatest loss of diameter planned for a wheel", max(losses), limit, "mm")
    needless = 0
    for (wheel, loss), following in zip(zip(wheels, losses, strict=True), wheels[1:], strict=False):
        if wheel[0]["specimen"] == following[0]["specimen"]:
            # A change is due when the wheel cannot take all conditions of the next temperature.
            conditions = [step for step in following if step["kind"] == "condition"]
            first = next(step for step in conditions if step["grid"] != "reference")
            last = max(n for n, s in enumerate(conditions) if s["temperature_c"] == first["temperature_c"])
            # References due before or among them also wear the wheel.
            block = conditions[: last + 1]
            needless += loss + fsum(step.get("loss_mm", 0.0) for step in block) <= limit
    yield equal("wheels changed although the next temperature's conditions would fit", needless, 0)


def _before_measuring(wheel: list[Step]) -> list[Step]:
    first = next((at for at, step in enumerate(wheel) if step["kind"] == "condition"), len(wheel))
    return wheel[:first]


def _ground(wheel: list[Step]) -> bool:
    asked = {"duration_s": 240.0, "wheel_speed_m_s": 0.8, "belt_speed_m_s": 0.6, "load_n": 200.0}
    grinds = [step for step in _before_measuring(wheel) if step["kind"] == "pre_grind"]
    return len(grinds) == 1 and all(grinds[0][key] == value for key, value in asked.items())


def _rested(wheel: list[Step]) -> bool:
    before = _before_measuring(wheel)
    ground = next((at for at, step in enumerate(before) if step["kind"] == "pre_grind"), len(before))
    return any(s["kind"] == "rest" and s["at_least_s"] >= 1200.0 and s["seconds"] >= 1200.0 for s in before[ground:])


TOPIC = Topic("plan", "the 165 conditions of Table 2, their order, wheels and rig time", figures)
