"""The frequencies at which a rubber loses most: the maxima of its loss modulus and of its loss factor."""

from __future__ import annotations

from math import nan, pi
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from sim.physics.materials import OutsideError
from sim.physics.wlf import PoleError

if TYPE_CHECKING:
    from sim.physics.materials import Array, ShearModulus

DECADES: Final = (-6, 14)
"""Powers of ten of rad/s that bound the search for maxima of the moduli."""
A_DECADE: Final = 50


class LossMaxima(NamedTuple):
    """Frequencies in Hz; NaN where the known moduli have no such maximum."""

    loss_modulus_hz: float
    loss_factor_hz: float


def loss_maxima(modulus: ShearModulus, celsius: float) -> LossMaxima:
    """Return the maxima of a modulus at a temperature in degC."""
    omega, storage, loss = _known(modulus, celsius)
    factor = loss / storage if loss.size else loss
    return LossMaxima(_maximum(omega, loss) / (2.0 * pi), _maximum(omega, factor) / (2.0 * pi))


def _known(modulus: ShearModulus, celsius: float) -> tuple[Array, Array, Array]:
    """Return frequencies at which a modulus is known at a temperature, with G' and G''."""
    rows: list[tuple[float, float, float]] = []
    for omega in np.logspace(*DECADES, (DECADES[1] - DECADES[0]) * A_DECADE + 1):
        try:
            value = complex(modulus.complex_pa(np.array([omega]), celsius)[0])
        except (OutsideError, PoleError):
            continue
        if value.real > 0.0 and value.imag > 0.0:
            rows.append((float(omega), value.real, value.imag))
    table = np.array(rows).reshape(-1, 3)
    return table[:, 0], table[:, 1], table[:, 2]


def _maximum(omega: Array, values: Array) -> float:
    """Return the place of the maximum, by a parabola over log omega; NaN where that is an end of the known range."""
    if values.size < 3:
        return nan
    i = int(np.argmax(values))
    if i in (0, values.size - 1):
        return nan
    y, x = np.log(values[i - 1 : i + 2]), np.log(omega[i - 1 : i + 2])
    bend = float(y[0] - 2.0 * y[1] + y[2])
    share = 0.5 * float(y[0] - y[2]) / bend if bend < 0.0 else 0.0
    return float(np.exp(x[1] + share * (x[2] - x[1])))
