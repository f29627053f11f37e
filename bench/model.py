"""The friction model on arrays beside the same formula in bare NumPy, and as a scalar."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.effort import Effort
from bench.figures import Figure, ratio
from bench.stopwatch import cpu_us_per
from sim.physics.friction import COMPOUNDS, FrictionModel, coefficients

Array = NDArray[np.float64]

COMPOUND = "1#"


def measure(effort: Effort) -> list[Figure]:
    """Return evaluations per CPU second: the model on arrays, bare NumPy, the model for one value."""
    size = effort.pick(1_000_000, 100_000)
    rounds = effort.pick(10, 5)
    generator = np.random.default_rng(1)
    temperature_c = generator.uniform(20.0, 90.0, size)
    load_n = generator.uniform(100.0, 400.0, size)
    slip_m_s = generator.uniform(0.05, 0.4, size)
    one = FrictionModel(COMPOUND)

    def ours(count: int) -> None:
        for _ in range(count):
            coefficients(COMPOUND, temperature_c, load_n, slip_m_s)

    def theirs(count: int) -> None:
        for _ in range(count):
            bare(temperature_c, load_n, slip_m_s)

    def scalar(count: int) -> None:
        for _ in range(count):
            one.mu(40.0, 200.0, 0.3)

    arrays: list[float] = []
    numpy: list[float] = []
    scalars: list[float] = []
    for _ in range(effort.runs):
        arrays.append(size / cpu_us_per(ours, rounds))
        numpy.append(size / cpu_us_per(theirs, rounds))
        scalars.append(1.0 / cpu_us_per(scalar, effort.pick(200_000, 50_000)))
    return [
        Figure("model on arrays", "million per CPU s", tuple(arrays), note=f"{size:,} values"),
        Figure("the formula in bare NumPy", "million per CPU s", tuple(numpy)),
        ratio("model / bare NumPy, speed", arrays, numpy),
        Figure("model for one value", "million per CPU s", tuple(scalars)),
    ]


def bare(temperature_c: Array, load_n: Array, slip_m_s: Array) -> Array:
    """Return the paper's formula (Eqs 4-9), written out."""
    p = COMPOUNDS[COMPOUND]
    heat = p.alpha * np.exp(-p.beta * (temperature_c - p.tm) ** 2) + p.gamma
    return heat * (p.a1 * load_n**p.b1 * slip_m_s**p.b2 + p.a2)
