"""Friction laws of a twin that differ from the fitted ones; a rig file names them, ``MODULE:NAME``.

Those of the track are bells as ``wlf_bell`` fits them, each changed in one way; those of the wheel likewise.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import exp, log10
from typing import Final

from sim.physics.friction import FrictionModel
from sim.physics.laws import FrictionLaw
from sim.physics.wlf import C1, WlfBell, WlfBellParameters, log10_shift

STEEPER: Final = 1.25
"""Factor of the shift of WLF."""
APART_DECADES: Final = 3.0
"""Of two bells that merge into one."""
PER_KELVIN: Final = 0.003
"""Fall of the amplitude."""
SLOWEST_M_S: Final = 1e-6
Value = Callable[[float, float, float], float]
"""From degC, N and m/s to a coefficient."""


@dataclass(frozen=True, slots=True)
class TwinLaw:
    """A law made of a function."""

    value: Value

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient; below the slowest speed, that of the slowest speed."""
        return self.value(temperature_c, load_n, max(slip_m_s, SLOWEST_M_S))


_BELL: Final = WlfBellParameters()


def _decades(temperature_c: float, speed_m_s: float, steeper: float = 1.0) -> float:
    """Return the distance of a speed above the bell's maximum."""
    return log10_shift(temperature_c, _BELL.t_ref, steeper * C1) + log10(speed_m_s / _BELL.v_ref)


def _on_track(shape: Callable[[float], float], steeper: float = 1.0) -> TwinLaw:
    height = _BELL.mu_max - _BELL.mu_0
    return TwinLaw(lambda t, _, v: _BELL.mu_0 + height * shape(_decades(t, v, steeper)))


def _bell(x: float, width: float = _BELL.width) -> float:
    return exp(-((x / width) ** 2))


def steeper_shift(compound: str, figures: Mapping[str, float]) -> FrictionLaw:
    """Return a bell whose shift is a quarter steeper than that of WLF."""
    return _on_track(_bell, STEEPER)


def two_bells(compound: str, figures: Mapping[str, float]) -> FrictionLaw:
    """Return two bells, three decades apart, that merge into one."""
    half = 0.5 * APART_DECADES
    return _on_track(lambda x: 0.7 * (_bell(x - half, 2.2) + _bell(x + half, 2.2)))


def falling(compound: str, figures: Mapping[str, float]) -> FrictionLaw:
    """Return a bell whose amplitude falls by 0.3 % a kelvin."""
    law = WlfBell(_BELL)
    return TwinLaw(lambda t, load, v: law.mu(t, load, v) * (1.0 - PER_KELVIN * (t - 10.0)))


def power_of_speed(compound: str, figures: Mapping[str, float]) -> FrictionLaw:
    """Return a power of the speed, at any temperature."""
    return TwinLaw(lambda t, load, v: 1.2 * (v / 1e-4) ** 0.1)


def right_on_track(compound: str, figures: Mapping[str, float]) -> FrictionLaw:
    """Return the bell that is fitted."""
    return WlfBell(_BELL)


# of a wheel: v2 is fitted ----------------------------------------------------------------------------------------


def right_on_wheel(compound: str, figures: Mapping[str, float]) -> FrictionLaw:
    """Return the law v2 of a compound."""
    return FrictionModel(compound, "v2")


def _on_wheel(compound: str, shape: Callable[[float], float], steeper: float = 1.0) -> TwinLaw:
    """Return a bell over aT v about 70 degC and 0.3 m/s, as high as the compound's v2, that falls with load as that."""
    law = FrictionModel(compound, "v2")
    low, high = law.mu(25.0, 200.0, 0.3), law.mu(70.0, 200.0, 0.3)
    middle = log10_shift(70.0, -3.0, steeper * C1) + log10(0.3)

    def value(t: float, load: float, v: float) -> float:
        x = log10_shift(t, -3.0, steeper * C1) + log10(max(v, 1e-3)) - middle
        return (low + (high - low) * shape(x)) * law.mu(70.0, load, 0.3) / high

    return TwinLaw(value)


def steeper_shift_on_wheel(compound: str, figures: Mapping[str, float]) -> FrictionLaw:
    """Return a bell over aT v, where v2 has temperature and speed apart, with a shift steeper than that of WLF."""
    return _on_wheel(compound, lambda x: _bell(x, 1.0), STEEPER)


def two_bells_on_wheel(compound: str, figures: Mapping[str, float]) -> FrictionLaw:
    """Return two bells over aT v, a decade apart, that merge into one."""
    return _on_wheel(compound, lambda x: 0.7 * (_bell(x - 0.5, 0.7) + _bell(x + 0.5, 0.7)))


def falling_on_wheel(compound: str, figures: Mapping[str, float]) -> FrictionLaw:
    """Return v2 with an amplitude that falls by 0.3 % a kelvin."""
    law = FrictionModel(compound, "v2")
    return TwinLaw(lambda t, load, v: law.mu(t, load, v) * (1.0 - PER_KELVIN * (t - 55.0)))


def power_on_wheel(compound: str, figures: Mapping[str, float]) -> FrictionLaw:
    """Return powers of speed and load, at any temperature."""
    middle = FrictionModel(compound, "v2").mu(40.0, 200.0, 0.3)
    return TwinLaw(lambda t, load, v: middle * (max(v, 1e-3) / 0.3) ** 0.2 * (load / 200.0) ** -0.3)


