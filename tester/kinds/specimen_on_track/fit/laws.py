"""Laws fitted to a specimen on a track: two use measurements alone, two also moduli and a surface.

v is the sliding speed in m/s, T in degC, the load F in N. A law based on moduli is bound to a compound and a surface
before it is fitted (``tester.kinds.specimen_on_track.fit.bound``).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final, NoReturn

from sim.physics.wlf import C1, C2_K, FITTED_K, GLASS_TO_REFERENCE_K
from tester.analysis.fit.fit_law import Band, FitError, Law, LawParameter, Variable
from tester.base.arrays import Array
from tester.kinds.specimen_on_track.fit.run_data import LOAD, SPEED, TEMPERATURE, VARIABLES

FITTED: Final[tuple[Variable, ...]] = VARIABLES[:3]
"""Speed, temperature, load; the interface belongs to the group."""
V0_M_S, N0_N = 0.1, 10.0
"""Speed and load at which the power law's factor equals the coefficient."""


def _bell(p: Array, x: Array) -> Array:
    import numpy as np

    mu_0, mu_max, width, v_ref, t_ref = (p[..., i, None] for i in range(5))
    off_k = x[..., TEMPERATURE] - t_ref
    with np.errstate(divide="ignore", invalid="ignore"):  # the law is undefined at and below its pole
        shift = np.where(off_k > -C2_K, -C1 * off_k / (C2_K + off_k), np.nan)
    decades = shift + np.log10(x[..., SPEED] / v_ref)
    return mu_0 + (mu_max - mu_0) * np.exp(-((decades / width) ** 2))


def _power(p: Array, x: Array) -> Array:
    a, n, m = (p[..., i, None] for i in range(3))
    return a * (x[..., SPEED] / V0_M_S) ** n * (x[..., LOAD] / N0_N) ** m


_GLASS_C: Final = (-110.0, 10.0)
"""Range of the glass transitions of rubbers [A]; butadiene rubber is at the lower end."""
NEAR_K: Final = 15.0
"""Greatest deviation of a bell's t_ref from the file's Tg + 50 K [A]: Tg by two methods differs by 5 to 10 K."""
_RUBBER: Final = "[A] rubber on a hard track"


def _generic(low: float, high: float) -> Band:
    return Band(low, high, _RUBBER)


def reference_band(glass_c: float | None) -> Band:
    """Return the range of the t_ref of a bell for a compound with this glass transition, degC."""
    if glass_c is not None:
        middle_c = glass_c + GLASS_TO_REFERENCE_K
        source = f"Tg {glass_c:g} degC of the compound's file + 50 +- {NEAR_K:g} K [A]"
        return Band(middle_c - NEAR_K, middle_c + NEAR_K, source)
    low, high = (glass_c + GLASS_TO_REFERENCE_K for glass_c in _GLASS_C)
    return Band(low, high, "Tg + 50 K of any rubber [A]")


def _beyond_shift(parameters: Sequence[float], measured: Sequence[tuple[float, ...]]) -> Iterator[str]:
    """Yield how many conditions are outside the validity of the bell's shift."""
    glass_c = parameters[4] - GLASS_TO_REFERENCE_K
    beyond = sum(not glass_c <= condition[TEMPERATURE] <= glass_c + FITTED_K for condition in measured)
    if beyond:
        yield (
            f"{beyond} conditions are outside {glass_c:.0f} to {glass_c + FITTED_K:.0f} degC: the shift of WLF holds"
            f" from the glass transition to {FITTED_K:g} K above it"
        )


def _upside_down(parameters: Sequence[float]) -> str:
    """Return why a bell's heights are not one's, "" where they are."""
    mu_0, mu_max = parameters[0], parameters[1]
    return "" if mu_0 <= mu_max else f"its maximum ({mu_max:.3g}) is below what is far from it ({mu_0:.3g})"


WLF_BELL: Final = Law(
    name="wlf_bell",
    title="a bell over the reduced speed",
    formula="mu = mu_0 + (mu_max - mu_0) exp(-(log10(aT v / v_ref) / width)^2), "
    f"log10 aT = -{C1:g} (T - t_ref) / ({C2_K:g} + T - t_ref)",
    variables=FITTED,
    parameters=(
        LawParameter("mu_0", "", 0.5, 0.1, positive=True, levels=("speed", 3), band=_generic(0.02, 3.0)),
        LawParameter("mu_max", "", 2.0, 0.1, positive=True, levels=("speed", 3), band=_generic(0.1, 6.0)),
        LawParameter("width", "", 3.0, 0.1, positive=True, levels=("speed", 3), band=_generic(0.5, 8.0)),
        LawParameter("v_ref", "m/s", 2e-3, 0.5, positive=True, levels=("speed", 3), band=_generic(1e-9, 10.0)),
        LawParameter("t_ref", "degC", 0.0, 3.0, levels=("temperature", 3), band=reference_band(None)),
    ),
    value=_bell,
    published={},
    beyond=_beyond_shift,
    improper=_upside_down,
    starts=({"v_ref": 1e-6}, {"v_ref": 1.0}),
)
POWER: Final = Law(
    name="power",
    title="powers of speed and load",
    formula=f"mu = a (v / {V0_M_S:g})^n (F / {N0_N:g})^m",
    variables=FITTED,
    parameters=(
        LawParameter("a", "", 1.0, 0.1, positive=True, band=_generic(0.02, 6.0)),
        LawParameter("n", "", 0.1, 0.05, levels=("speed", 2), band=_generic(-1.0, 1.0)),
        LawParameter("m", "", -0.1, 0.05, levels=("load", 2), band=_generic(-1.0, 1.0)),
    ),
    value=_power,
    published={},
    constants={"v0": V0_M_S, "n0": N0_N},
)


def _unbound(p: Array, x: Array) -> NoReturn:
    raise FitError("a law of materials is fitted to one compound on one surface")


GRETA: Final = Law(
    name="greta",
    title="adhesion and hysteresis of the compound's modulus on the surface's two waves",
    formula="mu = (tau_s / p) (Ac / A0) + mu_hys, tau_s = tau_s0 [1 + (Einf / E0) / (1 + v_c / v)^n]",
    variables=FITTED,
    parameters=(
        LawParameter("tau_s0", "Pa", 1e4, 0.2, positive=True, band=_generic(1e2, 1e8)),
        LawParameter("v_c", "m/s", 1.0, 0.5, positive=True, levels=("speed", 3), band=_generic(1e-6, 1e3)),
        LawParameter("n", "", 0.6, 0.2, positive=True, levels=("speed", 3), band=_generic(0.05, 5.0)),
    ),
    value=_unbound,
    published={},
)
PERSSON: Final = Law(
    name="persson",
    title="hysteresis of the compound's modulus on the surface's spectrum up to the wave number q1",
    formula="mu = 1/2 int_q0^q1 dq q^3 C(q) P(q) int dphi cos(phi) Im[2 G(q v cos(phi), T) / (p (1 - nu))]",
    variables=FITTED,
    parameters=(LawParameter("q1", "1/m", 1e5, 0.3, positive=True),),
    value=_unbound,
    published={},
)


def below_glass(
    glass_c: float | None, parameters: Sequence[float], measured: Sequence[tuple[float, ...]]
) -> Iterator[str]:
    """Yield how many conditions are below the compound's glass transition, degC (``Law.beyond``)."""
    below = sum(condition[TEMPERATURE] < glass_c for condition in measured) if glass_c is not None else 0
    if below:
        yield f"{below} conditions are below the glass transition, {glass_c:g} degC: rubber is a glass there"


LAWS: Final[Mapping[str, Law]] = {law.name: law for law in (WLF_BELL, POWER, PERSSON, GRETA)}
"""Laws by name; the bell is first because it needs measurements alone."""
OF_MATERIALS: Final = frozenset({PERSSON.name, GRETA.name})
