"""Two bells of friction over the reduced speed: adhesion and deformation, each at its own place (Grosch).

mu = mu_0 + adhesion exp(-(a / adhesion_width)^2) + hysteresis exp(-(h / hysteresis_width)^2), with
a = log10(aT v / v_adhesion), h = log10(aT v / v_hysteresis), v in m/s, and the shift of Williams, Landel and Ferry
(``sim.physics.wlf``).

Grosch, Proc. Roy. Soc. A 274 (1963) 21, found one maximum on smooth glass and two on silicon carbide, and that talc
lowers the slower one much more. Of four rubbers the slower one is at 6 nm times the frequency at which the loss modulus
is greatest, the faster one at 150 um times that of the loss factor (paper S, section 4). The law does not contain these
two rules: its places are parameters (``sim.physics.track`` sets them from lengths and frequencies).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated

from sim.physics.figures import refuse, with_figures
from sim.physics.materials import Components
from sim.physics.wlf import C1, C2_K, beyond_shift, heated, log10_shift


@dataclass(frozen=True, slots=True)
class TwoBellsParameters:
    """One rubber on one surface; the defaults are an SBR-like rubber on an abrasive.

    Heights and widths are assumed. The places are 6 nm and 150 um times the frequencies of such a rubber at t_ref.
    """

    mu_0: Annotated[float, "1"] = 0.5  # [A] far from both maxima
    adhesion: Annotated[float, "1"] = 0.85  # [A] above mu_0, at the slower maximum
    hysteresis: Annotated[float, "1"] = 1.6  # [A] above mu_0, at the faster one
    adhesion_width: Annotated[float, "1"] = 0.7  # [A] decades from the maximum to 1/e of it
    hysteresis_width: Annotated[float, "1"] = 0.7  # [A]
    v_adhesion: Annotated[float, "m/s"] = 2.2e-5  # speeds of the maxima at t_ref
    v_hysteresis: Annotated[float, "m/s"] = 1.74e-3
    t_ref: Annotated[float, "degC"] = -3.0  # Tg + 50 K
    c1: Annotated[float, "1"] = C1
    c2: Annotated[float, "K"] = C2_K

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        above_zero = ("adhesion_width", "hysteresis_width", "v_adhesion", "v_hysteresis", "c1", "c2")
        refuse(self, above_zero, ("mu_0", "adhesion", "hysteresis"))


class TwoBells:
    """The law with its parameters; it does not depend on the load. It knows its parts."""

    def __init__(self, parameters: TwoBellsParameters) -> None:
        """Take a rubber's parameters on a surface."""
        self._parameters = p = parameters
        self._slow, self._fast = math.log10(p.v_adhesion), math.log10(p.v_hysteresis)
        both = p.adhesion + p.hysteresis
        self._floor = p.mu_0 * (p.adhesion / both if both > 0.0 else 0.5)

    @property
    def parameters(self) -> TwoBellsParameters:
        """Its parameters."""
        return self._parameters

    def caveats(self, temperature_c: float, load_n: float, slip_m_s: float) -> Iterator[str]:
        """Yield warnings for temperatures outside the shift's range, and speeds at which friction heats the contact."""
        yield from beyond_shift(temperature_c, self._parameters.t_ref)
        yield from heated(slip_m_s)

    def components(self, temperature_c: float, load_n: float, slip_m_s: float) -> Components:
        """Return adhesion and hysteresis; mu_0 belongs to both in proportion to their heights [A]. Raises PoleError."""
        p = self._parameters
        shift = log10_shift(temperature_c, p.t_ref, p.c1, p.c2)
        adhesion, hysteresis = self._floor, p.mu_0 - self._floor
        if slip_m_s > 0.0:
            x = shift + math.log10(slip_m_s)
            a, h = (x - self._slow) / p.adhesion_width, (x - self._fast) / p.hysteresis_width
            adhesion += p.adhesion * math.exp(-a * a)
            hysteresis += p.hysteresis * math.exp(-h * h)
        return Components(adhesion, hysteresis)

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient; at standstill that of the slowest sliding, mu_0. Raises PoleError."""
        adhesion, hysteresis = self.components(temperature_c, load_n, slip_m_s)
        return adhesion + hysteresis


def two_bells(compound: str, figures: Mapping[str, float]) -> TwoBells:
    """Return the law of a compound with these figures (keys of TwoBellsParameters). Raises ValueError."""
    return TwoBells(with_figures("two_bells", TwoBellsParameters, compound, figures))
