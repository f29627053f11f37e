"""The thermometer against the hub: cold, where both are at the air's temperature, and in a soak of at most 45 degC.

The difference when cold is the offset. Warm, lifted and turning, the tread follows the hub: its excess over the air is
the hub's excess divided by 1 + ratio (``loops.loss_ratios``). The share of that excess that the thermometer shows is
its gain. The gain is, to first order, true over set emissivity, because the tread is not much warmer than the
surroundings that it reflects.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Generator
from math import nan
from typing import Final

from tester.kinds.wheel_on_belt.commission.armed import WheelSeat, mean_temperatures
from tester.kinds.wheel_on_belt.commission.settling import MEAN_S, SettlingFit
from tester.kinds.wheel_on_belt.control.loops import loss_ratios
from tester.kinds.wheel_on_belt.procedures.motions import Lift, Turn
from tester.machine.commission.commission_step import Dialogue, Notes, StepRefused, Waits, wait
from tester.machine.motions import Power, Sequence

MOST_C: Final = 45.0
"""Highest temperature of the hub in the soak, degC."""
HUB_C: Final = 42.0
"""Temperature at which the hub is held, degC [A]: its controller overshoots by some kelvin."""
TURNS_M_S: Final = 0.3
COLD_K: Final = 2.0
"""Tolerance of the cold offset [A]: 1 K of thermometer bias, and the error of the hub's sensor."""
GAIN_SHARE: Final = 0.10
"""Tolerance of the gain [A]: the ratio of the losses is known to a third, which is 5 % of the excess."""
AVERAGE_S: Final = 10.0
SURE_K: Final = 0.3
"""Soaked: the surface's final temperature is known with this standard uncertainty, K: 2.5 % of the excess [A] ..."""
SAME_S: Final = 30.0
SAME_K: Final = 0.5
"""... and has been the same within ``SAME_K`` for ``SAME_S`` [A] ..."""
AT_MOST_S: Final = 900.0
"""... before this time has passed, s."""


def soak(seat: WheelSeat, notes: Notes) -> Dialogue:
    """Compare cold and soaked; raises StepRefused."""
    air = seat.rig.ambient_c
    surface, hub = yield from mean_temperatures(seat, AVERAGE_S)
    offset = surface - hub
    notes.read("cold", {"surface_c": surface, "hub_c": hub, "air_c": air})
    if abs(hub - air) > COLD_K:
        raise StepRefused(f"the hub is at {hub:.1f} degC, the air at {air:g} degC: let the wheel get cold first")
    if not abs(offset) <= COLD_K:
        raise StepRefused(
            f"thermometer offset: cold it shows {offset:+.1f} K against the hub (at most {COLD_K:g} K): lens, housing's"
            " temperature, or a reflection; the device has an offset to set"
        )
    yield from seat.do(Sequence(Power(True), Lift(), Turn(TURNS_M_S, TURNS_M_S)))
    lifted, _ = loss_ratios(seat.rig)
    # The heat loop turns this surface setpoint into one of the hub. The hub's setpoint is then frozen: the thermometer
    # under test must not change it.
    seat.ctx.demand.surface_c = (HUB_C + air * lifted + surface) / (2.0 + lifted)
    yield from wait(2.0 * seat.rig.loops.heat.period_s)
    seat.ctx.demand.freeze_heat = True
    warm, sure_k, warm_hub = yield from _steady(seat)
    notes.read("soaked", {"surface_c": warm, "hub_c": warm_hub})
    seat.ctx.demand.surface_c = nan  # no heat
    expected = (warm_hub - hub) / (1.0 + lifted)
    gain = (warm - surface) / expected if expected > 0.0 else 0.0
    if warm_hub > MOST_C + 1.0:
        raise StepRefused(f"the hub came to {warm_hub:.1f} degC, more than {MOST_C:g} degC: its controller overshoots")
    emissivity = seat.rig.devices["ir_thermometer"].parameters.get("emissivity")
    if not abs(gain - 1.0) <= GAIN_SHARE:
        right = (
            f" In the rig file: devices.ir_thermometer.emissivity: {emissivity * gain:.2f} (now {emissivity:g})"
            if emissivity is not None
            else ""
        )
        raise StepRefused(
            f"emissivity: soaked the thermometer shows {warm - surface:.1f} K above the cold tread, the hub at"
            f" {warm_hub:.1f} degC means {expected:.1f} K: gain {gain:.2f}.{right}"
        )
    notes.values = {
        "offset_k": offset, "gain": gain, "hub_c": warm_hub, "surface_c": warm, "expected_k": expected,
        "cold_c": surface, "cold_hub_c": hub, "gain_standard_uncertainty": sure_k / expected,
    }  # fmt: skip
    notes.text = f"offset {offset:+.2f} K cold, gain {gain:.3f} +- {sure_k / expected:.3f}"
    notes.text += f" (standard uncertainty) at {warm_hub:.1f} degC of the hub"


def _steady(seat: WheelSeat) -> Generator[Waits, str, tuple[float, float, float]]:
    """Wait until the surface's final temperature is known, with the hub held.

    Return that temperature, degC, its standard uncertainty, K, and the hub's temperature, degC.
    """
    fit, last = SettlingFit(), deque[tuple[float, float]](maxlen=round(SAME_S / MEAN_S))
    began_s = seat.ctx.now
    while True:
        surface, hub = yield from mean_temperatures(seat, MEAN_S)
        fit.add(surface)
        going, standard = fit.going()
        last.append((going, hub))
        same = len(last) == last.maxlen and all(abs(end - going) <= SAME_K for end, _ in last)
        if same and standard <= SURE_K:
            return going, standard, sum(hub for _, hub in last) / len(last)
        if seat.ctx.now - began_s > AT_MOST_S:
            raise StepRefused(f"not soaked after {AT_MOST_S / 60:g} min: hub {hub:.1f}, surface {surface:.1f} degC")
