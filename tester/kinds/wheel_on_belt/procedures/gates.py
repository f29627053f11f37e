"""The gates: which samples count. Evaluated live in every scan and stored with each sample.

Load within 2 % (1 s average), both speeds within 1 %, slip within max(2 %, 2 mm/s) (0.2 s average), surface
temperature inside the band with the infrared thermometer's lag allowed for.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite
from typing import Final

from tester.kinds.wheel_on_belt.image.process_image import Readings
from tester.kinds.wheel_on_belt.rig.loop_sections import GatesConfig

GATES: Final = {"load": 1, "speed": 2, "slip": 4, "temperature": 8, "settling": 32}
"""Bits of the gates in the channel ``gate``, by name: set while the gate is closed."""
_LOAD, _SPEED, _SLIP, _TEMPERATURE, _SETTLING = GATES.values()

_INF: Final = inf
RESTART_SHARE: Final = 0.15
"""An average restarts while the instant value is off by this share: it excludes the approach [A]."""
RATE_FAST_S: Final = 0.3
RATE_SLOW_S: Final = 1.5
"""Time constants of the two averages whose difference gives the surface's rate of change [A]."""
RATE_LIMIT_K_S: Final = 5.0
"""A faster surface is a sensor fault, not a rate."""


@dataclass(slots=True)
class Average:
    """Average over up to ``window_s``: the exact mean at first, exponential afterwards. It restarts on a jump."""

    window_s: float
    floor: float
    """Smallest distance that counts as a jump, in the value's unit."""
    value: float = float("nan")
    age_s: float = 0.0

    def update(self, x: float, target: float, dt: float) -> float:
        """Add a value that lasted ``dt`` s; return the average."""
        # Comparisons here and below: a call of abs costs several times as much in every scan (CPython 3.11).
        value, off, floor = self.value, x - target, self.floor
        if not -_INF < value < _INF or (not -floor <= off <= floor and abs(off) > RESTART_SHARE * abs(target)):
            self.value = x
            self.age_s = 0.0
            return x
        self.age_s = age_s = self.age_s + dt
        span_s = age_s if age_s < self.window_s else self.window_s
        self.value = value = value + (x - value) * (dt / span_s if dt < span_s else 1.0)
        return value


@dataclass(slots=True)
class Target:
    """Targets of the gates; the measuring activity writes them."""

    load_n: float = 0.0
    wheel_speed_m_s: float = 0.0
    belt_speed_m_s: float = 0.0
    slip_m_s: float = 0.0
    """Resultant slip speed of the setpoints."""
    temperature_c: float = 0.0
    band_k: float = 2.0


@dataclass(slots=True)
class SurfaceTrend:
    """Filtered surface temperature and its rate in K/s, updated with each new reading of the thermometer."""

    fast_c: float = float("nan")
    slow_c: float = float("nan")
    stamp_s: float = float("-inf")
    rate_k_s: float = 0.0
    now_c: float = float("nan")
    """The temperature corrected for the lags of thermometer and filter, degC."""

    def update(self, surface_c: float, stamp_s: float, lag_s: float) -> None:
        """Process a reading of a thermometer with a lag; a reading that is not newer than the last is ignored."""
        if stamp_s <= self.stamp_s or not isfinite(surface_c):
            return
        dt, self.stamp_s = stamp_s - self.stamp_s, stamp_s
        if not isfinite(self.fast_c) or dt > 10.0:
            self.fast_c = self.slow_c = self.now_c = surface_c
            self.rate_k_s = 0.0
            return
        self.fast_c += (surface_c - self.fast_c) * dt / (RATE_FAST_S + dt)
        self.slow_c += (surface_c - self.slow_c) * dt / (RATE_SLOW_S + dt)
        rate = (self.fast_c - self.slow_c) / (RATE_SLOW_S - RATE_FAST_S)
        self.rate_k_s = rate = min(max(rate, -RATE_LIMIT_K_S), RATE_LIMIT_K_S)
        self.now_c = self.fast_c + rate * (lag_s + RATE_FAST_S)


class Gates:
    """The live gates of a rig."""

    def __init__(self, config: GatesConfig) -> None:
        """Start without data, with every gate closed."""
        self.config = config
        self.target = Target()
        self.load = Average(config.load_filter_s, 10.0)
        self.slip = Average(config.slip_filter_s, 0.02)
        self.surface = SurfaceTrend()
        self._lag_s = config.ir_lag_s
        self._transient_s = config.contact_transient_s
        self._load_share = config.load_percent * 0.01
        self._speed_share = config.speed_percent * 0.01
        self._slip_share = config.slip_percent * 0.01
        self._slip_floor_m_s = config.slip_floor_mm_s * 1e-3
        self.touched_s = float("inf")
        """When the wheel last touched; samples do not count for a second afterwards (contact transient)."""

    def update(self, r: Readings, dt: float) -> int:
        """Return the mask of closed gates for this scan (0 = the sample counts)."""
        t = self.target
        mask = 0
        load = self.load.update(r.force_z_n, t.load_n, dt)
        most_n = self._load_share * t.load_n
        if not -most_n <= load - t.load_n <= most_n:
            mask |= _LOAD
        share = self._speed_share
        wheel_m_s, belt_m_s = share * t.wheel_speed_m_s, share * t.belt_speed_m_s
        if not (
            -wheel_m_s <= r.wheel_speed_m_s - t.wheel_speed_m_s <= wheel_m_s
            and -belt_m_s <= r.belt_speed_m_s - t.belt_speed_m_s <= belt_m_s
        ):
            mask |= _SPEED
        slip = self.slip.update(r.slip_m_s, t.slip_m_s, dt)
        off_m_s, floor_m_s = slip - t.slip_m_s, self._slip_floor_m_s
        if not -floor_m_s <= off_m_s <= floor_m_s and not abs(off_m_s) <= self._slip_share * t.slip_m_s:
            mask |= _SLIP
        surface = self.surface
        if r.surface_at_s > surface.stamp_s:
            surface.update(r.surface_c, r.surface_at_s, self._lag_s)
        if not -t.band_k <= surface.now_c - t.temperature_c <= t.band_k:
            mask |= _TEMPERATURE
        if not r.now_s - self.touched_s >= self._transient_s:
            mask |= _SETTLING
        return mask
