"""Control loops of simulated temperature controllers, each tuned for the plant under control."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Final

from drivers.profiles.model import Kind

JACKET_CYCLE_S: Final = 0.125
"""Time between two runs of the jacket's loop [A]."""
CHAMBER_CYCLE_S: Final = 0.5
"""Time between two runs of the chamber's loop [A]."""
JACKET_HOTTEST_C: Final = 155.0
"""The jacket's own limiter: from this temperature there is no heat until a standby below LIMIT_RESET_C [A]."""
LIMIT_RESET_C: Final = 145.0
CHAMBER_HOTTEST_C: Final = 105.0
CHAMBER_COLDEST_C: Final = -55.0
"""The chamber's own limiter: outside these temperatures it goes to standby [A]."""
@dataclass(frozen=True, slots=True)
class ControlledPlant:
    """A loop and its limiter, tuned for the plant under control."""

    cycle_s: float
    band_k: float
    """Proportional band, K: its width is 100 % of output."""
    integral_s: float
    derivative_s: float
    least_percent: float
    """Least output, %; an output below 0 cools."""
    hottest_c: float
    coldest_c: float
    latches: bool
    """Whether the limiter holds until standby below LIMIT_RESET_C; otherwise it puts the controller in standby."""
    refuses: bool
    """Whether a setpoint beyond the profile's range is refused; otherwise the end of the range is used."""


CONTROLLED: Final[Mapping[Kind, ControlledPlant]] = {
    "jacket": ControlledPlant(
        JACKET_CYCLE_S, 2.5, 60.0, 1.0, 0.0, JACKET_HOTTEST_C, -inf, latches=True, refuses=False
    ),
    "chamber": ControlledPlant(
        CHAMBER_CYCLE_S, 3.0, 300.0, 0.0, -100.0, CHAMBER_HOTTEST_C, CHAMBER_COLDEST_C, latches=False, refuses=True
    ),
}
"""Plants by the kind of profile. The jacket's is tuned for 200 W on a hub of 420 J/K with 20 W/K to the rubber and a
sensor lag of 1 s; the chamber has full output at 3 K off its setpoint. [A]"""
FILTER_S: Final = 2.0
"""Time constant of the derivative's filter, s [A]."""


class Pid:
    """Output in % from setpoint and measurement; derivative of the measurement, integral without wind-up."""

    def __init__(self, plant: ControlledPlant) -> None:
        """Take the tuning of a plant; output 0."""
        self.plant = plant
        self.reset()

    def reset(self) -> None:
        """Forget everything: output 0."""
        self.integral = self._derivative = 0.0
        self._last_pv: float | None = None

    def step(self, setpoint: float, pv: float, dt: float) -> float:
        """Advance by ``dt`` s and return the output in %."""
        plant = self.plant
        if self._last_pv is not None:
            rate = (pv - self._last_pv) / dt
            self._derivative += (rate - self._derivative) * dt / (FILTER_S + dt)
        self._last_pv = pv
        gain = 100.0 / plant.band_k
        error = setpoint - pv
        direct = gain * (error - plant.derivative_s * self._derivative)
        wanted, least = direct + self.integral, plant.least_percent
        # The integral stops while the output is at a limit and the error would drive it further there.
        driven_up, driven_down = wanted >= 100.0 and error > 0.0, wanted <= least and error < 0.0
        if not driven_up and not driven_down:
            self.integral += gain * error * dt / plant.integral_s
            self.integral = min(max(self.integral, least), 100.0)
        return min(max(direct + self.integral, least), 100.0)
