"""Two simple laws, for rubber whose friction ``wlf_bell`` does not describe.

    power:      mu = a (v / v0)^n (load / n0)^m
    arrhenius:  mu = mu_0 + (mu_max - mu_0) exp(-(x / width)^2),  x = log10(aT v / v_ref)

log10 aT = Ea / (R ln 10) (1 / T - 1 / T_ref), with T in K. In ``arrhenius`` the maximum of friction moves to higher
speeds with rising temperature. The shift has one activation energy Ea. ``wlf_bell`` shifts by WLF instead, for a rubber
above its glass transition.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import exp, log, log10
from typing import Annotated, Final

from sim.physics.figures import refuse, with_figures
from sim.physics.wlf import heated

GAS_J_MOL_K: Final = 8.314462618
KELVIN: Final = 273.15
SLOWEST_M_S: Final = 1e-6
"""In ``power``, slower sliding has the coefficient of this speed, m/s, because the law has no limit at 0 [A]."""


@dataclass(frozen=True, slots=True)
class PowerParameters:
    """One rubber on one track, at any temperature."""

    a: Annotated[float, "1"] = 1.0  # [A] the coefficient at v0 and n0
    v0: Annotated[float, "m/s"] = 0.1
    n: Annotated[float, "1"] = 0.1  # [A] of the speed
    n0: Annotated[float, "N"] = 10.0
    m: Annotated[float, "1"] = -1.0 / 9.0  # [A] of the load

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        refuse(self, ("a", "v0", "n0"))


@dataclass(frozen=True, slots=True)
class ArrheniusParameters:
    """One rubber on one track."""

    mu_0: Annotated[float, "1"] = 0.5  # [A] far from the maximum, on either side
    mu_max: Annotated[float, "1"] = 2.2  # [A]
    width: Annotated[float, "1"] = 3.0  # [A] decades from the maximum to 1/e of it
    v_ref: Annotated[float, "m/s"] = 0.0755  # [A] speed of the maximum at t_ref
    t_ref: Annotated[float, "degC"] = 20.0
    energy: Annotated[float, "kJ/mol"] = 90.0  # [A] Ea

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        refuse(self, ("width", "v_ref", "energy"))
        if not 0.0 <= self.mu_0 <= self.mu_max:
            raise ValueError(f"ArrheniusParameters.mu_0 is 0 to mu_max ({self.mu_max:g}), not {self.mu_0!r}")
        if not self.t_ref > -KELVIN:
            raise ValueError(f"ArrheniusParameters.t_ref is above {-KELVIN:g} degC, not {self.t_ref!r}")


class PowerLaw:
    """The power law with its parameters; it does not depend on the temperature."""

    def __init__(self, parameters: PowerParameters) -> None:
        """Take a rubber's parameters."""
        self.parameters = parameters

    def caveats(self, temperature_c: float, load_n: float, slip_m_s: float) -> Iterator[str]:
        """Yield that the temperature does not count, and a warning for speeds at the law's limit."""
        yield "the law power knows no temperature: it is of the one at which it was measured"
        if slip_m_s < SLOWEST_M_S:
            yield f"below {1e3 * SLOWEST_M_S:g} mm/s the coefficient is that of this speed"

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient."""
        p = self.parameters
        return p.a * (max(slip_m_s, SLOWEST_M_S) / p.v0) ** p.n * (load_n / p.n0) ** p.m


class Arrhenius:
    """The bell with its parameters; it does not depend on the load."""

    def __init__(self, parameters: ArrheniusParameters) -> None:
        """Take a rubber's parameters."""
        self.parameters = parameters

    def caveats(self, temperature_c: float, load_n: float, slip_m_s: float) -> Iterator[str]:
        """Yield a warning for speeds at which friction heats the contact: the law does not include this."""
        yield from heated(slip_m_s)

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient; at standstill mu_0. Raises ValueError at absolute zero and below."""
        p = self.parameters
        if not temperature_c > -KELVIN:
            raise ValueError(f"a temperature is above {-KELVIN:g} degC, not {temperature_c!r}")
        if not slip_m_s > 0.0:
            return p.mu_0
        inverse_k = 1.0 / (temperature_c + KELVIN) - 1.0 / (p.t_ref + KELVIN)
        shift = 1e3 * p.energy / GAS_J_MOL_K * inverse_k / log(10.0)
        x = (log10(slip_m_s / p.v_ref) + shift) / p.width
        return p.mu_0 + (p.mu_max - p.mu_0) * exp(-x * x)


def power(compound: str, figures: Mapping[str, float]) -> PowerLaw:
    """Return the law of a compound with these figures (keys of PowerParameters). Raises ValueError."""
    return PowerLaw(with_figures("power", PowerParameters, compound, figures))


def arrhenius(compound: str, figures: Mapping[str, float]) -> Arrhenius:
    """Return the law of a compound with these figures (keys of ArrheniusParameters). Raises ValueError."""
    return Arrhenius(with_figures("arrhenius", ArrheniusParameters, compound, figures))
