"""The laws that are fitted, normalised at 25 degC, 200 N, 0.3 m/s: f(25) = 1 removes a redundancy.

In the paper's Eq 6, alpha and gamma may be multiplied by any number if a1 and a2 are divided by it. Here
mu = [1 + a (g(T) - g(25))] h(F) [c (v / 0.3)^b2 + a2] with g(T) = exp(-beta (T - tm)^2): h = (F / 200)^b1 inside the
velocity term is the paper's, h = exp(k (F - 200) / 200) outside is v2's. T in degC, F in N, v in m/s.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple
from math import exp
from typing import Final

from sim.physics.friction import (
    COMPOUNDS,
    V2,
    V2_LOAD_N,
    V2_SLIP_M_S,
    V2_TEMPERATURE_C,
    NormalisedParameters,
    PaperParameters,
    V2Parameters,
)
from tester.analysis.fit.fit_law import Band, Law, LawParameter, Variable
from tester.base.arrays import Array

TEMPERATURE, LOAD, SLIP = range(3)
"""Indexes of the variables."""
VARIABLES: Final = (Variable("temperature", "degC", ratio=False), Variable("load", "N"), Variable("slip", "mm/s", 1e3))

_SOURCE: Final = "the three compounds of doi 10.3390/polym16050596, widened three- to fourfold [A]"


def _band(low: float, high: float) -> Band:
    return Band(low, high, _SOURCE)


_HEAT: Final = (
    LawParameter("a", "", 0.4, 0.1, levels=("temperature", 4), band=_band(0.0, 4.0)),
    LawParameter("beta", "1/K2", 0.002, 0.1, positive=True, levels=("temperature", 4), band=_band(4e-4, 0.01)),
    LawParameter("tm", "degC", 68.0, 3.0, levels=("temperature", 4), band=_band(30.0, 110.0)),
)
_SPEED: Final = (
    LawParameter("c", "", 0.35, 0.1, positive=True, levels=("slip", 3), band=_band(0.05, 2.0)),
    LawParameter("b2", "", 1.3, 0.1, positive=True, levels=("slip", 3), band=_band(0.3, 5.0)),
    LawParameter("a2", "", 0.4, 0.1, levels=("slip", 3), band=_band(0.0, 2.0)),
)
"""The starts are near the paper's three compounds; a search from its Table 3 follows."""
_FORM: Final = "mu = [1 + a (g(T) - g(25))] {}, g(T) = exp(-beta (T - tm)^2)"


def _heat(p: Array, x: Array) -> Array:
    """Return 1 + a (g(T) - g(25)); parameters (..., p), conditions (..., n, 3)."""
    import numpy as np

    a, beta, tm = (p[..., i, None] for i in range(3))
    at_25 = np.exp(-beta * (V2_TEMPERATURE_C - tm) ** 2)
    return 1.0 + a * (np.exp(-beta * (x[..., TEMPERATURE] - tm) ** 2) - at_25)


def _speed(p: Array, x: Array) -> Array:
    """Return c (v / 0.3)^b2."""
    import numpy as np

    return p[..., 4, None] * (np.abs(x[..., SLIP]) / V2_SLIP_M_S) ** p[..., 5, None]


def _paper(p: Array, x: Array) -> Array:
    return _heat(p, x) * (_speed(p, x) * (x[..., LOAD] / V2_LOAD_N) ** p[..., 3, None] + p[..., 6, None])


def _v2(p: Array, x: Array) -> Array:
    import numpy as np

    load = np.exp(p[..., 3, None] * (x[..., LOAD] - V2_LOAD_N) / V2_LOAD_N)
    return _heat(p, x) * load * (_speed(p, x) + p[..., 6, None])


def joint_of(given: PaperParameters) -> tuple[float, ...]:
    """Return parameters of Eq 6 in the normalised form: a, beta, tm, b1, c, b2, a2."""
    at_25 = given.alpha * exp(-given.beta * (V2_TEMPERATURE_C - given.tm) ** 2) + given.gamma
    c = given.a1 * V2_LOAD_N**given.b1 * V2_SLIP_M_S**given.b2
    return given.alpha / at_25, given.beta, given.tm, given.b1, c * at_25, given.b2, given.a2 * at_25


def table_3_of(joint: Sequence[float]) -> PaperParameters:
    """Return normalised parameters in the form of the paper's Table 3, with f(25) = 1."""
    return NormalisedParameters(*joint).as_printed()


def _table_3(joint: Sequence[float]) -> Mapping[str, float]:
    found = table_3_of(joint)
    return {name: getattr(found, name) for name in ("alpha", "beta", "gamma", "a1", "a2", "b1", "b2", "tm")}


def of_v2(given: V2Parameters) -> tuple[float, ...]:
    """Return parameters of v2 in the normalised form: a, beta, tm, k, c, b2, a2."""
    a, beta, tm, c, k, b2, a2 = astuple(given)
    return a, beta, tm, k, c, b2, a2


PAPER: Final = Law(
    name="paper",
    title="the paper's Eq 6",
    formula=_FORM.format("[c (v / 0.3)^b2 (F / 200)^b1 + a2]"),
    variables=VARIABLES,
    parameters=(*_HEAT, LawParameter("b1", "", -0.5, 0.1, levels=("load", 2), band=_band(-2.0, 0.5)), *_SPEED),
    value=_paper,
    published={name: joint_of(table) for name, table in COMPOUNDS.items()},
    table=_table_3,
    table_title="as Table 3 (f(25) = 1; the paper's own differ by a factor that cancels)",
    caution="a1 is an extrapolation to 1 N: compare predictions, never a1",
)
V2_LAW: Final = Law(
    name="v2",
    title="v2, load as a factor of both terms",
    formula=_FORM.format("exp(k (F - 200) / 200) [c (v / 0.3)^b2 + a2]"),
    variables=VARIABLES,
    parameters=(*_HEAT, LawParameter("k", "", -0.4, 0.1, levels=("load", 2), band=_band(-2.0, 0.5)), *_SPEED),
    value=_v2,
    published={name: of_v2(parameters) for name, parameters in V2.items()},
)


def _power(p: Array, x: Array) -> Array:
    import numpy as np

    a, n, m = (p[..., i, None] for i in range(3))
    return a * (np.abs(x[..., SLIP]) / V2_SLIP_M_S) ** n * (x[..., LOAD] / V2_LOAD_N) ** m


def _rolls(nominal: tuple[float, ...]) -> str:
    return "" if nominal[SLIP] != 0.0 else "no slip: the law power has no value there"


POWER: Final = Law(
    name="power",
    title="powers of slip and load, at any temperature",
    formula=f"mu = a (v / {V2_SLIP_M_S:g})^n (F / {V2_LOAD_N:g})^m",
    variables=VARIABLES,
    parameters=(
        LawParameter("a", "", 0.8, 0.1, positive=True, band=_band(0.05, 5.0)),
        LawParameter("n", "", 0.2, 0.05, levels=("slip", 2), band=_band(-1.0, 2.0)),
        LawParameter("m", "", -0.2, 0.05, levels=("load", 2), band=_band(-2.0, 0.5)),
    ),
    value=_power,
    published={},
    constants={"v0": V2_SLIP_M_S, "n0": V2_LOAD_N},
    leaves_out=_rolls,
)
LAWS: Final[Mapping[str, Law]] = {law.name: law for law in (V2_LAW, PAPER, POWER)}
"""Laws by name; v2 is first: its mean error on rows outside its fit is 6.5 %, that of Eq 6 is 11.4 %."""
