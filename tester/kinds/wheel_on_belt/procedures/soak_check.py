"""The thermometer against the hub's sensor at the end of a soak: is the surface as warm as it looks?

Rolling without slip, the surface is colder than the hub by what the air takes. The thermal observer works that out
from the hub's sensor alone (``control.observer``). What they may part by is the sum of three beliefs: the thermometer's
bias, as the budget has it, the hub sensor's, and a share of the drop from hub to surface that the observer may be off.
"""

from __future__ import annotations

from math import isfinite
from typing import Final

from tester.analysis.results import SoakCheck
from tester.kinds.wheel_on_belt.budget import TERMS
from tester.kinds.wheel_on_belt.context import Context

THERMOMETER_K: Final = next(one.bound for one in TERMS if one.name == "thermometer")
"""Bias of the thermometer, K, at most."""
HUB_K: Final = 0.5
"""Error of the hub's sensor, K, at most [A]: Pt100 class B at 60 degC is 0.6 K, and the line through the slip ring is
watched by itself."""
MODEL_SHARE: Final = 0.15
"""Tolerance of the observer's drop from hub to surface, a share [A]: a fifth more film of air makes 12 %."""


def allowed_k(hub_c: float, model_c: float) -> float:
    """Return by how much thermometer and model may part, K, at a hub and a modelled surface of these degC."""
    return THERMOMETER_K + HUB_K + MODEL_SHARE * abs(hub_c - model_c)


def soak_check(ctx: Context, condition: int) -> SoakCheck | None:
    """Return what both show now, at the end of a condition's soak; None where one of them is not known."""
    r, observer = ctx.readings, ctx.observer
    if observer is None or not r.jacket_valid or not isfinite(observer.surface_c):
        return None
    surface_c, model_c = ctx.gates.surface.slow_c, observer.surface_c
    if not isfinite(surface_c):
        return None
    return SoakCheck(condition, ctx.now, surface_c, model_c, r.hub_c, allowed_k(r.hub_c, model_c))
