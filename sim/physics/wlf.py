"""A bell of friction over the reduced speed: rubber with equivalent time and temperature (Williams, Landel, Ferry).

mu = mu_0 + (mu_max - mu_0) exp(-(x / width)^2), x = log10(aT v / v_ref), with v in m/s and the shift

    log10 aT = -C1 (T - T_ref) / (C2 + T - T_ref),  T in degC.

Grosch, Proc. Roy. Soc. A 274 (1963) 21, found that the friction of rubber at all speeds and temperatures falls on one
curve over aT v, with a maximum. With T_ref = Tg + 50 K the constants are nearly the same for all rubbers: C1 = 8.86,
C2 = 101.5 K (Williams, Landel, Ferry 1955), valid from Tg to Tg + 100 K. At T_ref - C2 the shift has a pole: at
or below it the law is not defined, and ``PoleError`` is raised.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Final

from sim.physics.figures import refuse, with_figures

C1: Final = 8.86
C2_K: Final = 101.5
"""Constants of the shift for T_ref = Tg + 50 K."""
GLASS_TO_REFERENCE_K: Final = 50.0
FITTED_K: Final = 100.0
"""Span above the glass transition in which the constants hold, K."""


HEATING_M_S: Final = 0.01
"""Slower than this, friction of some newtons does not heat the contact: 20 N at a coefficient of 2 are 0.4 W [A]."""


def heated(slip_m_s: float) -> Iterator[str]:
    """Yield a warning if friction heats the contact at a speed: a law without heat does not include this."""
    if slip_m_s > HEATING_M_S:
        yield (
            f"above {1e3 * HEATING_M_S:g} mm/s friction heats the contact, and the law knows no heat: the temperature"
            " is that of the contact"
        )


def beyond_shift(temperature_c: float, t_ref_c: float) -> Iterator[str]:
    """Yield a warning for a temperature at which the shift with this reference, Tg + 50 K, was never found to hold."""
    low_c = t_ref_c - GLASS_TO_REFERENCE_K
    if not low_c <= temperature_c <= low_c + FITTED_K:
        yield (
            f"{temperature_c:g} degC is outside {low_c:g} to {low_c + FITTED_K:g} degC, from the glass transition to"
            f" {FITTED_K:g} K above it, where the shift of WLF holds"
        )


class PoleError(ValueError):
    """A temperature at or below the pole of the shift."""


def log10_shift(temperature_c: float, t_ref_c: float, c1: float = C1, c2_k: float = C2_K) -> float:
    """Return log10 aT of a temperature in degC, 0 at t_ref_c. Raises PoleError at and below t_ref_c - c2_k."""
    off_k = temperature_c - t_ref_c
    if not off_k > -c2_k:
        raise PoleError(
            f"{temperature_c:g} degC: the WLF shift with t_ref {t_ref_c:g} degC and c2 {c2_k:g} K holds only above"
            f" {t_ref_c - c2_k:g} degC"
        )
    return -c1 * off_k / (c2_k + off_k)


@dataclass(frozen=True, slots=True)
class WlfBellParameters:
    """One rubber on one track. The defaults are an SBR-like rubber on an abrasive.

    Its shift is that of a rubber with Tg = -53 degC [A]; the maximum is at 0.0755 m/s at 20 degC: the grit's length
    150 um (Grosch) times the rubber's loss frequency 3162 rad/s over 2 pi [A], which is 1.74e-3 m/s at T_ref. Heights
    and width are assumed.
    """

    mu_0: Annotated[float, "1"] = 0.5  # [A] far from the maximum, on either side
    mu_max: Annotated[float, "1"] = 2.2  # [A]
    width: Annotated[float, "1"] = 3.0  # [A] decades from the maximum to 1/e of it
    v_ref: Annotated[float, "m/s"] = 1.74e-3  # speed of the maximum at t_ref
    t_ref: Annotated[float, "degC"] = -3.0  # Tg + 50 K
    c1: Annotated[float, "1"] = C1
    c2: Annotated[float, "K"] = C2_K

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        refuse(self, ("width", "v_ref", "c1", "c2"))
        if not 0.0 <= self.mu_0 <= self.mu_max:
            raise ValueError(f"WlfBellParameters.mu_0 is 0 to mu_max ({self.mu_max:g}), not {self.mu_0!r}")


class WlfBell:
    """The law with its parameters; it does not depend on the load."""

    def __init__(self, parameters: WlfBellParameters) -> None:
        """Take a rubber's parameters."""
        self._parameters = parameters
        self._x_ref = math.log10(parameters.v_ref)

    @property
    def parameters(self) -> WlfBellParameters:
        """Its parameters."""
        return self._parameters

    def shift(self, temperature_c: float) -> float:
        """Return log10 aT, 0 at t_ref. Raises PoleError."""
        p = self._parameters
        return log10_shift(temperature_c, p.t_ref, p.c1, p.c2)

    def caveats(self, temperature_c: float, load_n: float, slip_m_s: float) -> Iterator[str]:
        """Yield warnings for temperatures outside the shift's range, and speeds at which friction heats the contact."""
        yield from beyond_shift(temperature_c, self._parameters.t_ref)
        yield from heated(slip_m_s)

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient; at standstill that of the slowest sliding, mu_0. Raises PoleError."""
        p = self._parameters
        shift = self.shift(temperature_c)
        if not slip_m_s > 0.0:
            return p.mu_0
        x = (shift + math.log10(slip_m_s) - self._x_ref) / p.width
        return p.mu_0 + (p.mu_max - p.mu_0) * math.exp(-x * x)


def wlf_bell(compound: str, figures: Mapping[str, float]) -> WlfBell:
    """Return the law of a compound with these figures (keys of WlfBellParameters). Raises ValueError."""
    return WlfBell(with_figures("wlf_bell", WlfBellParameters, compound, figures))
