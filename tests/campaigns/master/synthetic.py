"""Sets of a two-peak master curve with known truth, and sets without a master curve."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np

from sim.physics.wlf import log10_shift
from tester.analysis.master_curve.points import MasterPoint, MasterSource

TEMPERATURES_C: Final = tuple(-5.0 + 9.0 * i for i in range(11))
SPEEDS_M_S: Final = tuple(10.0 ** (-6.0 + 0.5 * i) for i in range(9))
"""1e-4 to 1 cm/s."""
TS_C: Final = 30.0
HALF_K: Final = 50.0
"""Half of the range of temperatures."""


def two_peaks(x: float, height: float = 1.0) -> float:
    """Return mu of an adhesion peak and a deformation peak; ``height`` is that of the adhesion peak against 1."""
    return 0.5 + 1.2 * height * np.exp(-(((x + 3.5) / 1.5) ** 2)) + np.exp(-(((x - 0.5) / 1.3) ** 2))


def wlf(celsius: float) -> float:
    """Return log10 aT of the truth."""
    return log10_shift(celsius, TS_C)


def arrhenius(celsius: float) -> float:
    """Return log10 aT of an activated process of 100 kJ/mol."""
    return 100e3 / (np.log(10.0) * 8.314) * (1.0 / (celsius + 273.15) - 1.0 / (TS_C + 273.15))


def linear(celsius: float) -> float:
    """Return log10 aT of a decade for every 12 K."""
    return (TS_C - celsius) / 12.0


def synthetic(
    seed: int,
    noise: float,
    *,
    shift: Callable[[float], float] = wlf,
    factors: float = 0.0,
    heights: float = 0.0,
    bias_k: float = 0.0,
    thermometer_k: float = 0.0,
    power: float | None = None,
) -> list[MasterPoint]:
    """Return 99 conditions. ``noise``: standard deviation of ln mu; ``factors``: standard deviation of a factor of each
    temperature; ``heights``: share by which the adhesion peak is lower at the warmest temperature, and higher at the
    coldest; ``bias_k``: of all temperatures; ``power``: exponent of a power law instead of the peaks.
    """
    random = np.random.default_rng(seed)
    source = MasterSource("synthetic", 0.0, thermometer_k)
    own = factors * random.standard_normal(len(TEMPERATURES_C))
    points: list[MasterPoint] = []
    for celsius, factor in zip(TEMPERATURES_C, own, strict=True):
        height = 1.0 - heights * (celsius - np.mean(TEMPERATURES_C)) / HALF_K
        for speed in SPEEDS_M_S:
            x = np.log10(speed) + shift(celsius)
            mu = 10.0 ** (power * x) if power is not None else two_peaks(float(x), float(height))
            mu *= np.exp(factor + noise * random.standard_normal())
            points.append(
                MasterPoint(f"{len(points) + 1}", "rubber", speed, celsius + bias_k, celsius, float(mu), source)
            )
    return points


FAILING: Final[Mapping[str, Mapping[str, object]]] = {
    "factors of 10 % by temperature": {"factors": 0.10},
    "a shift of a decade for 12 K": {"shift": linear},
    "a shift after Arrhenius, 100 kJ/mol": {"shift": arrhenius},
    "an adhesion peak 25 % lower when warm, higher when cold": {"heights": 0.25},
}
"""Sets that do not collapse."""
