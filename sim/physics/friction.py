"""Friction coefficient of rubber on the abrasive belt, as formulas of temperature, load and slip speed.

Source: Polymers 2024, 16(5), 596, doi 10.3390/polym16050596, CC BY 4.0 ("the paper"), Eqs 1 and 4-9. The
paper prints the slip speed in mm/s, but its coefficients reproduce its data only with m/s. So m/s is
used here. Temperature is in degC, load in N, slip speed (resultant) in m/s. Slip direction and
sideslip are in ``sim.physics.slip``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Annotated, Any, Final

from sim.physics.figures import refuse

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


MODEL_NAMES: Final = ("paper", "v2")
"""The friction formulas here: the paper's (Eqs 4-9) and the better seven-parameter fit."""


class UnknownCompoundError(ValueError):
    """A compound without a friction model; the message names the compounds that have one."""

    def __init__(self, compound: str) -> None:
        """Keep the compound's name."""
        super().__init__(f"no friction model for compound {compound!r}; known: {', '.join(KNOWN)}")
        self.compound = compound


@dataclass(frozen=True, slots=True)
class PaperParameters:
    """mu = (alpha exp(-beta (t - tm)^2) + gamma) (a1 p^b1 v^b2 + a2), Eqs 4-9; degC, N, m/s."""

    alpha: Annotated[float, "1"]
    beta: Annotated[float, "1/K2"]
    gamma: Annotated[float, "1"]
    a1: Annotated[float, "1"]
    a2: Annotated[float, "1"]
    b1: Annotated[float, "1"]
    b2: Annotated[float, "1"]
    tm: Annotated[float, "degC"]

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        refuse(self, ())


@dataclass(frozen=True, slots=True)
class V2Parameters:
    """mu = (1 + a (g(t) - g(25))) exp(k (p - 200) / 200) (c (v / 0.3)^b2 + a2).

    g(t) = exp(-beta (t - tm)^2); t in degC, p in N, v in m/s. Fitted to the 113 readable rows of both of the paper's
    appendices (`tester fit appendix-a appendix-b`; none whose value is inferred): mean error 4.0 %.
    """

    a: Annotated[float, "1"]
    beta: Annotated[float, "1/K2"]
    tm: Annotated[float, "degC"]
    c: Annotated[float, "1"]
    k: Annotated[float, "1"]
    b2: Annotated[float, "1"]
    a2: Annotated[float, "1"]

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        refuse(self, ("beta", "c", "b2"))


@dataclass(frozen=True, slots=True)
class NormalisedParameters:
    """The paper's Eq 6 as (1 + a (g(t) - g(25))) (c (v / 0.3)^b2 (p / 200)^b1 + a2), without its redundancy.

    In Eq 6, alpha and gamma may be multiplied by any number if a1 and a2 are divided by it.
    """

    a: Annotated[float, "1"]
    beta: Annotated[float, "1/K2"]
    tm: Annotated[float, "degC"]
    b1: Annotated[float, "1"]
    c: Annotated[float, "1"]
    b2: Annotated[float, "1"]
    a2: Annotated[float, "1"]

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        refuse(self, ("beta", "c", "b2"))

    def as_printed(self) -> PaperParameters:
        """Return the parameters in the form of the paper's Table 3, with f(25) = 1."""
        gamma = 1.0 - self.a * math.exp(-self.beta * (V2_TEMPERATURE_C - self.tm) ** 2)
        a1 = self.c * V2_LOAD_N**-self.b1 * V2_SLIP_M_S**-self.b2
        return PaperParameters(self.a, self.beta, gamma, a1, self.a2, self.b1, self.b2, self.tm)


COMPOUNDS: Final[dict[str, PaperParameters]] = {
    "1#": PaperParameters(0.2238, 0.002231, 1.013, 10.3850, 0.3975, -0.3834, 1.200, 70.0),
    "2#": PaperParameters(0.6278, 0.001974, 0.980, 12.1476, 0.3204, -0.4440, 1.550, 68.0),
    "3#": PaperParameters(0.8712, 0.002744, 1.028, 71.9234, 0.5443, -0.6167, 1.455, 73.0),
}
"""The paper's three compounds, coefficients verbatim (Eqs 7-9)."""

V2: Final[dict[str, V2Parameters]] = {
    "1#": V2Parameters(0.224424, 0.002105, 66.701, 0.348869, -0.343363, 1.105863, 0.398528),
    "2#": V2Parameters(0.593770, 0.002206, 69.238, 0.197902, -0.420332, 1.480220, 0.314958),
    "3#": V2Parameters(0.845325, 0.002587, 72.263, 0.510386, -0.567486, 1.322839, 0.552537),
}

KNOWN: Final[list[str]] = list(COMPOUNDS)
"""Compounds that have a friction model."""

V2_TEMPERATURE_C: Final = 25.0
V2_LOAD_N: Final = 200.0
V2_SLIP_M_S: Final = 0.3
"""The point at which the v2 form is normalised."""


def _checked(compound: str, model: str) -> None:
    """Raise UnknownCompoundError, or ValueError for an unknown model."""
    if compound not in COMPOUNDS:
        raise UnknownCompoundError(compound)
    if model not in MODEL_NAMES:
        raise ValueError(f"friction model is one of {', '.join(MODEL_NAMES)}, not {model!r}")


class FrictionModel:
    """One compound's coefficient as a fast scalar function.

    Both forms reduce to ``(heat exp(-beta (t - tm)^2) + base) (speed p^b1 v^b2 + a2)``. In the v2 form an
    exponential of load replaces p^b1 and multiplies both terms: ``exp(load (p - 200))``; ``load`` is 0 in the
    paper's form.
    """

    def __init__(
        self, compound: str, model: str = "paper", parameters: PaperParameters | V2Parameters | None = None
    ) -> None:
        """Take a compound's constants, or the constants given, whatever the compound's name.

        Raises UnknownCompoundError, or ValueError for an unknown model.
        """
        if parameters is None:
            _checked(compound, model)
            parameters = COMPOUNDS[compound] if model == "paper" else V2[compound]
        self._is_paper = isinstance(parameters, PaperParameters)
        if isinstance(parameters, PaperParameters):
            p = parameters
            self._heat, self._beta, self._tm, self._base = p.alpha, p.beta, p.tm, p.gamma
            self._speed, self._b1, self._b2, self._a2, self._load = p.a1, p.b1, p.b2, p.a2, 0.0
        else:
            q = parameters
            at_25 = math.exp(-q.beta * (V2_TEMPERATURE_C - q.tm) ** 2)
            self._heat, self._beta, self._tm, self._base = q.a, q.beta, q.tm, 1.0 - q.a * at_25
            self._speed, self._b1, self._b2, self._a2 = q.c * V2_SLIP_M_S**-q.b2, 0.0, q.b2, q.a2
            self._load = q.k / V2_LOAD_N

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient at a surface temperature, a load above 0 and a slip speed of at least 0."""
        off = temperature_c - self._tm
        heat = self._heat * math.exp(-self._beta * off * off) + self._base
        speed = self._speed * slip_m_s**self._b2
        if self._is_paper:
            return heat * (speed * load_n**self._b1 + self._a2)
        return heat * (speed + self._a2) * math.exp(self._load * (load_n - V2_LOAD_N))


def model_of(model: str, compound: str, figures: Mapping[str, float]) -> FrictionModel:
    """Return a model with figures of its own: those of V2Parameters for ``v2``; for ``paper`` those of Table 3, or of
    NormalisedParameters. Raises ValueError."""
    groups: list[Any] = [PaperParameters, NormalisedParameters] if model == "paper" else [V2Parameters]
    for group in groups:
        names = [item.name for item in fields(group)]
        if sorted(names) == sorted(figures):
            if not figures["b2"] > 0.0:
                raise ValueError(f"b2 must be above 0, not {figures['b2']!r}: a wheel also rolls without slip")
            made = group(**figures)
            return FrictionModel(compound, model, made.as_printed() if group is NormalisedParameters else made)
    ways = ", or ".join(", ".join(item.name for item in fields(group)) for group in groups)
    raise ValueError(f"law {model!r} takes the figures {ways}, all of them, not {', '.join(figures)}")


def coefficient(
    compound: str, temperature_c: float, load_n: float, slip_m_s: float, model: str = "paper"
) -> float:
    """Return the coefficient of one condition.

    Surface temperature in degC, load in N (above 0), slip speed in m/s (resultant, at least 0). Raises
    UnknownCompoundError and ValueError for numbers outside those ranges.
    """
    in_range(temperature_c, load_n, slip_m_s)
    return FrictionModel(compound, model).mu(temperature_c, load_n, slip_m_s)


def in_range(temperature_c: float, load_n: float, slip_m_s: float) -> None:
    """Raise ValueError unless these values (degC, N, m/s) are valid for a law."""
    if not (math.isfinite(temperature_c) and math.isfinite(load_n) and math.isfinite(slip_m_s)):
        raise ValueError("temperature, load and slip speed must be finite")
    if load_n <= 0.0:
        raise ValueError(f"load must be above 0 N, not {load_n!r}")
    if slip_m_s < 0.0:
        raise ValueError(f"slip speed is a magnitude, at least 0 m/s, not {slip_m_s!r}")


def thermal_factor(parameters: PaperParameters, temperature_c: float) -> float:
    """Return the temperature factor alpha exp(-beta (t - tm)^2) + gamma (Eq 6)."""
    off = temperature_c - parameters.tm
    return parameters.alpha * math.exp(-parameters.beta * off * off) + parameters.gamma


def evaluate(
    parameters: PaperParameters | V2Parameters,
    temperature_c: ArrayLike,
    load_n: ArrayLike,
    slip_m_s: ArrayLike,
) -> NDArray[np.float64]:
    """Return the coefficients of many conditions for any set of parameters (broadcast together; for fits)."""
    import numpy as np

    t = np.asarray(temperature_c, dtype=np.float64)
    p = np.asarray(load_n, dtype=np.float64)
    v = np.asarray(slip_m_s, dtype=np.float64)
    heat = np.exp(-parameters.beta * (t - parameters.tm) ** 2)
    if isinstance(parameters, PaperParameters):
        speed = parameters.a1 * p**parameters.b1 * v**parameters.b2 + parameters.a2
        return (parameters.alpha * heat + parameters.gamma) * speed
    at_25 = math.exp(-parameters.beta * (V2_TEMPERATURE_C - parameters.tm) ** 2)
    speed = parameters.c * (v / V2_SLIP_M_S) ** parameters.b2 + parameters.a2
    load = np.exp(parameters.k * (p - V2_LOAD_N) / V2_LOAD_N)
    return (1.0 + parameters.a * (heat - at_25)) * load * speed


def coefficients(
    compound: str,
    temperature_c: ArrayLike,
    load_n: ArrayLike,
    slip_m_s: ArrayLike,
    model: str = "paper",
) -> NDArray[np.float64]:
    """Return the coefficients of many conditions of one compound, broadcast together; see ``coefficient``."""
    _checked(compound, model)
    parameters = COMPOUNDS[compound] if model == "paper" else V2[compound]
    return evaluate(parameters, temperature_c, load_n, slip_m_s)
